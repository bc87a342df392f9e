//! The delay table as a drawing: the median delay over the level, by the kind of step.

use super::panel::Place;
use super::role::Role;
use super::span::Span;
use crate::delay::{DelayRow, DelayTable, Transition};

/// The rows of one kind.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    pub(crate) kind: Transition,
    pub(crate) role: Role,
    /// The median at each level, with how many of how many steps were accepted.
    pub(crate) medians: Vec<(Place, String)>,
    /// From the lower to the upper end of the median's interval.
    pub(crate) intervals: Vec<Vec<Place>>,
    /// Levels at which no step was accepted, with how many there were.
    pub(crate) without: Vec<(f64, String)>,
}

/// A series for each kind that there is.
pub(crate) fn series(table: &DelayTable) -> Vec<Series> {
    let of_kind = |kind: Transition| {
        let rows: Vec<&DelayRow> = table.rows.iter().filter(|row| row.transition == kind).collect();
        let counted = |row: &DelayRow| format!("{}/{}", row.accepted, row.steps);
        let median = |row: &&DelayRow| Some(((level(row), row.delay?.median_s), counted(row)));
        let interval = |row: &&DelayRow| {
            let (low, high) = row.delay?.interval_s?;
            Some(vec![(level(row), low), (level(row), high)])
        };
        let without = rows.iter().filter(|row| row.delay.is_none());
        (!rows.is_empty()).then(|| Series {
            kind,
            role: role(kind),
            medians: rows.iter().filter_map(median).collect(),
            intervals: rows.iter().filter_map(interval).collect(),
            without: without.map(|row| (level(row), counted(row))).collect(),
        })
    };
    Transition::ALL.into_iter().filter_map(of_kind).collect()
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

/// The ranges of levels and delays; none where no delay was accepted. An interval counts up
/// to three times the greatest median: those of two or three steps reach far.
pub(crate) fn spans(all: &[Series]) -> Option<(Span, Span)> {
    let medians = || all.iter().flat_map(|one| &one.medians).map(|(place, _)| *place);
    let greatest = medians().map(|place| place.1).fold(f64::NEG_INFINITY, f64::max);
    let without = all.iter().flat_map(|one| &one.without).map(|(level, _)| *level);
    let ends = all.iter().flat_map(|one| &one.intervals).flatten();
    let ends = ends.map(|place| place.1.min(3.0 * greatest.max(0.0)));
    let levels = Span::around(medians().map(|place| place.0).chain(without), 0.08);
    let delays = Span::around(medians().map(|place| place.1).chain(ends), 0.12);
    greatest.is_finite().then_some((levels, delays))
}
