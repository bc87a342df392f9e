//! Where the cursor is: a line above plots that do not say it themselves, or on which timeline
//! they run where they have nothing.

use rerun::{EntityPath, TextDocument};

use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::paths::{self, at};
use crate::wording::to_place;

/// Adds `/place`.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    let entity = at(root, paths::PLACE);
    // The first row of all: a viewer that knows a timeline begins at its first tick, and chooses
    // among those that it knows.
    let opening = match layout.segments().next() {
        None => WITHOUT_STEPS,
        Some(_) if layout.first.is_compared => OPENING_COMPARED,
        Some(_) => OPENING,
    };
    let opening = std::iter::once(opening.to_owned());
    push(chunks, entity.clone(), Index::before_all(layout.first), opening)?;
    let start = layout.trials.iter().filter_map(|trial| trial.moments(1).next());
    let steps = layout.segments().map(|(trial, segment)| trial.opening(segment));
    let index: Index = start.take(1).chain(steps).collect();
    let steps = layout.segments().map(|(trial, segment)| words(layout, trial, segment));
    let start =
        if layout.segments().next().is_none() { WITHOUT_STEPS } else { "before the first step" };
    let texts: Vec<_> = std::iter::once(start.to_owned()).chain(steps).collect();
    let texts = texts.into_iter().take(index.len());
    push(chunks, entity.clone(), index.without_segment(), texts)?;
    let hint = std::iter::once(HINT.to_owned());
    push(chunks, entity, Index::off_the_record(layout.first), hint)
}

fn push(
    chunks: &mut Chunks,
    entity: EntityPath,
    index: Index,
    texts: impl Iterator<Item = String>,
) -> Result<(), RecordError> {
    let markdown = std::iter::repeat_n("text/markdown", index.len());
    let texts = TextDocument::update_fields().with_many_text(texts).with_many_media_type(markdown);
    chunks.push(entity, index, texts.columns_of_unit_batches()?)
}

const OPENING: &str = "**The most doubtful decision**: the right arrow goes through its candidates, \
then on to the first step.";

const WITHOUT_STEPS: &str = "**No steps**: what is found of the whole record is on the right.";

const OPENING_COMPARED: &str = "**The most different decision**: on `decision` the right arrow \
goes through its candidates, then on to the first step.";

const HINT: &str = "**The whole record is drawn below.** To move along it choose `sample`, `time` or \
`decision` at the bottom left, and the tab *Along …*.";

/// A timeline of candidates stretches the record.
const AXIS: &str = "*`decision` counts candidates: choose `time` for an axis in seconds*";

/// The step, with its place in the trial and, where that is another one, in the recording.
fn words(layout: &JointLayout<'_>, trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) -> String {
    let decision = segment.decision;
    let p = decision.input_step.sample;
    let seconds = |s: f64| to_place(s, 3);
    let of = trial.segments.len();
    let in_trial = format!(
        "**step {} of {of}**: p = sample {p} at {} s",
        decision.number,
        seconds(trial.trial.time_s(p))
    );
    if layout.trials.len() < 2 {
        return format!("{in_trial} · {AXIS}");
    }
    let joined = trial.time_ns(p) as f64 * 1e-9;
    format!(
        "{}, {in_trial} **of the trial** · {} at {} s **of all trials in a row**, as in the plots · \
         {AXIS}",
        plain(trial.trial.label()),
        trial.sample(p),
        seconds(joined)
    )
}
