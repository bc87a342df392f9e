//! Accepted steps among all segments: their names, and their state as numbers.

use serde_json::Value;

use crate::delay::{Decision, StepState, Verdict};
use crate::experiment::Joint;
use crate::figure::delay_levels::Way;
use crate::recording::chunk::{Chunks, columns};
use crate::recording::error::RecordError;
use crate::recording::layout::{JointLayout, SegmentLayout, TrialLayout};
use crate::recording::paths::child;
use crate::report::Kind::{self, Real, Whole};
use crate::wording::{number, samples_text};

/// A segment, and its step among the accepted ones, with its place there.
pub(super) struct Placed<'l, 'a> {
    pub(super) trial: &'l TrialLayout<'a>,
    pub(super) segment: &'l SegmentLayout<'a>,
    pub(super) step: Option<(usize, &'l StepState)>,
}

impl Placed<'_, '_> {
    /// What an accepted step is called under the pointer: with the number to go there.
    pub(super) fn name(&self) -> Option<String> {
        self.step?;
        let segment = self.segment.number;
        Some(format!("{} (segment {segment})", self.trial.step(self.segment)))
    }

    /// Which step is marked, or why none is.
    pub(super) fn sentence(&self) -> String {
        let decision = self.segment.decision;
        let words = self.trial.step(self.segment);
        match (decision.verdict(), self.step, decision.delay()) {
            (Verdict::Rejected(condition), ..) => {
                format!("{words}: rejected, {}", condition.meaning())
            }
            (Verdict::Accepted, Some((_, state)), Some(delay)) => {
                let direction = Way::of(state).word();
                let (samples, seconds) = (samples_text(delay), number(state.delay_s));
                format!("● {words}, {direction}: delay {samples} = {seconds} s")
            }
            (Verdict::Accepted, ..) => words,
        }
    }
}

/// All segments of the joint, in order.
pub(super) fn placed<'l, 'a>(
    layout: &'l JointLayout<'a>,
    steps: &'l [StepState],
) -> Vec<Placed<'l, 'a>> {
    let mut coming = steps.iter().enumerate().peekable();
    let place = |(trial, segment): (&'l TrialLayout<'a>, &'l SegmentLayout<'a>)| {
        let is_this = |step: &StepState| {
            step.number == segment.decision.number && *step.trial == *trial.trial.label()
        };
        Placed { trial, segment, step: coming.next_if(|(_, step)| is_this(step)) }
    };
    layout.segments().map(place).collect()
}

/// A decision, with the state of its step.
type Accepted<'s> = (&'s Decision, &'s StepState);

/// What a program reads of an accepted step.
#[rustfmt::skip]
const STATE: [(&str, Kind, fn(&Accepted<'_>) -> Value); 10] = [
    ("delta", Whole, |(decision, _)| decision.breakpoint().map(|best| best.delay).into()),
    ("delay_s", Real, |(_, step)| step.delay_s.into()),
    ("average_speed", Real, |(_, step)| step.average_speed.into()),
    ("input_change", Real, |(_, step)| step.input_change.into()),
    ("dwell_s", Real, |(_, step)| step.dwell_s.into()),
    ("angle", Real, |(_, step)| step.angle.into()),
    ("time_s", Real, |(_, step)| step.time_s.into()),
    ("fine_delta", Real, |(decision, _)| decision.fine.map(|fine| fine.delay).into()),
    ("delta_low", Real, |(decision, _)| decision.fine.map(|fine| fine.low).into()),
    ("delta_high", Real, |(decision, _)| decision.fine.map(|fine| fine.high).into()),
];

/// A row per accepted step, at its input step.
pub(super) fn add_numbers(
    chunks: &mut Chunks,
    joint: &Joint,
    placed: &[Placed<'_, '_>],
) -> Result<(), RecordError> {
    let accepted = placed.iter().filter_map(|placed| {
        let moment = placed.trial.opening(placed.segment);
        Some((moment, (placed.segment.decision, placed.step?.1)))
    });
    let (moments, steps): (Vec<_>, Vec<Accepted<'_>>) = accepted.unzip();
    // The last three are of delays between samples.
    let is_fine = steps.iter().any(|(decision, _)| decision.fine.is_some());
    let known = if is_fine { &STATE[..] } else { &STATE[..7] };
    chunks.push("delay/state", moments.iter().copied().collect(), columns(&steps, known))?;
    for (number, signal) in joint.covariates.iter().enumerate() {
        let measured = moments.iter().zip(&steps).filter_map(|(moment, (_, step))| {
            Some((*moment, Some((*step.covariates.get(number)?)?)))
        });
        let (moments, values): (Vec<_>, Vec<_>) = measured.unzip();
        let entity = child("delay/state/covariate", &signal.name);
        chunks.scalars(entity, moments.into_iter().collect(), &values)?;
    }
    Ok(())
}
