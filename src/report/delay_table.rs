//! The delays by kind of step and level, as a typed table and for people.

use serde_json::{Map, Value};

use super::text_table::TextTable;
use super::{DataTable, EstimatedJoint, JointSummary, Kind};
use crate::delay::{Condition, DelayRow, DelayTable, KindDelay, Remedy, Transition, TypicalDelay};
use crate::wording::{number, remedy_text, unit_suffix};

/// Names and kinds of the columns.
const COLUMNS: [(&str, Kind); 11] = [
    ("joint", Kind::Text),
    ("transition", Kind::Text),
    ("level_from", Kind::Real),
    ("level_to", Kind::Real),
    ("steps", Kind::Whole),
    ("accepted", Kind::Whole),
    ("delay_median_s", Kind::Real),
    ("delay_low_s", Kind::Real),
    ("delay_high_s", Kind::Real),
    ("delay_min_s", Kind::Real),
    ("delay_max_s", Kind::Real),
];

/// One row of `--table`: levels are means of a bin, low and high bound the median at 95 %.
pub(super) fn row_json(joint: &str, row: &DelayRow) -> Map<String, Value> {
    let delay = row.delay;
    let interval = delay.and_then(|delay| delay.interval_s);
    let cells: [Value; COLUMNS.len()] = [
        joint.into(),
        row.transition.id().into(),
        row.level_from.into(),
        row.level_to.into(),
        row.steps.into(),
        row.accepted.into(),
        delay.map(|delay| delay.median_s).into(),
        interval.map(|(low, _)| low).into(),
        interval.map(|(_, high)| high).into(),
        delay.map(|delay| delay.min_s).into(),
        delay.map(|delay| delay.max_s).into(),
    ];
    COLUMNS.into_iter().map(|(name, _)| name.to_owned()).zip(cells).collect()
}

/// The rows of all joints, as a table with types.
pub(crate) fn level_table(joints: &[EstimatedJoint<'_>]) -> DataTable {
    let mut table = DataTable::new(COLUMNS);
    for joint in joints {
        for row in &joint.delay_table().rows {
            table.push(&row_json(&joint.joint.name, row));
        }
    }
    table
}

/// What the cells of [`level_cells`] are.
pub(crate) const LEVEL_HEADER: [&str; 8] =
    ["transition", "from", "to", "steps", "accepted", "median", "95 % interval", "min to max"];

/// A row for people.
pub(crate) fn level_cells(row: &DelayRow) -> [String; 8] {
    let dash = || "-".to_owned();
    let level = |level: f64, (low, high): (f64, f64)| {
        if low < high { format!("{} to {}", number(low), number(high)) } else { number(level) }
    };
    let range = |low: f64, high: f64| format!("{low:.3} to {high:.3} s");
    let interval = row.delay.and_then(|delay| delay.interval_s);
    [
        row.transition.to_string(),
        level(row.level_from, row.from_limits),
        level(row.level_to, row.to_limits),
        row.steps.to_string(),
        row.accepted.to_string(),
        row.delay.map_or_else(dash, |delay| format!("{:.3} s", delay.median_s)),
        interval.map_or_else(dash, |(low, high)| range(low, high)),
        row.delay.map_or_else(dash, |delay| range(delay.min_s, delay.max_s)),
    ]
}

/// The rows of a joint for people.
pub(super) fn level_table_text(rows: &[DelayRow]) -> TextTable {
    TextTable::of(LEVEL_HEADER, &[1, 2, 3, 4, 5], rows.iter().map(level_cells))
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
    let table = level_table_text(&found.rows);
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
            "the input is neutral at {}{}; a start leaves it, a stop leads to it",
            number(neutral.level),
            unit_suffix(unit)
        ),
        None => "the record does not show at which level the input is neutral: every step is a \
                 change"
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
            "{transition}: no typical delay, {accepted} of {steps} steps accepted{why}"
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
                "stop: no typical delay, 1 of 26 steps accepted; 25 rejected: first or last step \
                 of the trial"
            )
        );
    }
}
