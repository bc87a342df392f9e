//! Accepted steps among all segments: their names, and their state as numbers.

use rerun::{EntityPath, Scalars};

use crate::delay::{StepState, Verdict};
use crate::experiment::Joint;
use crate::figure::delay_against::Way;
use crate::recording::chunk::{Chunks, Index, fine_columns, integers, numbers};
use crate::recording::error::RecordError;
use crate::recording::layout::{JointLayout, SegmentLayout, TrialLayout};
use crate::recording::paths::{self, at, child};
use crate::wording::{number, samples_text};

/// A segment, and its step among the accepted ones, with its place there.
pub(super) struct Placed<'l, 'a> {
    pub(super) trial: &'l TrialLayout<'a>,
    pub(super) segment: &'l SegmentLayout<'a>,
    pub(super) step: Option<(usize, &'l StepState)>,
}

impl Placed<'_, '_> {
    /// The step in words.
    fn words(&self, joint: &Joint) -> String {
        let number = self.segment.decision.number;
        match joint.trials.len() {
            1 => format!("step {number}"),
            _ => format!("{}, step {number}", self.trial.trial.label()),
        }
    }

    /// What an accepted step is called under the pointer: with the number to go there.
    pub(super) fn name(&self, joint: &Joint) -> Option<String> {
        self.step?;
        let segment = self.segment.number;
        Some(format!("{} (segment {segment})", self.words(joint)))
    }

    /// Which step is marked, or why none is.
    pub(super) fn sentence(&self, joint: &Joint) -> String {
        let (words, decision) = (self.words(joint), self.segment.decision);
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
    entity: &EntityPath,
    joint: &Joint,
    placed: &[Placed<'_, '_>],
) -> Result<(), RecordError> {
    let accepted = || {
        placed.iter().filter_map(|placed| {
            let moment = placed.trial.opening(placed.segment);
            Some((moment, placed.segment.decision, placed.step?.1))
        })
    };
    let index: Index = accepted().map(|(moment, ..)| moment).collect();
    let delta: Vec<_> = accepted().map(|(_, d, _)| d.breakpoint().map(|b| b.delay)).collect();
    let of = |value: fn(&StepState) -> Option<f64>| -> Vec<_> {
        accepted().map(|(.., step)| value(step)).collect()
    };
    let fine: Vec<_> = accepted().map(|(_, decision, _)| decision.fine).collect();
    let mut columns = vec![
        integers("delta", &delta),
        numbers("delay_s", &of(|step| Some(step.delay_s))),
        numbers("average_speed", &of(|step| Some(step.average_speed))),
        numbers("input_change", &of(|step| Some(step.input_change))),
        numbers("dwell_s", &of(|step| step.dwell_s)),
        numbers("angle", &of(|step| Some(step.angle))),
        numbers("time_s", &of(|step| Some(step.time_s))),
    ];
    columns.extend(fine_columns(&fine));
    chunks.push(entity.clone(), index, columns)?;
    for (number, signal) in joint.covariates.iter().enumerate() {
        let measured = || {
            accepted()
                .filter_map(|(moment, _, step)| Some((moment, (*step.covariates.get(number)?)?)))
        };
        let index: Index = measured().map(|(moment, _)| moment).collect();
        let values = Scalars::new(measured().map(|(_, value)| value));
        let entity = child(&at(entity, paths::COVARIATE), &signal.name);
        chunks.push(entity, index, values.columns_of_unit_batches()?)?;
    }
    Ok(())
}
