//! Two effects that look alike in a record, and the experiment that is proposed to tell them
//! apart: with it in the record, the race does.

use tauscope::batch::Threads;
use tauscope::delay::Settings;
use tauscope::effect::find;
use tauscope::experiment::{Joint, Trial};
use tauscope::explain::{Explanation, Options, Proposal, Verdict};
use tauscope::fit::Horizon;
use tauscope::study::{Mode, Protocol, estimate_joints, explain_joints};
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};

const PERIOD_S: f64 = 0.02;

/// A joint that hides `effect`, driven by `input` for so long.
fn driven(effect: (&str, &[(&str, f64)]), input: InputSpec, seconds: f64, seed: u64) -> Joint {
    let spec = JointSpec::new("boom", input, DelayLaw::Constant { seconds: 0.12 });
    let mut spec = JointSpec { noise: 0.05, ..spec };
    let numbers: Vec<_> = effect.1.iter().map(|(key, v)| ((*key).to_owned(), *v)).collect();
    spec.hide(effect.0, &numbers).unwrap();
    let plant =
        PlantSpec { sample_period_s: PERIOD_S, ..PlantSpec::new(seed, seconds, vec![spec]) };
    simulate(&plant).unwrap().joints.remove(0)
}

fn explained(joint: &Joint, effects: &[&str]) -> Explanation {
    let joints = std::slice::from_ref(joint);
    let estimates = estimate_joints(joints, &Settings::default(), || (), &Threads);
    let protocol = Protocol { mode: Mode::FitOrIntegrator, split: None, horizon: Horizon::Steps };
    let effects = effects.iter().map(|id| find(id).unwrap()).collect();
    let options = Options { effects, ..Options::default() };
    let mut explained = explain_joints(joints, &estimates, |_| None, protocol, &options, &Threads);
    explained.remove(0).unwrap().unwrap()
}

/// `joint` with a trial more: what the same plant does in the proposed experiment.
fn with_experiment(
    mut joint: Joint,
    effect: (&str, &[(&str, f64)]),
    proposal: &Proposal,
    seed: u64,
) -> Joint {
    let samples = (1_usize..100_000)
        .find(|k| *k as f64 * PERIOD_S > proposal.hold_s - 0.5 * PERIOD_S)
        .unwrap();
    let levels = proposal.sequence();
    let changes = (1..levels.len()).filter(|k| (levels[*k] - levels[k - 1]).abs() > 0.0);
    let steps: Vec<_> = changes.map(|k| (k * samples + 1, levels[k])).collect();
    let input = InputSpec::Steps { steps, initial: levels[0] };
    let seconds = levels.len() as f64 * proposal.hold_s;
    let made = driven(effect, input, seconds, seed).trials;
    let made = &made[0];
    let (input, output) = (made.input().to_vec(), made.output().to_vec());
    let start_s = joint.trials[0].time_s(joint.trials[0].len() + 1);
    let further = Trial::new("2", start_s, made.period(), input, output).unwrap();
    joint.trials = joint.trials.into_iter().chain([further]).collect();
    joint
}

/// The id that is first, and those it cannot be told from.
fn first(explanation: &Explanation) -> (&'static str, &[&'static str]) {
    let best = &explanation.ranking[0];
    (best.effects[0], &best.indistinguishable_from)
}

/// Levels of either sign, held for about a second.
fn levels(levels: &[f64]) -> InputSpec {
    InputSpec::Levels { levels: levels.to_vec(), hold_s: [0.8, 1.6] }
}

fn is_told_apart(hidden: (&str, &[(&str, f64)]), other: &str, input: InputSpec) {
    let effects = [hidden.0, other];
    let joint = driven(hidden, input, 60.0, 5);
    let before = explained(&joint, &effects);
    assert_eq!(before.verdict, Verdict::MissingEffect);
    let (name, alike) = first(&before);
    assert_eq!(alike.len(), 1, "{name} is told from the other already");
    let separation = &before.ranking[0].separated_by[0];
    assert!(separation.is_clear && alike == [separation.other]);
    assert!(separation.times_noise >= 3.0 && separation.after_s > 0.0);

    // A threshold may be anywhere between two levels: the first experiment may only narrow the gap.
    let further = with_experiment(joint, hidden, &separation.proposal, 6);
    let mut after = explained(&further, &effects);
    if let [again, ..] = after.ranking[0].separated_by.as_slice() {
        let both = with_experiment(further, hidden, &again.proposal, 7);
        after = explained(&both, &effects);
    }
    assert_eq!(first(&after), (hidden.0, &[][..]), "{separation:?}");
}

#[test]
fn small_levels_tell_a_dead_band_from_a_progressive_valve() {
    let hidden = ("dead_band", &[("lower", -0.3), ("upper", 0.3)][..]);
    is_told_apart(hidden, "flow_curve", levels(&[-2.0, -1.0, 1.0, 2.0]));
}

#[test]
fn small_levels_tell_a_progressive_valve_from_a_dead_band() {
    let hidden = ("flow_curve", &[("exponent", 1.3)][..]);
    is_told_apart(hidden, "dead_band", levels(&[-2.0, -1.0, 1.0, 2.0]));
}

#[test]
fn other_levels_tell_an_offset_from_a_direction() {
    // A valve that is driven fully one way or the other, and never rests.
    let level = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    let steps = (1..50).map(|k| (60 * k + 1, level(k))).collect();
    let input = InputSpec::Steps { steps, initial: level(0) };
    is_told_apart(("input_offset", &[("offset", 0.2)]), "direction_gain", input);
}

#[test]
fn levels_between_tell_a_joint_that_sticks_from_a_dead_band() {
    let hidden = ("stiction", &[("start", 0.6), ("stop", 0.4)][..]);
    is_told_apart(hidden, "dead_band", levels(&[-1.0, -0.3, 0.3, 1.0]));
}

#[test]
fn what_is_the_same_for_every_input_is_not_told_apart() {
    // Friction without inertia is a dead band.
    let hidden = ("dead_band", &[("lower", -0.3), ("upper", 0.3)][..]);
    let joint = driven(hidden, levels(&[-1.5, -1.0, -0.5, 0.5, 1.0, 1.5]), 60.0, 5);
    let found = explained(&joint, &["dead_band", "coulomb_friction"]);
    let best = &found.ranking[0];
    assert_eq!(best.indistinguishable_from.len(), 1);
    assert!(!best.separated_by[0].is_clear, "{:?}", best.separated_by);
}
