//! Lanes below the plots of models: the worst segments, what was not fitted to, where the model
//! fails. A plot of Rerun has no shaded parts.

use std::ops::RangeInclusive;

use rerun::StateConfiguration;

use super::chunk::{Chunks, Index, Moment};
use super::error::RecordError;
use super::layout::{JointLayout, TrialLayout};
use super::palette::{self, color};
use super::paths;
use crate::diagnosis::Comparison;
use crate::diagnosis::failure::WorstSegment;
use crate::experiment::Joint;
use crate::report::page::shaded::{named, validation};

/// Adds `/worst`, `/part` and `/fails`.
pub(super) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    (joint, comparison): (&Joint, &Comparison),
) -> Result<(), RecordError> {
    worst(chunks, layout, comparison)?;
    let grey = palette::dimmed(palette::SMOOTHED);
    let mut lanes = vec![(paths::PART, validation(comparison), "not fitted".to_owned(), grey)];
    lanes.extend(
        named(joint, comparison)
            .map(|(name, spans)| (paths::FAILS, spans, name, palette::REJECTED)),
    );
    for (path, spans, name, rgb) in lanes {
        let marks = spans.iter().filter_map(|(index, span)| {
            let trial = layout.trial(*index)?;
            Some([
                (trial.moment_of(span.start + 1), name.clone()),
                (trial.moment_of(span.end + 1), String::new()),
            ])
        });
        let marks: Vec<_> = marks.flatten().collect();
        if !marks.is_empty() {
            let style = StateConfiguration::new().with_values([name.clone()]);
            chunks.push_static(path, &style.with_colors([color(rgb)]))?;
            push(chunks, path, marks)?;
        }
    }
    Ok(())
}

fn push(
    chunks: &mut Chunks,
    path: &str,
    mut marks: Vec<(Moment, String)>,
) -> Result<(), RecordError> {
    marks.sort_by_key(|(moment, name)| (moment.sample, !name.is_empty()));
    let (moments, names): (Vec<_>, Vec<_>) = marks.into_iter().unzip();
    chunks.states(path, moments.into_iter().collect::<Index>().without_segment(), names)
}

/// A lane that is marked where the model's worst segments are.
fn worst(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    comparison: &Comparison,
) -> Result<(), RecordError> {
    let mut marks = Vec::new();
    for (worst, rank) in comparison.failure.iter().flat_map(|f| &f.worst_segments).zip(1..) {
        let Some(trial) = layout.trial_of(&worst.trial) else { continue };
        let samples = samples_of(worst, trial);
        // A longer name would be cut off: a segment is narrow.
        marks.push((trial.moment_of(*samples.start()), rank.to_string()));
        marks.push((trial.moment_of(samples.end() + 1), String::new()));
    }
    if marks.is_empty() {
        let adequate = "none: the model is adequate".to_owned();
        marks.extend(layout.start().map(|start| (start, adequate)));
    }
    push(chunks, paths::WORST, marks)?;
    let hint = ["on `sample`, `time` or `decision`: choose it at the bottom left"];
    chunks.states(paths::WORST, Index::off_the_record(layout.first), hint)
}

/// The samples of `worst` in its trial, counted from 1.
pub(super) fn samples_of(worst: &WorstSegment, trial: &TrialLayout<'_>) -> RangeInclusive<usize> {
    let period = trial.trial.period().seconds();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside")]
    let sample = |time_s: f64| ((time_s - trial.trial.time_s(1)) / period).round() as usize + 1;
    sample(worst.start_s)..=sample(worst.end_s)
}
