//! The next experiment: what is to be played and what is expected of it, as CSV and as schema
//! `tauscope/design/1`.

use serde::Serialize;
use serde_json::{Value, json};

use super::json::document;
use super::{DataTable, Kind};
use crate::design::{
    Design, Expected, FreeRunError, Hold, Order, Prediction, Rehearsal, Schedule, Side, TestRig,
    transitions,
};
use crate::explain::Pattern;
use crate::numerics::to_nanoseconds;

/// The input of one joint, and what is expected of it.
#[derive(Clone, Debug)]
pub(crate) struct DesignedJoint {
    /// Where it is played.
    pub(crate) rig: TestRig,
    /// The input.
    pub(crate) schedule: Schedule,
    /// The input at which the joint rests.
    pub(crate) rest: f64,
    /// What the joint will do, where a model says so: for two suspects the first's.
    pub(crate) prediction: Option<Prediction>,
    /// What it is to distinguish, if that is what it is for.
    pub(crate) discrimination: Option<Discrimination>,
    /// What the expectation rests on, of random steps.
    pub(crate) basis: Option<Basis>,
    /// What whoever plays it should know.
    pub(crate) notes: Vec<String>,
}

/// What is known of a joint for which random steps are designed.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    /// Ids of the effects of its model.
    pub(crate) effects: Vec<&'static str>,
    /// How far its predictions were off where it was not fitted.
    pub(crate) free_run: Option<FreeRunError>,
    /// Where the joint is kept.
    pub(crate) within: Option<(f64, f64)>,
    /// Whether the output comes to rest by itself, at a place that the input decides.
    pub(crate) regulates_itself: bool,
    /// How far the joint may be from its start when a trial begins, output units.
    pub(crate) start_tolerance: Option<f64>,
}

/// Two suspects that an input distinguishes.
#[derive(Clone, Debug)]
pub(crate) struct Discrimination {
    /// Their ids.
    pub(crate) ids: [&'static str; 2],
    /// The input, and how surely.
    pub(crate) design: Design,
    /// The power that was wanted.
    pub(crate) wanted: f64,
    /// Standard deviation of the noise, output units.
    pub(crate) noise: f64,
    /// What the joint will do where the second suspect is there.
    pub(crate) other: Prediction,
}

impl DesignedJoint {
    /// What the joint is expected to do, by name: that of each suspect, or `model`; nothing
    /// where no model says so.
    pub(crate) fn expected(&self) -> Vec<(&str, &Prediction)> {
        let Some(prediction) = &self.prediction else { return Vec::new() };
        match &self.discrimination {
            Some(Discrimination { ids: [one, other], other: second, .. }) => {
                vec![(one, prediction), (other, second)]
            }
            None => vec![("model", prediction)],
        }
    }
}

pub(super) fn kept_until_s(joint: &DesignedJoint, prediction: &Prediction) -> Option<f64> {
    let sample = prediction.kept_until(joint.rig.range?)?;
    Some(sample as f64 * joint.schedule.period().seconds())
}

/// A level that is held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Held {
    /// Number of the trial, from 1.
    pub(super) trial: usize,
    /// Seconds since the trial began.
    pub(super) start_s: f64,
    /// Input units.
    pub(super) level: f64,
    /// Seconds for which it is held.
    pub(super) hold_s: f64,
}

/// Each hold of `schedule`.
pub(super) fn holds(schedule: &Schedule) -> Vec<Held> {
    let period_s = schedule.period().seconds();
    let of_trial = |(trial, schedule): (usize, Schedule)| {
        let hold = |start: &mut usize, hold: &Hold| {
            let start_s = to_nanoseconds(*start as f64 * period_s);
            *start += hold.samples;
            let hold_s = to_nanoseconds(hold.samples as f64 * period_s);
            Some(Held { trial, start_s, level: hold.level, hold_s })
        };
        schedule.holds().iter().scan(0, hold).collect::<Vec<_>>()
    };
    (1..).zip(schedule.trials()).flat_map(of_trial).collect()
}

/// What the order of the levels is called.
pub(super) fn order(order: Order) -> &'static str {
    match order {
        Order::Pattern(Pattern::Ladder) => "ladder",
        Order::Pattern(Pattern::Pulses) => "pulses",
        Order::Pattern(Pattern::Reversals) => "reversals",
        Order::Random => "random",
        Order::Exploring => "exploring",
    }
}

/// A column of a joint: its name, a value for each sample of the joint's input, and the value after
/// the end of a trial, where others go on; not a number: an empty cell.
type Column<'a> = (String, &'a DesignedJoint, Vec<f64>, f64);

/// `<joint>.input…`, to be played: after `time_s`, and in several trials, each from time zero on,
/// `trial` before it. A joint whose input ends before that of another rests.
pub(crate) fn input_table(joints: &[DesignedJoint]) -> DataTable {
    table(joints, &joints.iter().map(input).collect::<Vec<_>>())
}

fn input(joint: &DesignedJoint) -> Column<'_> {
    (format!("{}.input", joint.rig.name), joint, joint.schedule.input(), joint.rest)
}

/// The input and what is expected: `<joint>.output`, and `<joint>.low` and `.high` with the margin; for
/// two suspects `<joint>.<effect>` of each.
pub(crate) fn preview_table(joints: &[DesignedJoint]) -> DataTable {
    let mut columns = Vec::new();
    for joint in joints {
        columns.push(input(joint));
        let Some(Prediction { output, margin }) = &joint.prediction else { continue };
        let with = |sign: f64| output.iter().zip(margin).map(|(y, m)| y + sign * m).collect();
        let mut expected =
            vec![("output", output.clone()), ("low", with(-1.0)), ("high", with(1.0))];
        if joint.discrimination.is_some() {
            let suspects = joint.expected().into_iter();
            expected.extend(suspects.map(|(effect, found)| (effect, found.output.clone())));
        }
        let named =
            |(name, values)| (format!("{}.{name}", joint.rig.name), joint, values, f64::NAN);
        columns.extend(expected.into_iter().map(named));
    }
    table(joints, &columns)
}

fn table(joints: &[DesignedJoint], columns: &[Column<'_>]) -> DataTable {
    let trials: Vec<_> = columns.iter().map(|(_, joint, ..)| joint.schedule.trials()).collect();
    let count = trials.iter().map(Vec::len).max().unwrap_or(0);
    let names = columns.iter().map(|(name, ..)| name.as_str());
    let numbered = (count > 1).then_some("trial");
    let header = numbered.into_iter().chain(["time_s"]).chain(names);
    let mut table = DataTable::new(header.map(|name| (name, Kind::Plain)));
    let period_s = joints.first().map_or(0.0, |joint| joint.schedule.period().seconds());
    // Where the trial begins in the values of each column.
    let mut starts = vec![0; columns.len()];
    for number in 0..count {
        let samples =
            |schedules: &Vec<Schedule>| schedules.get(number).map_or(0, Schedule::samples);
        let own: Vec<usize> = trials.iter().map(samples).collect();
        for row in 0..own.iter().copied().max().unwrap_or(0) {
            let cell = |(place, (.., values, after)): (usize, &Column<'_>)| {
                let is_within = own.get(place).is_some_and(|samples| row < *samples);
                let start = starts.get(place).copied().unwrap_or(0);
                let value = values.get(start + row).filter(|_| is_within);
                value.copied().unwrap_or(*after).into()
            };
            let trial = numbered.map(|_| Value::from(number + 1));
            let time_s = Value::from(to_nanoseconds(row as f64 * period_s));
            let cells = columns.iter().enumerate().map(cell);
            table.push_cells(trial.into_iter().chain([time_s]).chain(cells));
        }
        starts.iter_mut().zip(own).for_each(|(start, samples)| *start += samples);
    }
    table
}

/// The document of `design --format json`; `failures` are messages on joints that failed.
pub(crate) fn design_json(seed: u64, joints: &[DesignedJoint], failures: &[String]) -> Value {
    let joints: Value = joints.iter().map(joint).collect();
    let facts = json!({ "seed": seed, "joints": joints, "failures": failures });
    document("tauscope/design/1", facts)
}

fn joint(joint: &DesignedJoint) -> Value {
    let DesignedJoint { rig, schedule, .. } = joint;
    let ends = |(low, high): (f64, f64)| json!({ "low": low, "high": high });
    let trial =
        |trial: &Schedule| json!({ "duration_s": trial.duration_s(), "steps": trial.steps() });
    json!({
        "joint": rig.name,
        "input_unit": rig.input_unit,
        "output_unit": rig.output_unit,
        "sample_period_s": schedule.period().seconds(),
        "duration_s": schedule.duration_s(),
        "steps": schedule.steps(),
        "levels": schedule.levels(),
        "hold_s": ends(schedule.hold_range_s()),
        "transitions": transitions(schedule),
        "start": rig.start,
        "start_tolerance": joint.basis.as_ref().and_then(|basis| basis.start_tolerance),
        "output_range": rig.range.map(ends),
        "predicted": joint.prediction.as_ref().map(|found| predicted(joint, found)),
        "separates": joint.discrimination.as_ref().map(discrimination),
        "notes": joint.notes,
        "trials": schedule.trials().iter().map(trial).collect::<Value>(),
        "holds": holds(schedule),
    })
}

fn predicted(joint: &DesignedJoint, prediction: &Prediction) -> Value {
    let (low, high) = prediction.extent();
    json!({
        "low": low,
        "high": high,
        "largest_margin": prediction.largest_margin(),
        "kept_until_s": kept_until_s(joint, prediction),
    })
}

fn discrimination(found: &Discrimination) -> Value {
    let Discrimination { ids, design, wanted, noise, .. } = found;
    let sides = ids.iter().zip(&design.sides);
    json!({
        "effects": ids,
        "order": order(design.order),
        "noise": noise,
        "power_wanted": wanted,
        "power": design.power(),
        "explores": design.explores,
        "if_there": sides.map(|(effect, of_effect)| side(effect, of_effect)).collect::<Value>(),
    })
}

fn side(effect: &str, side: &Side) -> Value {
    let Expected { rival, neither, .. } = side.expected;
    let Rehearsal { successes, runs } = side.rehearsal.unwrap_or_default();
    json!({
        "effect": effect,
        "told": side.is_target,
        "excluded": side.is_excluded,
        "power": side.expected.power(),
        "noncentrality": rival.noncentrality(),
        "noncentrality_training": rival.training,
        "noncentrality_validation": rival.validation,
        "noncentrality_with_neither": neither.noncentrality(),
        "rehearsed": runs,
        "rehearsed_told": successes,
    })
}
