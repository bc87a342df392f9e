//! Models of strokes from rest into a stop.

use crate::sample::size;
use crate::stroke::{PERIOD_S, strokes};
use tauscope::batch::Threads;
use tauscope::delay::{Method, Settings, TrialEstimate, estimate_joint};
use tauscope::effect::find;
use tauscope::experiment::{Joint, Record};
use tauscope::explain::{Change, Options, improve};
use tauscope::fit::{FitRecord, Horizon, Split, fit};
use tauscope::model::integrators;

fn estimated(trials: &Record, settings: &Settings) -> Vec<TrialEstimate> {
    estimate_joint(trials, settings).into_iter().map(Result::unwrap).collect()
}

/// What strokes into a stop usually need, in the order in which it is tried.
const USUAL: [&str; 5] =
    ["dead_band", "input_saturation", "direction_gain", "end_stop", "position_gain"];

/// In the small sample the usual effects have a few rivals only, and nothing is looked for beyond them.
fn options() -> Options {
    let rivals = ["flow_curve", "actuator_lag"];
    let effects = USUAL.iter().chain(&rivals).map(|id| find(id).unwrap()).collect();
    let few = Options { effects, max_effects: USUAL.len(), ..Options::default() };
    size(few, Options::default())
}

#[test]
fn a_model_of_strokes_has_the_measured_delay_and_gets_the_usual_effects_first() {
    let (trials, _) = strokes();
    let found = estimated(&trials, &Settings::of(Method::TWO_LINE));
    let finer = estimated(&trials, &Settings::of(Method::HINGE));
    let mut delays: Vec<f64> =
        finer.iter().filter_map(|found| found.decisions[0].accepted_delay()).collect();
    delays.sort_by(f64::total_cmp);
    let between = delays[3] * PERIOD_S..=delays[4] * PERIOD_S;
    let joint = Joint::new("boom", trials).with_units("V", "deg");
    let [start] = &integrators(&joint, &found.iter().collect::<Vec<_>>())[..] else {
        panic!("a measured delay is one start")
    };
    assert!(start.delay.fixed && between.contains(&start.delay.value), "{:?}", start.delay);

    let record = FitRecord::new(&joint, Split::of(&joint), Horizon::Steps);
    let base = fit(&record, start, &record.range(20.0)).unwrap();
    let improvement = improve(&record, base, &options(), &Threads, |_| true);
    let added = improvement.revisions.iter().filter_map(|revision| match revision.change {
        Change::Added(id) => Some(id),
        _ => None,
    });
    // Those that are of consequence.
    let first: Vec<&str> = added.take(3).collect();
    let places: Vec<_> = first.iter().map(|id| USUAL.iter().position(|one| one == id)).collect();
    assert!(places.is_sorted() && !places.contains(&None) && places.len() == 3, "{first:?}");
    // The cylinder runs into its ends, and what is not there carries nothing.
    let error = |index: usize| improvement.revisions[index].comparison.judged().unwrap().rmse;
    let last = improvement.revisions.len() - 1;
    assert!(error(last) < 0.2 * error(0), "{} {}", error(0), error(last));
    let model = &improvement.revisions[last].comparison.fit.model;
    assert!(start.delay.value.to_bits() == model.delay.value.to_bits());
    let carried = improvement.attribution.found;
    assert!(carried.iter().any(|one| one.effect == "end_stop"), "{carried:?}");
    assert!(carried.iter().all(|one| one.error_share >= 0.01), "{carried:?}");
}
