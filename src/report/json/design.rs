//! Schema `tauscope/design/1`.

use serde::Serialize;

use super::header::Header;
use crate::design::{Expected, OpenThreshold, Prediction, Rehearsal, Schedule, Side, transitions};
use crate::report::design::{DesignedJoint, Discrimination, Held, holds, kept_until_s, order};

/// The document of `design --format json`.
#[derive(Debug, Serialize)]
pub(crate) struct DesignJson<'a> {
    #[serde(flatten)]
    header: Header,
    seed: u64,
    joints: Vec<JointJson<'a>>,
    failures: &'a [String],
}

#[derive(Debug, Serialize)]
struct JointJson<'a> {
    joint: &'a str,
    input_unit: Option<&'a str>,
    output_unit: Option<&'a str>,
    sample_period_s: f64,
    duration_s: f64,
    steps: usize,
    levels: Vec<f64>,
    hold_s: Ends,
    transitions: [usize; 2],
    start: f64,
    start_tolerance: Option<f64>,
    output_range: Option<Ends>,
    predicted: Option<PredictedJson>,
    separates: Option<DiscriminationJson>,
    notes: &'a [String],
    trials: Vec<TrialJson>,
    holds: Vec<HoldJson>,
}

#[derive(Debug, Serialize)]
struct Ends {
    low: f64,
    high: f64,
}

#[derive(Debug, Serialize)]
struct PredictedJson {
    low: f64,
    high: f64,
    largest_margin: f64,
    kept_until_s: Option<f64>,
}

#[derive(Debug, Serialize)]
struct TrialJson {
    duration_s: f64,
    steps: usize,
}

#[derive(Debug, Serialize)]
struct HoldJson {
    trial: usize,
    start_s: f64,
    level: f64,
    hold_s: f64,
}

#[derive(Debug, Serialize)]
struct DiscriminationJson {
    effects: [&'static str; 2],
    order: &'static str,
    noise: f64,
    power_wanted: f64,
    power: f64,
    explores: Vec<OpenJson>,
    if_there: Vec<SideJson>,
}

/// What an input that explores is to find.
#[derive(Debug, Serialize)]
struct OpenJson {
    effect: &'static str,
    parameter: &'static str,
    low: f64,
    high: f64,
}

#[derive(Debug, Serialize)]
struct SideJson {
    effect: &'static str,
    told: bool,
    excluded: bool,
    power: f64,
    noncentrality: f64,
    noncentrality_training: f64,
    noncentrality_validation: f64,
    noncentrality_with_neither: f64,
    rehearsed: usize,
    rehearsed_told: usize,
}

impl<'a> DesignJson<'a> {
    /// Collects the results; `failures` are messages on joints that failed.
    pub(crate) fn new(seed: u64, joints: &'a [DesignedJoint], failures: &'a [String]) -> Self {
        let joints = joints.iter().map(JointJson::new).collect();
        Self { header: Header::of("tauscope/design/1"), seed, joints, failures }
    }
}

impl<'a> JointJson<'a> {
    fn new(joint: &'a DesignedJoint) -> Self {
        let DesignedJoint { rig, schedule, .. } = joint;
        let ((shortest, longest), (least, most)) = (schedule.hold_range_s(), transitions(schedule));
        Self {
            joint: &rig.name,
            input_unit: rig.input_unit.as_deref(),
            output_unit: rig.output_unit.as_deref(),
            sample_period_s: schedule.period().seconds(),
            duration_s: schedule.duration_s(),
            steps: schedule.steps(),
            levels: schedule.levels(),
            hold_s: Ends { low: shortest, high: longest },
            transitions: [least, most],
            start: rig.start,
            start_tolerance: joint.basis.as_ref().and_then(|basis| basis.start_tolerance),
            output_range: rig.range.map(|(low, high)| Ends { low, high }),
            predicted: joint.prediction.as_ref().map(|found| predicted(joint, found)),
            separates: joint.discrimination.as_ref().map(DiscriminationJson::new),
            notes: &joint.notes,
            trials: schedule.trials().iter().map(TrialJson::new).collect(),
            holds: holds(schedule).into_iter().map(HoldJson::new).collect(),
        }
    }
}

impl TrialJson {
    fn new(trial: &Schedule) -> Self {
        Self { duration_s: trial.duration_s(), steps: trial.steps() }
    }
}

impl HoldJson {
    fn new(Held { trial, start_s, level, hold_s }: Held) -> Self {
        Self { trial, start_s, level, hold_s }
    }
}

fn predicted(joint: &DesignedJoint, prediction: &Prediction) -> PredictedJson {
    let (low, high) = prediction.extent();
    let largest_margin = prediction.largest_margin();
    PredictedJson { low, high, largest_margin, kept_until_s: kept_until_s(joint, prediction) }
}

impl DiscriminationJson {
    fn new(found: &Discrimination) -> Self {
        let Discrimination { ids, design, wanted, noise, .. } = found;
        let sides = ids.iter().zip(&design.sides);
        Self {
            effects: *ids,
            order: order(design.order),
            noise: *noise,
            power_wanted: *wanted,
            power: design.power(),
            explores: design.explores.iter().map(OpenJson::new).collect(),
            if_there: sides.map(|(effect, side)| SideJson::new(effect, side)).collect(),
        }
    }
}

impl OpenJson {
    fn new(OpenThreshold { effect, parameter, low, high }: &OpenThreshold) -> Self {
        Self { effect, parameter, low: *low, high: *high }
    }
}

impl SideJson {
    fn new(effect: &'static str, side: &Side) -> Self {
        let Expected { rival, neither, .. } = side.expected;
        let Rehearsal { successes, runs } = side.rehearsal.unwrap_or_default();
        Self {
            effect,
            told: side.is_target,
            excluded: side.is_excluded,
            power: side.expected.power(),
            noncentrality: rival.noncentrality(),
            noncentrality_training: rival.training,
            noncentrality_validation: rival.validation,
            noncentrality_with_neither: neither.noncentrality(),
            rehearsed: runs,
            rehearsed_told: successes,
        }
    }
}
