//! The next experiment: what is to be played, what is expected of it, and as JSON and CSV.

use std::io::Write;

use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use serde::Serialize;

use super::decisions::tidy_seconds;
use super::number::{measure, rounded};
use super::words::filled;
use crate::design::{
    Design, Expected, Hold, Order, Prediction, Rehearsal, Schedule, Side, Stand, transitions,
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
    /// What the joint will do where the second suspect is there, output units.
    pub other: Vec<f64>,
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
struct HoldJson {
    start_s: f64,
    level: f64,
    hold_s: f64,
}

#[derive(Debug, Serialize)]
struct ToldJson {
    effects: [&'static str; 2],
    order: &'static str,
    noise: f64,
    power_wanted: f64,
    power: f64,
    if_there: Vec<SideJson>,
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

fn kept_until_s(joint: &DesignedJoint, prediction: &Prediction) -> Option<f64> {
    let sample = prediction.kept_until(joint.stand.range?)?;
    Some(sample as f64 * joint.schedule.period().seconds())
}

fn holds(schedule: &Schedule) -> Vec<HoldJson> {
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
            if_there: sides.map(|(effect, side)| SideJson::new(effect, side)).collect(),
        }
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

fn order(order: Order) -> &'static str {
    match order {
        Order::Pattern(Pattern::Ladder) => "ladder",
        Order::Pattern(Pattern::Pulses) => "pulses",
        Order::Pattern(Pattern::Reversals) => "reversals",
        Order::Random => "random",
    }
}

/// What is to be played on each joint, and what is expected of it.
pub fn design_text(joints: &[DesignedJoint]) -> String {
    joints.iter().map(joint_text).collect::<Vec<_>>().join("\n\n") + "\n"
}

fn joint_text(joint: &DesignedJoint) -> String {
    let mut parts = vec![filled(&headline(joint))];
    parts.extend(joint.told.as_ref().map(|told| side_table(told).to_string()));
    let mut sentences = Vec::new();
    sentences.extend(joint.told.as_ref().map(|told| explanation(joint, told)));
    sentences.extend(joint.prediction.as_ref().map(|prediction| foreseen(joint, prediction)));
    sentences.extend(joint.notes.iter().cloned());
    if !sentences.is_empty() {
        parts.push(filled(&sentences.join(" ")));
    }
    parts.push(filled(&level_by_level(joint)));
    parts.join("\n\n")
}

/// What is played, in a sentence.
fn headline(joint: &DesignedJoint) -> String {
    let DesignedJoint { stand, schedule, .. } = joint;
    let unit = stand.input_unit.as_deref();
    let levels = listed(&schedule.levels(), unit);
    let (hold, steps) = (hold_text(schedule), schedule.steps());
    let duration = measure(schedule.duration_s(), Some("s"));
    let name = &stand.name;
    if let Some(Told { ids: [one, other], design, .. }) = &joint.told {
        let order = order(design.order);
        return format!(
            "{name}: {duration} tell {one} from {other}: {order} of {levels}, each held for \
             {hold}, {steps} steps."
        );
    }
    let (least, most) = transitions(schedule);
    format!(
        "{name}: random steps of {levels}, each held for {hold}: {steps} steps in {duration}, from \
         each level to each other {least} to {most} times."
    )
}

fn hold_text(schedule: &Schedule) -> String {
    let (shortest, longest) = schedule.hold_range_s();
    let (shortest, longest) = (rounded(shortest), measure(longest, Some("s")));
    if longest.trim_end_matches(" s") == shortest {
        return longest;
    }
    format!("{shortest} to {longest}")
}

fn listed(levels: &[f64], unit: Option<&str>) -> String {
    let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
    let all: Vec<String> = levels.iter().map(|level| rounded(*level)).collect();
    match all.as_slice() {
        [before @ .., last] if !before.is_empty() => {
            format!("{} and {last}{unit}", before.join(", "))
        }
        _ => format!("{}{unit}", all.concat()),
    }
}

/// A row for each suspect.
fn side_table(told: &Told) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::UTF8_BORDERS_ONLY)
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(["if it is", "expected power", "rehearsed", "other", "neither"]);
    for (id, side) in told.ids.iter().zip(&told.design.sides) {
        let Expected { rival, neither, .. } = side.expected;
        let power = if side.is_told { format!("{:.3}", side.expected.power()) } else { "-".into() };
        let rehearsed = side.rehearsal.map_or_else(
            || "-".to_owned(),
            |Rehearsal { told, of }| format!("{told} of {of} told"),
        );
        let far = |noncentrality: f64| format!("λ = {}", rounded(noncentrality));
        let (rival, neither) = (far(rival.noncentrality()), far(neither.noncentrality()));
        table.add_row([(*id).to_owned(), power, rehearsed, rival, neither]);
    }
    for right in 1..5 {
        if let Some(column) = table.column_mut(right) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

/// What the figures are about.
fn explanation(joint: &DesignedJoint, told: &Told) -> String {
    let Told { ids, design, wanted, noise, .. } = told;
    let noise = measure(*noise, joint.stand.output_unit.as_deref());
    let mut sentences = vec![format!(
        "Power: the probability that explain names the effect that is there and excludes the \
         other, with noise of {noise}; {wanted} was wanted. λ: squared distance to the best fit \
         with the other effect and with neither, in variances of the noise."
    )];
    for (place, side) in design.sides.iter().enumerate().filter(|(_, side)| !side.is_told) {
        let (is, other) = (ids.get(place), ids.get(1 - place));
        if let (Some(is), Some(other), true) = (is, other, side.is_excluded) {
            sentences.push(format!(
                "The log speaks against {is} already: the input is made for the case that it is \
                 {other}."
            ));
        } else if let (Some(is), Some(other)) = (is, other) {
            let lambda = rounded(side.expected.rival.noncentrality());
            sentences.push(format!(
                "If it is {is}, {other} can do the same (λ = {lambda}), and stays possible \
                 whatever is played."
            ));
        }
    }
    sentences.join(" ")
}

/// Where the joint will be.
fn foreseen(joint: &DesignedJoint, prediction: &Prediction) -> String {
    let unit = joint.stand.output_unit.as_deref();
    let (low, high) = prediction.extent();
    let margin = measure(prediction.largest_margin(), unit);
    let start = measure(joint.stand.start, unit);
    let from = format!(
        "From {start} the joint is expected within {} to {}, a margin of up to {margin} \
         (two standard deviations) included.",
        rounded(low),
        measure(high, unit)
    );
    match (joint.stand.range, kept_until_s(joint, prediction)) {
        (Some(_), Some(until)) => format!(
            "{from} After {} the model cannot promise that it stays in its range.",
            measure(until, Some("s"))
        ),
        _ => from,
    }
}

/// `0 V for 0.55 s, 1 V for 1 s, …`, as far as anybody reads it.
fn level_by_level(joint: &DesignedJoint) -> String {
    const SHOWN: usize = 24;
    let holds = holds(&joint.schedule);
    let unit = joint.stand.input_unit.as_deref();
    let shown = holds.iter().take(SHOWN);
    let shown = shown.map(|h| format!("{} for {} s", measure(h.level, unit), rounded(h.hold_s)));
    let more = match holds.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    format!("Input: {}{more}.", shown.collect::<Vec<_>>().join(", "))
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
            add(other, outputs.clone(), f64::NAN);
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
