//! Parts of the record that are marked behind a residual: what the model was not fitted to, where it is
//! worst, and where it fails.

use std::ops::Range;

use crate::diagnosis::Comparison;
use crate::diagnosis::failure::{FailsWhere, WorstSegment};
use crate::experiment::Joint;
use crate::fit::Part;
use crate::units::floor_to_index;
use crate::wording::misfit_units;

/// Samples of a trial, counted from 0, with the trial's index among those of its joint.
pub(crate) type Spans = Vec<(usize, Range<usize>)>;

/// The part that was not fitted to.
pub(crate) fn validation(comparison: &Comparison) -> Spans {
    let steps = comparison.per_step.iter().filter(|step| step.part == Part::Validation);
    joined(steps.map(|step| (step.trial, step.start..step.start + step.samples)))
}

/// The worst segments, in their order.
pub(crate) fn worst(joint: &Joint, comparison: &Comparison) -> Spans {
    let segments = comparison.failure.iter().flat_map(|failure| &failure.worst_segments);
    let span = |worst: &WorstSegment| {
        let mut trials = joint.trials.iter().enumerate();
        let (index, trial) = trials.find(|(_, trial)| trial.label() == worst.trial)?;
        let [first, last] = [worst.start_s, worst.end_s].map(|time_s| {
            floor_to_index(((time_s - trial.time_s(1)) / trial.period().seconds()).round())
        });
        Some((index, first..last + 1))
    };
    segments.filter_map(span).collect()
}

/// The condition under which most of the error arises.
fn condition(comparison: &Comparison) -> Option<&FailsWhere> {
    FailsWhere::strongest(&comparison.failure.as_ref()?.fails_where)
}

/// Its name, and where it holds.
pub(crate) fn named(joint: &Joint, comparison: &Comparison) -> Option<(String, Spans)> {
    let units = misfit_units(joint);
    let clauses = condition(comparison)?.clauses.iter().map(|clause| clause.with_unit(&units));
    let name = clauses.collect::<Vec<_>>().join(" and ");
    Some((name, where_it_fails(comparison)))
}

/// Where that condition holds.
fn where_it_fails(comparison: &Comparison) -> Spans {
    let samples = condition(comparison).map_or(&[][..], |condition| &condition.samples);
    let mut holding = samples.iter().map(|sample| *sample as usize).peekable();
    let mut spans = Spans::new();
    let mut start = 0;
    for (index, residual) in comparison.fit.evaluation.residuals.iter().enumerate() {
        let end = start + residual.len();
        let own = std::iter::from_fn(|| holding.next_if(|sample| *sample < end));
        spans.extend(joined(own.map(|sample| (index, sample - start..sample - start + 1))));
        start = end;
    }
    spans
}

/// Neighbours as one.
fn joined(spans: impl Iterator<Item = (usize, Range<usize>)>) -> Spans {
    let mut all: Spans = Vec::new();
    for (trial, span) in spans {
        match all.last_mut() {
            Some((known, last)) if *known == trial && last.end == span.start => last.end = span.end,
            _ => all.push((trial, span)),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_joined_within_a_trial() {
        let spans = [(0, 0..2), (0, 2..5), (0, 7..9), (1, 9..10)];
        assert_eq!(joined(spans.into_iter()), [(0, 0..5), (0, 7..9), (1, 9..10)]);
    }
}
