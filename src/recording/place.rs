//! Where the cursor is: a line above plots that do not say it themselves, or on which timeline
//! they run where they have nothing.

use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::paths;
use crate::wording::to_place;

/// Adds `/place`.
pub(super) fn add(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    let mut steps = layout.segments().peekable();
    // The first row of all: a viewer that knows a timeline begins at its first tick, and chooses
    // among those that it knows.
    let (opening, start) = match steps.peek() {
        None => (WITHOUT_STEPS, WITHOUT_STEPS),
        Some(_) if layout.first.is_compared => (OPENING_COMPARED, BEFORE),
        Some(_) => (OPENING, BEFORE),
    };
    chunks.pages(paths::PLACE, Index::before_all(layout.first), [opening.to_owned()])?;
    let start = layout.start().map(|moment| (moment, start.to_owned()));
    let steps =
        steps.map(|(trial, segment)| (trial.opening(segment), words(layout, trial, segment)));
    let (moments, texts): (Vec<_>, Vec<_>) = start.into_iter().chain(steps).unzip();
    let index = moments.into_iter().collect::<Index>().without_segment();
    chunks.pages(paths::PLACE, index, texts)?;
    chunks.pages(paths::PLACE, Index::off_the_record(layout.first), [HINT.to_owned()])
}

const BEFORE: &str = "before the first step";

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
    format!(
        "{}, {in_trial} **of the trial** · {} at {} s **of all trials in a row**, as in the plots · \
         {AXIS}",
        plain(trial.trial.label()),
        trial.sample(p),
        seconds(trial.seconds(p))
    )
}
