//! The delays of a joint by kind of step and level, against its state, and at every sample.

use std::collections::HashSet;
use std::io::Write;

use Kind::{Real, Text, Whole};
use Part::{Json, People, Table};
use Place::{Recording, Terminal};
use serde_json::{Value, json};

use super::facts::{self, Fact, Part, Place, UNSAID, Unit, fact};
use super::table::write_csv;
use super::{DataTable, EstimatedJoint, JointSummary, Kind, TextTable};
use crate::delay::{
    AgainstOfKind, AgainstState, Condition, Correlation, DelayProfile, DelayRow, DelayTable,
    KindDelay, Remedy, Transition, TypicalDelay,
};
use crate::experiment::Trial;
use crate::numerics::to_nanoseconds;
use crate::wording::{bracketed, number, p_cell, remedy_text, unit_suffix};

/// A row of the table of a joint, with its name.
pub(crate) type Level<'a> = (&'a str, &'a DelayRow);

pub(super) type LevelFact = Fact<fn(&Level<'_>) -> Value>;

const PEOPLE: &[Place] = &[Terminal, Recording];

/// All of it, in the order of the columns of `--table`: levels are means of a bin, low and high bound
/// the median at 95 %.
#[rustfmt::skip]
pub(super) const LEVEL: &[LevelFact] = &[
    fact("joint", Text, Table, ("joint", "", Unit::None, &[Recording]), |(joint, _)| (*joint).into()),
    fact("transition", Text, Table, ("transition", "", Unit::None, PEOPLE), |(_, row)| row.transition.id().into()),
    fact("level_from", Real, Table, UNSAID, |(_, row)| row.level_from.into()),
    fact("level_to", Real, Table, UNSAID, |(_, row)| row.level_to.into()),
    fact("from", Real, People, ("from", "", Unit::None, PEOPLE), |(_, row)| level(row.level_from, row.from_limits)),
    fact("to", Real, People, ("to", "", Unit::None, PEOPLE), |(_, row)| level(row.level_to, row.to_limits)),
    fact("steps", Whole, Table, ("steps", "", Unit::None, PEOPLE), |(_, row)| row.steps.into()),
    fact("accepted", Whole, Table, ("accepted", "", Unit::None, PEOPLE), |(_, row)| row.accepted.into()),
    fact("delay_median_s", Real, Table, UNSAID, |(_, row)| row.delay.map(|delay| delay.median_s).into()),
    fact("delay_low_s", Real, Table, UNSAID, |(_, row)| interval(row).map(|(low, _)| low).into()),
    fact("delay_high_s", Real, Table, UNSAID, |(_, row)| interval(row).map(|(_, high)| high).into()),
    fact("delay_min_s", Real, Table, UNSAID, |(_, row)| row.delay.map(|delay| delay.min_s).into()),
    fact("delay_max_s", Real, Table, UNSAID, |(_, row)| row.delay.map(|delay| delay.max_s).into()),
    fact("median", Real, People, ("median", "", Unit::None, PEOPLE), |(_, row)| said(row.delay.map(|delay| format!("{:.3} s", delay.median_s)))),
    fact("interval", Text, People, ("95 % interval", "", Unit::None, PEOPLE), |(_, row)| said(interval(row).map(range))),
    fact("range", Text, People, ("min to max", "", Unit::None, PEOPLE), |(_, row)| said(row.delay.map(|delay| range((delay.min_s, delay.max_s))))),
    fact("level_from_limits", Real, Json, UNSAID, |(_, row)| json!(row.from_limits)),
    fact("level_to_limits", Real, Json, UNSAID, |(_, row)| json!(row.to_limits)),
];

fn level(level: f64, (low, high): (f64, f64)) -> Value {
    let range = format!("{} to {}", number(low), number(high));
    if low < high { range.into() } else { number(level).into() }
}

fn interval(row: &DelayRow) -> Option<(f64, f64)> {
    row.delay?.interval_s
}

fn range((low, high): (f64, f64)) -> String {
    format!("{low:.3} to {high:.3} s")
}

/// What a cell says; a column of which nothing is known stays.
fn said(text: Option<String>) -> Value {
    text.unwrap_or_else(|| "-".to_owned()).into()
}

/// A row in JSON.
pub(super) fn level_json(joint: &str, row: &DelayRow) -> Value {
    facts::object(LEVEL, Json, &(joint, row)).into()
}

/// The rows of all joints, as a table with types.
pub(crate) fn level_table(joints: &[EstimatedJoint<'_>]) -> DataTable {
    let tables: Vec<_> = joints.iter().map(|joint| (joint, joint.delay_table().rows)).collect();
    let rows = tables
        .iter()
        .flat_map(|(joint, rows)| rows.iter().map(|row| (joint.joint.name.as_str(), row)));
    facts::data_table(LEVEL, Table, rows)
}

/// Rows as a person reads them at `place`.
pub(crate) fn levels_text<'a>(place: Place, rows: impl Iterator<Item = Level<'a>>) -> TextTable {
    facts::text_table(LEVEL, place, None, rows)
}

/// The tables of all joints for the terminal.
pub(crate) fn delay_levels_text(joints: &[EstimatedJoint<'_>]) -> String {
    joints.iter().map(joint_text).collect()
}

fn joint_text(joint: &EstimatedJoint<'_>) -> String {
    let found = joint.delay_table();
    let name = &joint.joint.name;
    if found.rows.is_empty() {
        let why = JointSummary::of(*joint).without_steps;
        return format!("\n{name}: no delay table: {why}\n");
    }
    let neutral = neutral_sentence(&found, joint.joint.input_unit.as_deref());
    let rows = found.rows.iter().map(|row| (name.as_str(), row));
    let table = levels_text(Terminal, rows);
    let kinds = joint.kind_sentences(&found.kinds);
    format!("\n{name}: {neutral}\n{table}\n{}\n", kinds.join("\n"))
}

impl EstimatedJoint<'_> {
    /// The typical delays of `kinds` in words; where no delay of the joint can be believed, why.
    pub(crate) fn kind_sentences(&self, kinds: &[KindDelay]) -> Vec<String> {
        let is_none_accepted = kinds.iter().all(|kind| kind.accepted == 0);
        match self.obstacle().filter(|_| is_none_accepted && !kinds.is_empty()) {
            Some(obstacle) => vec![format!("no typical delay: {}", obstacle.short)],
            None => kinds.iter().map(kind_sentence).collect(),
        }
    }
}

/// Where the input is neutral.
pub(super) fn neutral_sentence(found: &DelayTable, unit: Option<&str>) -> String {
    match found.neutral {
        Some(neutral) => format!(
            "the neutral level of the input is {}{}: a start leaves it, a stop returns to it",
            number(neutral.level),
            unit_suffix(unit)
        ),
        None => "the record does not show a neutral level of the input, so every step is a change"
            .to_owned(),
    }
}

/// The typical delay of a kind, or what prevents it and what helps.
fn kind_sentence(kind: &KindDelay) -> String {
    let KindDelay { transition, steps, accepted, .. } = kind;
    let Some(typical) = kind.typical else {
        let why = kind.rejected.map_or_else(String::new, |(condition, count)| {
            format!("; {count} rejected: {}; {}", condition.meaning(), help(condition, *transition))
        });
        return format!(
            "{transition}: no typical delay: too few accepted steps ({accepted} of {steps}){why}"
        );
    };
    let TypicalDelay { median_s, interval_s, .. } = typical;
    let interval = interval_s.map_or_else(String::new, |(low, high)| {
        format!(" (median, 95 %: {low:.3} to {high:.3} s)")
    });
    format!("{transition}: delay {median_s:.3} s{interval}, {accepted} of {steps} steps accepted")
}

/// Which option or experiment would give more delays.
fn help(condition: Condition, transition: Transition) -> String {
    let text = match condition {
        // A joint that rests when its input is taken back has run into its stop.
        Condition::AtRest if transition == Transition::Stop => "step back before the stop",
        Condition::FirstOrLast => {
            return format!("{} judges them", remedy_text(Remedy::KeepFirstLast, "`"));
        }
        Condition::OutputLimit => "start away from the limit, or widen `--output-limits`",
        Condition::SlopeChange => "lower `--min-slope-change`, or make larger steps",
        Condition::ShortHold => "lower `--min-delay`, or hold longer",
        Condition::Sse => "raise `--max-sse`",
        Condition::TooShort => "hold longer, or choose a smaller `--beta`",
        _ => "make larger steps from rest, where the joint is free to move",
    };
    text.to_owned()
}

/// Writes `trial,sample,time_s,<joint>.tau…` as CSV: a row per sample, delays in samples,
/// empty where none was recorded.
///
/// # Errors
/// When `out` cannot be written.
pub fn write_delays(joints: &[EstimatedJoint<'_>], out: impl Write) -> csv::Result<()> {
    write_csv(&tau_columns(joints), tau_rows(joints), out)
}

/// The delays that [`write_delays`] writes, as a table with types.
pub(crate) fn delay_table(joints: &[EstimatedJoint<'_>]) -> DataTable {
    let columns = tau_columns(joints);
    let mut table = DataTable::new(columns.iter().map(|(name, kind)| (name.as_str(), *kind)));
    tau_rows(joints).for_each(|row| table.push_cells(row));
    table
}

fn tau_columns(joints: &[EstimatedJoint<'_>]) -> Vec<(String, Kind)> {
    let first = [("trial", Text), ("sample", Whole), ("time_s", Kind::Plain)];
    let taus = joints.iter().map(|joint| (format!("{}.tau", joint.joint.name), Kind::Plain));
    first.map(|(name, kind)| (name.to_owned(), kind)).into_iter().chain(taus).collect()
}

/// All samples of all trials, each with the delay of each joint there.
fn tau_rows(joints: &[EstimatedJoint<'_>]) -> impl Iterator<Item = Vec<Value>> {
    runs(joints).into_iter().flat_map(|run| {
        let columns: Vec<_> = joints.iter().map(|joint| find(*joint, run)).collect();
        let trials = columns.iter().flatten().map(|(trial, _)| *trial);
        let longest = trials.max_by_key(|trial| trial.len());
        let samples = longest.into_iter().flat_map(|longest| {
            (1..=longest.len()).map(|sample| (sample, longest.logged_time_s(sample)))
        });
        samples.map(move |(sample, time_s)| {
            let first = [run.label().into(), sample.into(), to_nanoseconds(time_s).into()];
            let delay =
                |found: &Option<(&Trial, &DelayProfile)>| found.and_then(|(_, of)| of.at(sample));
            first.into_iter().chain(columns.iter().map(|found| delay(found).into())).collect()
        })
    })
}

/// All trials, each once, in the order they first appear. Where joints were split at
/// gaps of their own, parts of one name that start apart are different trials.
fn runs<'a>(joints: &[EstimatedJoint<'a>]) -> Vec<&'a Trial> {
    let mut seen = HashSet::new();
    let all = joints.iter().flat_map(|joint| &joint.joint.trials);
    all.filter(|trial| seen.insert(key(trial))).collect()
}

/// What identifies a run: name, start and sample period.
fn key(trial: &Trial) -> (&str, u64, u64) {
    (trial.label(), trial.time_s(1).to_bits(), trial.period().seconds().to_bits())
}

/// The joint's share of `run`, and its delays.
fn find<'a>(joint: EstimatedJoint<'a>, run: &Trial) -> Option<(&'a Trial, &'a DelayProfile)> {
    let trials = joint.joint.trials.iter().zip(&joint.estimate.trials);
    let mut same = trials.filter(|(trial, _)| key(trial) == key(run));
    let (trial, result) = same.next()?;
    Some((trial, &result.as_ref().ok()?.profile))
}

/// A row per joint, kind of step and variable; `joints` are names and what was found.
pub fn against_table<'a>(joints: impl IntoIterator<Item = (&'a str, &'a AgainstState)>) -> String {
    let mut table = TextTable::new(AGAINST_HEADER, &[3, 4, 5]);
    let mut confounded = Vec::new();
    for (joint, found) in joints {
        for cells in against_rows(joint, found) {
            table.row(cells);
        }
        confounded
            .extend(confounded_sentences(found).into_iter().map(|one| format!("{joint}: {one}\n")));
    }
    let note = format!("{CORRECTED}; `yes`: p at most 0.05");
    format!("{table}\n{note}\n{}", confounded.concat())
}

/// What the record does not tell apart, a sentence for each pair.
pub(super) fn confounded_sentences(found: &AgainstState) -> Vec<String> {
    let of_kind = |kind: &AgainstOfKind| {
        let transition = kind.transition;
        let sentence = move |[one, other]: &[String; 2]| {
            format!(
                "in steps of the kind `{transition}` {} and {} are correlated, so the record does \
                 not show on which of them the delay depends",
                variable_text(one, None),
                variable_text(other, None)
            )
        };
        kind.confounded.iter().map(sentence).collect::<Vec<_>>()
    };
    found.kinds.iter().flat_map(of_kind).collect()
}

/// What is said once of every p-value of the delay against the state.
pub(super) const CORRECTED: &str = "Spearman's rank correlation ρ of the delay with each quantity, \
                                    and p after Holm's correction for their number";

/// What the cells of [`against_rows`] are.
pub(super) const AGAINST_HEADER: [&str; 7] =
    ["joint", "kind of step", "delay against", "steps", "rank correlation", "p", "depends"];

/// The rows of a joint, for people: those of each kind of step for itself. Of a kind with
/// fewer steps than any comparison needs there is one row.
pub(super) fn against_rows(joint: &str, found: &AgainstState) -> Vec<[String; 7]> {
    found.kinds.iter().flat_map(|kind| kind_rows(joint, kind)).collect()
}

fn kind_rows(joint: &str, kind: &AgainstOfKind) -> Vec<[String; 7]> {
    let is_known = |one: &Correlation| one.p_value.is_some();
    let name = kind.transition.to_string();
    if !kind.correlations.iter().any(is_known) {
        let dash = || "-".to_owned();
        let steps = kind.steps.to_string();
        let why = "too few steps, or no change".to_owned();
        return vec![[joint.to_owned(), name, why, steps, dash(), dash(), answer(None)]];
    }
    let full = |[a, b, c, d, e]: [String; 5]| [joint.to_owned(), name.clone(), a, b, c, d, e];
    kind.correlations.iter().map(correlation_row).map(full).collect()
}

fn correlation_row(found: &Correlation) -> [String; 5] {
    let Correlation { variable, unit, steps, rho, p_value, p_holm, significant } = found;
    let rho = rho.map_or_else(|| "-".to_owned(), |rho| format!("{rho:+.2}"));
    [
        variable_text(variable, unit.as_deref()),
        steps.to_string(),
        rho,
        p_cell(*p_holm),
        answer(p_value.map(|_| *significant)),
    ]
}

/// A variable with its unit, where there is one.
pub(crate) fn variable_text(variable: &str, unit: Option<&str>) -> String {
    bracketed(&variable.replace('_', " "), unit)
}

fn answer(significant: Option<bool>) -> String {
    match significant {
        None => "not known".to_owned(),
        Some(true) => "yes".to_owned(),
        Some(false) => "not shown".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_that_ended_at_the_stop_have_a_remedy_of_their_own() {
        let kind = |transition| KindDelay {
            transition,
            steps: 5,
            accepted: 0,
            typical: None,
            rejected: Some((Condition::AtRest, 5)),
        };
        assert!(kind_sentence(&kind(Transition::Stop)).ends_with("; step back before the stop"));
        assert!(!kind_sentence(&kind(Transition::Start)).contains("stop"));
    }

    #[test]
    fn a_typical_delay_needs_steps_that_were_accepted() {
        let delay =
            TypicalDelay { median_s: 0.21, interval_s: Some((0.2, 0.24)), min_s: 0.19, max_s: 0.3 };
        let kind = |typical, accepted| KindDelay {
            transition: Transition::Stop,
            steps: 26,
            accepted,
            typical,
            rejected: Some((Condition::FirstOrLast, 25)),
        };
        assert_eq!(
            kind_sentence(&kind(Some(delay), 20)),
            "stop: delay 0.210 s (median, 95 %: 0.200 to 0.240 s), 20 of 26 steps accepted"
        );
        assert_eq!(
            kind_sentence(&kind(None, 1)).split("; `").next(),
            Some(
                "stop: no typical delay: too few accepted steps (1 of 26); 25 rejected: first or \
                 last step of the trial"
            )
        );
    }
}
