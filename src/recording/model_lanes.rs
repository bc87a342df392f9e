//! Lanes below the plots of models: the worst segments, what was not fitted to, where the model
//! fails. A plot of Rerun has no shaded parts.

use std::ops::RangeInclusive;

use rerun::{Color, EntityPath, StateChange, StateConfiguration};

use super::chunk::{Chunks, Index, Moment};
use super::error::RecordError;
use super::layout::{JointLayout, TrialLayout};
use super::palette;
use super::paths::{self, at};
use super::shaded::{Spans, condition, validation, where_it_fails};
use crate::diagnosis::Comparison;
use crate::diagnosis::failure::WorstSegment;
use crate::experiment::Joint;
use crate::wording::misfit_units;

/// Adds `/worst`, `/part` and `/fails`.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    layout: &JointLayout<'_>,
    (joint, comparison): (&Joint, &Comparison),
) -> Result<(), RecordError> {
    worst(chunks, root, layout, comparison)?;
    let part = |name: &str| (name.to_owned(), palette::dimmed(palette::SMOOTHED));
    spans(chunks, &at(root, paths::PART), layout, (&validation(comparison), part("not fitted")))?;
    let Some(condition) = condition(comparison) else { return Ok(()) };
    let units = misfit_units(joint);
    let clauses: Vec<_> = condition.clauses.iter().map(|clause| clause.with_unit(&units)).collect();
    let name = (clauses.join(" and "), palette::REJECTED);
    spans(chunks, &at(root, paths::FAILS), layout, (&where_it_fails(comparison), name))
}

/// A lane that says `name` where the spans are.
fn spans(
    chunks: &mut Chunks,
    entity: &EntityPath,
    layout: &JointLayout<'_>,
    (spans, (name, rgb)): (&Spans, (String, palette::Rgb)),
) -> Result<(), RecordError> {
    let marks = spans.iter().filter_map(|(index, span)| {
        let trial = layout.trials.iter().find(|trial| trial.index == *index)?;
        Some([
            (trial.moment_of(span.start + 1), name.clone()),
            (trial.moment_of(span.end + 1), String::new()),
        ])
    });
    let marks: Vec<_> = marks.flatten().collect();
    if marks.is_empty() {
        return Ok(());
    }
    let color: Color = palette::color(rgb);
    let style = StateConfiguration::new().with_values([name.clone()]).with_colors([color]);
    chunks.push_static(entity.clone(), &style)?;
    push(chunks, entity.clone(), marks)
}

fn push(
    chunks: &mut Chunks,
    entity: EntityPath,
    mut marks: Vec<(Moment, String)>,
) -> Result<(), RecordError> {
    marks.sort_by_key(|(moment, name)| (moment.sample, !name.is_empty()));
    let (index, names): (Vec<_>, Vec<_>) = marks.into_iter().unzip();
    let states = StateChange::new().with_state(names).columns_of_unit_batches()?;
    let index: Index = index.into_iter().collect();
    chunks.push(entity, index.without_segment(), states)
}

/// A lane that is marked where the model's worst segments are.
fn worst(
    chunks: &mut Chunks,
    root: &EntityPath,
    layout: &JointLayout<'_>,
    comparison: &Comparison,
) -> Result<(), RecordError> {
    let mut marks = Vec::new();
    for (worst, rank) in comparison.failure.iter().flat_map(|f| &f.worst_segments).zip(1..) {
        let of_label = layout.trials.iter().find(|trial| trial.trial.label() == worst.trial);
        let Some(trial) = of_label else { continue };
        let samples = samples_of(worst, trial);
        // A longer name would be cut off: a segment is narrow.
        marks.push((trial.moment_of(*samples.start()), rank.to_string()));
        marks.push((trial.moment_of(samples.end() + 1), String::new()));
    }
    if marks.is_empty() {
        let start = layout.trials.iter().find_map(|trial| trial.moments(1).next());
        marks.extend(start.map(|start| (start, "none: the model is adequate".to_owned())));
    }
    push(chunks, at(root, paths::WORST), marks)?;
    let hint = ["on `sample`, `time` or `decision`: choose it at the bottom left"];
    let hint = StateChange::new().with_state(hint).columns_of_unit_batches()?;
    chunks.push(at(root, paths::WORST), Index::off_the_record(layout.first), hint)
}

/// The samples of `worst` in its trial, counted from 1.
pub(super) fn samples_of(worst: &WorstSegment, trial: &TrialLayout<'_>) -> RangeInclusive<usize> {
    let period = trial.trial.period().seconds();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside")]
    let sample = |time_s: f64| ((time_s - trial.trial.time_s(1)) / period).round() as usize + 1;
    sample(worst.start_s)..=sample(worst.end_s)
}
