//! Lanes below the plots of models: the worst segments, what was not fitted to, where the model
//! fails. A plot of Rerun has no shaded parts.

use std::ops::Range;

use rerun::StateConfiguration;

use super::chunk::{Chunks, Index, Moment};
use super::error::RecordError;
use super::layout::JointLayout;
use super::palette::{self, color};
use super::paths;
use crate::diagnosis::Comparison;
use crate::experiment::Joint;
use crate::report::page::timeline::{named, validation, worst};

/// A span of a trial with its name.
type Named = ((usize, Range<usize>), String);

/// Adds `/worst`, `/part` and `/fails`.
pub(super) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    (joint, comparison): (&Joint, &Comparison),
) -> Result<(), RecordError> {
    // A longer name would be cut off: a segment is narrow.
    let ranked = worst(joint, comparison).into_iter().zip(1_u32..);
    let ranked: Vec<Named> = ranked.map(|(span, rank)| (span, rank.to_string())).collect();
    let mut marks = marks(layout, ranked);
    if marks.is_empty() {
        let adequate = "none: the model is adequate".to_owned();
        marks.extend(layout.start().map(|start| (start, adequate)));
    }
    push(chunks, paths::WORST, marks)?;
    let hint = ["on `sample`, `time` or `decision`: choose it at the bottom left"];
    chunks.states(paths::WORST, Index::off_the_record(layout.first), hint)?;
    let unfitted = Some(("not fitted".to_owned(), validation(comparison)));
    let grey = palette::dimmed(palette::SMOOTHED);
    let fails = named(joint, comparison);
    for (path, rgb, lane) in
        [(paths::PART, grey, unfitted), (paths::FAILS, palette::REJECTED, fails)]
    {
        let Some((name, spans)) = lane.filter(|(_, spans)| !spans.is_empty()) else { continue };
        let style = StateConfiguration::new().with_values([name.clone()]);
        chunks.push_static(path, &style.with_colors([color(rgb)]))?;
        let spans = spans.into_iter().map(|span| (span, name.clone())).collect();
        push(chunks, path, self::marks(layout, spans))?;
    }
    Ok(())
}

/// Where each span begins, with its name, and where it ends.
fn marks(layout: &JointLayout<'_>, spans: Vec<Named>) -> Vec<(Moment, String)> {
    let marks = spans.into_iter().filter_map(|((index, span), name)| {
        let trial = layout.trial(index)?;
        let [begin, end] = [span.start, span.end].map(|k| trial.moment_of(k + 1));
        Some([(begin, name), (end, String::new())])
    });
    marks.flatten().collect()
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
