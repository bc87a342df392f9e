//! Accepted steps among all segments: their names, and their state as numbers.

use crate::delay::{StepState, Verdict};
use crate::experiment::Joint;
use crate::figure::delay_levels::Way;
use crate::recording::chunk::{Chunks, Index, fine_columns, integers, numbers};
use crate::recording::error::RecordError;
use crate::recording::layout::{JointLayout, SegmentLayout, TrialLayout};
use crate::recording::paths::child;
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

/// A row per accepted step, at its input step.
pub(super) fn add_numbers(
    chunks: &mut Chunks,
    joint: &Joint,
    placed: &[Placed<'_, '_>],
) -> Result<(), RecordError> {
    type Value = fn(&StepState) -> Option<f64>;
    let accepted = || {
        placed.iter().filter_map(|placed| {
            let moment = placed.trial.opening(placed.segment);
            Some((moment, placed.segment.decision, placed.step?.1))
        })
    };
    let index: Index = accepted().map(|(moment, ..)| moment).collect();
    let delta = accepted().map(|(_, decision, _)| Some(decision.breakpoint()?.delay));
    let fine: Vec<_> = accepted().map(|(_, decision, _)| decision.fine).collect();
    let quantities: [(&str, Value); 6] = [
        ("delay_s", |step| Some(step.delay_s)),
        ("average_speed", |step| Some(step.average_speed)),
        ("input_change", |step| Some(step.input_change)),
        ("dwell_s", |step| step.dwell_s),
        ("angle", |step| Some(step.angle)),
        ("time_s", |step| Some(step.time_s)),
    ];
    let mut columns = vec![integers("delta", delta)];
    let of_steps = |value: Value| accepted().map(move |(.., step)| value(step));
    columns.extend(quantities.map(|(name, value)| numbers(name, of_steps(value))));
    columns.extend(fine_columns(&fine));
    chunks.push("delay/state", index, columns)?;
    for (number, signal) in joint.covariates.iter().enumerate() {
        let measured = accepted()
            .filter_map(|(moment, _, step)| Some((moment, Some((*step.covariates.get(number)?)?))));
        let (moments, values): (Vec<_>, Vec<_>) = measured.unzip();
        let entity = child("delay/state/covariate", &signal.name);
        chunks.scalars(entity, moments.into_iter().collect(), &values)?;
    }
    Ok(())
}
