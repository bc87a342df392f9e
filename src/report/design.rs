//! The next experiment: what is to be played and what is expected of it, as CSV.

use std::io::Write;

use crate::design::{Design, FreeRunError, Hold, Order, Prediction, Schedule, TestRig};
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
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// A column of a file, trial by trial.
struct Column {
    name: String,
    trials: Vec<Vec<f64>>,
    /// The value behind the end of a trial; not a number: an empty cell.
    after: f64,
}

impl Column {
    /// `values` of `joint`, one for each sample of its input.
    fn of(joint: &DesignedJoint, name: &str, values: &[f64], after: f64) -> Self {
        let mut rest = values;
        let of_trial = |trial: Schedule| {
            let (own, others) = rest.split_at(trial.samples().min(rest.len()));
            rest = others;
            own.to_vec()
        };
        let trials = joint.schedule.trials().into_iter().map(of_trial).collect();
        Self { name: format!("{}.{name}", joint.rig.name), trials, after }
    }
}

/// Writes `time_s,<joint>.input…` as CSV, to be played; in several trials, each from time zero on,
/// `trial` before it. A joint whose input ends before that of another rests.
///
/// # Errors
/// When `out` cannot be written.
pub(crate) fn write_input(joints: &[DesignedJoint], out: impl Write) -> csv::Result<()> {
    let column = |joint| Column::of(joint, "input", &joint.schedule.input(), joint.rest);
    write_columns(joints, &joints.iter().map(column).collect::<Vec<_>>(), out)
}

/// Writes the input and what is expected: `<joint>.output`, and `<joint>.low` and `.high` with
/// the margin; for two suspects `<joint>.<effect>` of each.
///
/// # Errors
/// When `out` cannot be written.
pub(crate) fn write_preview(joints: &[DesignedJoint], out: impl Write) -> csv::Result<()> {
    let mut columns = Vec::new();
    for joint in joints {
        let mut add = |name: &str, values: &[f64], after: f64| {
            columns.push(Column::of(joint, name, values, after));
        };
        add("input", &joint.schedule.input(), joint.rest);
        let Some(Prediction { output, margin }) = &joint.prediction else { continue };
        let with = |sign: f64| -> Vec<f64> {
            output.iter().zip(margin).map(|(y, m)| y + sign * m).collect()
        };
        add("output", output, f64::NAN);
        add("low", &with(-1.0), f64::NAN);
        add("high", &with(1.0), f64::NAN);
        if let Some(Discrimination { ids: [one, other], other: outputs, .. }) =
            &joint.discrimination
        {
            add(one, output, f64::NAN);
            add(other, &outputs.output, f64::NAN);
        }
    }
    write_columns(joints, &columns, out)
}

fn write_columns(joints: &[DesignedJoint], columns: &[Column], out: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    let trials = columns.iter().map(|column| column.trials.len()).max().unwrap_or(0);
    let names = columns.iter().map(|column| column.name.as_str());
    let number = (trials > 1).then_some("trial");
    writer.write_record(number.into_iter().chain(["time_s"]).chain(names))?;
    let period_s = joints.first().map_or(0.0, |joint| joint.schedule.period().seconds());
    for trial in 0..trials {
        let of_trial = |column: &Column| column.trials.get(trial).map_or(0, Vec::len);
        let rows = columns.iter().map(of_trial).max().unwrap_or(0);
        for row in 0..rows {
            if trials > 1 {
                writer.write_field((trial + 1).to_string())?;
            }
            writer.write_field(to_nanoseconds(row as f64 * period_s).to_string())?;
            for Column { trials, after, .. } in columns {
                let value = trials.get(trial).and_then(|values| values.get(row));
                let value = value.copied().unwrap_or(*after);
                let text = if value.is_nan() { String::new() } else { value.to_string() };
                writer.write_field(text)?;
            }
            writer.write_record(None::<&[u8]>)?;
        }
    }
    Ok(writer.flush()?)
}
