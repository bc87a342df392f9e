//! The delay table as a drawing: the median delay over the level, by the kind of step; and which way a
//! step goes.

use super::panel::{Axis, Mark, Panel, Place, Role, Shape};
use super::span::Span;
use crate::delay::{DelayRow, DelayTable, Transition};
use crate::wording::bracketed;

/// The medians over the level of the input, which is measured in `unit`, with their intervals and how many
/// of how many steps were accepted; where none was, a cross at the bottom. None where no delay is known.
pub(crate) fn panel(table: &DelayTable, unit: Option<&str>) -> Option<Panel> {
    let known = || table.rows.iter().filter_map(|row| row.delay);
    let greatest = known().map(|delay| delay.median_s).reduce(f64::max)?;
    // An interval counts up to three times the greatest median: those of two or three steps reach far.
    let ends = known().filter_map(|delay| delay.interval_s).flat_map(|(low, high)| [low, high]);
    let ends = ends.map(|end| end.min(3.0 * greatest.max(0.0)));
    let y = Span::around(known().map(|delay| delay.median_s).chain(ends), 0.12);
    let x = Span::around(table.rows.iter().map(level), 0.08);
    let marks = Transition::ALL.into_iter().flat_map(|kind| {
        let own = table.rows.iter().filter(|row| row.transition == kind);
        of_kind(kind, &own.collect::<Vec<_>>(), y.low + 0.04 * (y.high - y.low))
    });
    Some(Panel {
        x: Axis::new(x, bracketed("level of the input", unit), 8.0),
        y: Axis::new(y, "delay [s]", 5.0),
        height: 220,
        marks: marks.collect(),
    })
}

/// The rows of one kind; those without a delay stand at the `bottom`.
fn of_kind(kind: Transition, rows: &[&DelayRow], bottom: f64) -> Vec<Mark> {
    let counted = |row: &DelayRow| format!("{}/{}", row.accepted, row.steps);
    let place = |row: &DelayRow| (level(row), row.delay.map_or(bottom, |delay| delay.median_s));
    let intervals = rows.iter().filter_map(|row| {
        let (low, high) = row.delay?.interval_s?;
        Some(vec![(level(row), low), (level(row), high)])
    });
    let (known, without): (Vec<&DelayRow>, Vec<&DelayRow>) =
        rows.iter().partition(|row| row.delay.is_some());
    let words = known.iter().chain(&without).map(|row| (place(row), counted(row)));
    let [known, without] =
        [&known, &without].map(|rows| rows.iter().map(|row| place(row)).collect::<Vec<Place>>());
    if rows.is_empty() {
        return Vec::new();
    }
    vec![
        Mark::lines(role(kind), 1.4, intervals.collect()),
        Mark::new(Role::Faint, Shape::Words(words.collect())),
        Mark::dots(role(kind), known).named(kind.id()),
        Mark::new(role(kind), Shape::Crosses(without)),
    ]
}

/// The level that a row stands at: for a stop that before, else that after.
fn level(row: &DelayRow) -> f64 {
    if row.transition == Transition::Stop { row.level_from } else { row.level_to }
}

/// The colour of a kind of step.
pub(crate) fn role(kind: Transition) -> Role {
    match kind {
        Transition::Start => Role::Smoothed,
        Transition::Stop => Role::Model,
        Transition::Change => Role::Accepted,
        Transition::Reversal => Role::Attention,
    }
}
