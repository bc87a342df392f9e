//! The next experiment: what is to be played and what is expected of it, as JSON and CSV.

use std::io::Write;

use serde::Serialize;

use super::decisions::tidy_seconds;
use crate::design::{
    Design, Expected, Hold, Open, Order, Prediction, Rehearsal, Schedule, Side, Stand, transitions,
};
use crate::explain::Pattern;

/// The input of one joint, and what is expected of it.
#[derive(Clone, Debug)]
pub struct DesignedJoint {
    /// Where it is played.
    pub stand: Stand,
    /// The input.
    pub schedule: Schedule,
    /// What the joint will do, where a model says so: for two suspects the first's.
    pub prediction: Option<Prediction>,
    /// What it is to tell apart, if that is what it is for.
    pub told: Option<Told>,
    /// What whoever plays it should know.
    pub notes: Vec<String>,
}

/// Two suspects that an input tells apart.
#[derive(Clone, Debug)]
pub struct Told {
    /// Their ids.
    pub ids: [&'static str; 2],
    /// The input, and how surely.
    pub design: Design,
    /// The power that was wanted.
    pub wanted: f64,
    /// Standard deviation of the noise, output units.
    pub noise: f64,
    /// What the joint will do where the second suspect is there.
    pub other: Prediction,
}

impl DesignedJoint {
    /// What the joint is expected to do, by name: that of each suspect, or `model`; nothing
    /// where no model says so.
    pub fn expected(&self) -> Vec<(&str, &Prediction)> {
        let Some(prediction) = &self.prediction else { return Vec::new() };
        match &self.told {
            Some(Told { ids: [one, other], other: second, .. }) => {
                vec![(one, prediction), (other, second)]
            }
            None => vec![("model", prediction)],
        }
    }
}

/// The document of `design --format json`, schema `tauscope/design/1`.
#[derive(Debug, Serialize)]
pub struct DesignJson<'a> {
    schema: &'static str,
    version: &'static str,
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
    output_range: Option<Ends>,
    predicted: Option<PredictedJson>,
    separates: Option<ToldJson>,
    notes: &'a [String],
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
pub(super) struct HoldJson {
    start_s: f64,
    pub(super) level: f64,
    pub(super) hold_s: f64,
}

#[derive(Debug, Serialize)]
struct ToldJson {
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
    pub fn new(seed: u64, joints: &'a [DesignedJoint], failures: &'a [String]) -> Self {
        let version = env!("CARGO_PKG_VERSION");
        let joints = joints.iter().map(JointJson::new).collect();
        Self { schema: "tauscope/design/1", version, seed, joints, failures }
    }
}

impl<'a> JointJson<'a> {
    fn new(joint: &'a DesignedJoint) -> Self {
        let DesignedJoint { stand, schedule, .. } = joint;
        let ((shortest, longest), (least, most)) = (schedule.hold_range_s(), transitions(schedule));
        Self {
            joint: &stand.name,
            input_unit: stand.input_unit.as_deref(),
            output_unit: stand.output_unit.as_deref(),
            sample_period_s: schedule.period().seconds(),
            duration_s: schedule.duration_s(),
            steps: schedule.steps(),
            levels: schedule.levels(),
            hold_s: Ends { low: shortest, high: longest },
            transitions: [least, most],
            start: stand.start,
            output_range: stand.range.map(|(low, high)| Ends { low, high }),
            predicted: joint.prediction.as_ref().map(|prediction| predicted(joint, prediction)),
            separates: joint.told.as_ref().map(ToldJson::new),
            notes: &joint.notes,
            holds: holds(schedule),
        }
    }
}

fn predicted(joint: &DesignedJoint, prediction: &Prediction) -> PredictedJson {
    let (low, high) = prediction.extent();
    let largest_margin = prediction.largest_margin();
    PredictedJson { low, high, largest_margin, kept_until_s: kept_until_s(joint, prediction) }
}

pub(super) fn kept_until_s(joint: &DesignedJoint, prediction: &Prediction) -> Option<f64> {
    let sample = prediction.kept_until(joint.stand.range?)?;
    Some(sample as f64 * joint.schedule.period().seconds())
}

pub(super) fn holds(schedule: &Schedule) -> Vec<HoldJson> {
    let period_s = schedule.period().seconds();
    let hold = |start: &mut usize, hold: &Hold| {
        let start_s = tidy_seconds(*start as f64 * period_s);
        *start += hold.samples;
        let hold_s = tidy_seconds(hold.samples as f64 * period_s);
        Some(HoldJson { start_s, level: hold.level, hold_s })
    };
    schedule.holds().iter().scan(0, hold).collect()
}

impl ToldJson {
    fn new(told: &Told) -> Self {
        let Told { ids, design, wanted, noise, .. } = told;
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
    fn new(Open { effect, parameter, low, high }: &Open) -> Self {
        Self { effect, parameter, low: *low, high: *high }
    }
}

impl SideJson {
    fn new(effect: &'static str, side: &Side) -> Self {
        let Expected { rival, neither, .. } = side.expected;
        let Rehearsal { told, of } = side.rehearsal.unwrap_or_default();
        Self {
            effect,
            told: side.is_told,
            excluded: side.is_excluded,
            power: side.expected.power(),
            noncentrality: rival.noncentrality(),
            noncentrality_training: rival.training,
            noncentrality_validation: rival.validation,
            noncentrality_with_neither: neither.noncentrality(),
            rehearsed: of,
            rehearsed_told: told,
        }
    }
}

pub(super) fn order(order: Order) -> &'static str {
    match order {
        Order::Pattern(Pattern::Ladder) => "ladder",
        Order::Pattern(Pattern::Pulses) => "pulses",
        Order::Pattern(Pattern::Reversals) => "reversals",
        Order::Random => "random",
        Order::Exploring => "exploring",
    }
}

/// Writes `time_s,<joint>.input…` as CSV, to be played. A joint whose input ends before that of
/// another rests.
///
/// # Errors
/// When `out` cannot be written.
pub fn write_input(joints: &[DesignedJoint], out: impl Write) -> csv::Result<()> {
    let columns = joints.iter().map(|joint| {
        let name = format!("{}.input", joint.stand.name);
        (name, joint.schedule.input(), 0.0)
    });
    write_columns(joints, &columns.collect::<Vec<_>>(), out)
}

/// Writes the input and what is expected: `<joint>.output`, and `<joint>.low` and `.high` with
/// the margin; for two suspects `<joint>.<effect>` of each.
///
/// # Errors
/// When `out` cannot be written.
pub fn write_preview(joints: &[DesignedJoint], out: impl Write) -> csv::Result<()> {
    let mut columns = Vec::new();
    for joint in joints {
        let mut add = |name: &str, values: Vec<f64>, after: f64| {
            columns.push((format!("{}.{name}", joint.stand.name), values, after));
        };
        add("input", joint.schedule.input(), 0.0);
        let Some(Prediction { output, margin }) = &joint.prediction else { continue };
        let with = |sign: f64| output.iter().zip(margin).map(|(y, m)| y + sign * m).collect();
        add("output", output.clone(), f64::NAN);
        add("low", with(-1.0), f64::NAN);
        add("high", with(1.0), f64::NAN);
        if let Some(Told { ids: [one, other], other: outputs, .. }) = &joint.told {
            add(one, output.clone(), f64::NAN);
            add(other, outputs.output.clone(), f64::NAN);
        }
    }
    write_columns(joints, &columns, out)
}

/// Columns with their names and what stands behind their ends; not a number: nothing.
fn write_columns(
    joints: &[DesignedJoint],
    columns: &[(String, Vec<f64>, f64)],
    out: impl Write,
) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    let names = columns.iter().map(|(name, _, _)| name.as_str());
    writer.write_record(std::iter::once("time_s").chain(names))?;
    let period_s = joints.first().map_or(0.0, |joint| joint.schedule.period().seconds());
    let rows = columns.iter().map(|(_, values, _)| values.len()).max().unwrap_or(0);
    for row in 0..rows {
        writer.write_field(tidy_seconds(row as f64 * period_s).to_string())?;
        for (_, values, after) in columns {
            let value = values.get(row).copied().unwrap_or(*after);
            let text = if value.is_nan() { String::new() } else { value.to_string() };
            writer.write_field(text)?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    Ok(writer.flush()?)
}
