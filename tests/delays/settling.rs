//! Outputs that settle: a speed, a pressure, a servo's position. The truth is simulated here, with
//! exact exponentials between samples.

use crate::sample::{least, size};
use tauscope::delay::{Condition, FirstLast, Method, Settings, TrialEstimate, Verdict, estimate};
use tauscope::experiment::Trial;
use tauscope::units::SamplePeriod;

/// Seconds between samples, and of each hold.
const PERIOD_S: f64 = 0.02;
const HOLD_S: f64 = 5.0;

/// Numbers between 0 and 1.
pub(crate) fn random(seed: u32) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(2_654_435_761);
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1_u32 << 24)
    }
}

/// What settles: a time constant, that of a further lag or 0, and noise.
#[derive(Clone, Copy)]
struct Plant {
    time_constant_s: f64,
    further_s: f64,
    noise: f64,
}

const PLAIN: Plant = Plant { time_constant_s: 3.0, further_s: 0.0, noise: 0.02 };

/// A record of twenty steps of 1 to 4, each after a dead time of its own; and the dead times in
/// samples.
fn record(plant: Plant, seed: u32) -> (Trial, Vec<f64>) {
    let mut next = random(seed);
    let mut level = 0.0;
    let mut changes = vec![(0.0, 0.0, 0.0)];
    for step in 1..=20 {
        let size = 1.0 + 3.0 * next();
        level += if level > 0.0 { -size } else { size };
        let dead_s = 0.05 + 0.45 * next();
        changes.push((f64::from(step) * HOLD_S, level, dead_s));
    }
    let samples = (0..5250_u32).map(|k| f64::from(k) * PERIOD_S);
    let at = |time: f64| changes.iter().rev().find(|(start, ..)| *start <= time).unwrap().1;
    let input = samples.clone().map(|time| at(time + 1e-9)).collect();
    let output =
        samples.map(|time| response(&plant, &changes, time) + plant.noise * normal(&mut next));
    let output = output.collect();
    let period = SamplePeriod::from_seconds(PERIOD_S).unwrap();
    let dead = changes.iter().skip(1).map(|(_, _, dead_s)| dead_s / PERIOD_S).collect();
    (Trial::new("1", 0.0, period, input, output).unwrap(), dead)
}

/// The sum of the responses to all changes of the level.
fn response(plant: &Plant, changes: &[(f64, f64, f64)], time: f64) -> f64 {
    let Plant { time_constant_s, further_s, .. } = *plant;
    let gain = time_constant_s / (time_constant_s - further_s);
    let one = |pair: &[(f64, f64, f64)]| {
        let (start, level, dead_s) = pair[1];
        let since = time - start - dead_s;
        let further = if further_s > 0.0 { (-since / further_s).exp() } else { 0.0 };
        let approach = 1.0 - gain * (-since / time_constant_s).exp() + (gain - 1.0) * further;
        if since > 0.0 { (level - pair[0].1) * approach } else { 0.0 }
    };
    changes.windows(2).map(one).sum()
}

/// About a normal variable.
fn normal(next: &mut impl FnMut() -> f64) -> f64 {
    (0..12).map(|_| next()).sum::<f64>() - 6.0
}

fn settings(method: Method) -> Settings {
    Settings { first_last: FirstLast::Keep, ..Settings::of(method) }
}

/// The errors of all accepted delays in seconds, and how many intervals hold the truth.
fn judged(found: &TrialEstimate, truth: &[f64]) -> (Vec<f64>, usize) {
    let pairs = || found.decisions.iter().zip(truth);
    let accepted = |(decision, dead): (&tauscope::delay::Decision, &f64)| {
        Some((decision.accepted_delay()? - dead).abs() * PERIOD_S)
    };
    let held = pairs().filter(|(decision, dead)| {
        decision.fine.is_some_and(|fine| fine.low <= **dead && **dead <= fine.high)
    });
    (pairs().filter_map(accepted).collect(), held.count())
}

#[test]
fn the_onsets_of_an_output_are_found_that_has_not_settled_when_the_next_step_comes() {
    let (trial, truth) = record(PLAIN, 1);
    let found = estimate(&trial, &settings(Method::AUTO)).unwrap();
    let model = found.onset_model.as_ref().unwrap();
    assert_eq!(model.shape(), "settling");
    assert!((model.parameters()[0].1 - 3.0).abs() < 0.06, "{model:?}");
    let (errors, _) = judged(&found, &truth);
    assert_eq!(errors.len(), 20);
    let largest = errors.iter().copied().fold(0.0, f64::max);
    // Half of what a curve fit with SciPy on such records is off at most.
    assert!(largest < 0.1, "{largest}");
}

#[test]
fn intervals_hold_the_dead_times_behind_a_further_lag_and_without() {
    let plants = [
        PLAIN,
        Plant { noise: 0.1, ..PLAIN },
        Plant { time_constant_s: 1.0, further_s: 0.08, noise: 0.02 },
    ];
    for (number, plant) in plants.into_iter().enumerate() {
        let records = size(1, 3);
        let held: usize = (0..records)
            .map(|seed| {
                let (trial, truth) = record(plant, 10 + seed);
                judged(&estimate(&trial, &settings(Method::AUTO)).unwrap(), &truth).1
            })
            .sum();
        // Four standard deviations: steps of a record share an error.
        let count = 20 * records as usize;
        assert!(held >= least(count, 0.95, 4.0), "{number}: {held} of {count}");
    }
}

#[test]
fn a_joint_that_moves_on_does_not_settle_and_the_paper_asks_nothing() {
    let (trial, _) = record(PLAIN, 2);
    let paper = Settings { paper: true, ..settings(Method::AUTO) };
    assert_eq!(estimate(&trial, &paper).unwrap().onset_model, None);
    let mut angle = 0.0;
    let angles = trial.input().iter().map(|speed| {
        angle += 0.01 * speed;
        angle
    });
    let angles = angles.collect();
    let joint = Trial::new("1", 0.0, trial.period(), trial.input().to_vec(), angles).unwrap();
    let found = estimate(&joint, &settings(Method::AUTO)).unwrap();
    assert_eq!(found.onset_model.unwrap().shape(), "bend");
}

#[test]
fn a_step_in_a_dead_band_is_no_reaction() {
    let (trial, _) = record(PLAIN, 3);
    // The input changes once more, in the middle of the fifth hold, and the output does not.
    let mut input = trial.input().to_vec();
    let middle = 1375;
    input[middle..1500].iter_mut().for_each(|level| *level += 0.3);
    let output = trial.output().to_vec();
    let trial = Trial::new("1", 0.0, trial.period(), input, output).unwrap();
    let found = estimate(&trial, &settings(Method::AUTO)).unwrap();
    let of_it = found.decisions.iter().find(|it| it.input_step.sample == middle + 1).unwrap();
    assert_eq!(of_it.verdict(), Verdict::Rejected(Condition::NothingHappened));
}

#[test]
fn a_plain_reaction_is_no_doubt() {
    let (trial, _) = record(PLAIN, 5);
    let found = estimate(&trial, &settings(Method::AUTO)).unwrap();
    let accepted = found.decisions.iter().filter(|it| it.verdict() == Verdict::Accepted);
    for decision in accepted.clone() {
        let doubt = decision.doubt(trial.output());
        assert!(doubt.settles && !doubt.is_doubtful(), "{}: {doubt:?}", decision.number);
    }
    assert!(accepted.count() >= 18);
}
