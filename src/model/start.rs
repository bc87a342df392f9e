//! The plain integrator that the estimated delays suggest: where a model begins.

use super::delay_law::{Start, with_law};
use super::neutral::{CodedNeutral, coded_neutral};
use super::{Component, JointModel, Value};
use crate::delay::{Decision, Method, Settings, TrialEstimate};
use crate::delay::{are_strokes, delay_scan, estimate_joint};
use crate::effect::InputOffset;
use crate::experiment::Joint;
use crate::numerics::median;

/// The delay of a joint of which nothing is known, in seconds.
const UNKNOWN_DELAY_S: f64 = 0.1;

/// Plain integrators for `joint`: one gain, and delays from short to long.
///
/// The gain is the regression of the output's slope after each accepted step on the
/// input there, `Σ u·v / Σ u²`; the delays are the quartiles of the accepted ones.
/// Without an accepted step they come from the whole record, as for an input that changes
/// all the time.
///
/// Where the joint was driven in strokes, the delay is that of the starts from rest, placed between
/// samples, by the law of size and direction of the step that they follow or as their median, and
/// fixed: each start shows its delay to some hundredths of a second, while in a fit a speed that is
/// wrong along a stroke moves the delay by tenths.
///
/// Where the input is coded, as the width of a pulse or in parts of a range, they have its
/// neutral as an offset, and `u` counts from there. A neutral at which the joint was held is known,
/// and fixed: beside a dead band, whose two ends an offset moves alike, nothing else would say it.
pub fn integrators(joint: &Joint, estimates: &[&TrialEstimate]) -> Vec<JointModel> {
    let neutral = coded_neutral(&joint.trials);
    let zero = neutral.map_or(0.0, |neutral| neutral.level);
    let (mut starts, gain) = accepted(joint, estimates, zero);
    let gain = gain.unwrap_or_else(|| overall_gain(joint, zero));
    let begun = |gain, delay: f64| {
        let model = JointModel::integrator(gain, delay.max(0.0));
        let offset =
            neutral.and_then(|neutral| Component::new(&InputOffset, vec![offset_of(neutral)]));
        offset.map_or(model.clone(), |offset| model.with(offset))
    };
    if are_strokes(&joint.trials) {
        let finer = between_samples(joint, estimates);
        if let Some(finer) = &finer {
            starts = accepted(joint, &finer.iter().collect::<Vec<_>>(), zero).0;
        }
    }
    let delays: Vec<f64> = starts.iter().map(|start| start.delay_s).collect();
    if are_strokes(&joint.trials)
        && let Some(delay) = median(&delays)
    {
        let mut model = begun(gain, delay);
        model.delay.fixed = true;
        starts.retain(Start::is_from_rest);
        return vec![with_law(model.clone(), &starts).unwrap_or(model)];
    }
    let mut delays: Vec<f64> = quartiles(delays);
    if delays.is_empty() {
        delays = scanned(joint).into_iter().chain([UNKNOWN_DELAY_S]).collect();
    }
    delays.dedup();
    delays.into_iter().map(|delay| begun(gain, delay)).collect()
}

/// The offset that takes a coded input to its neutral.
fn offset_of(neutral: CodedNeutral) -> Value {
    Value { fixed: neutral.is_held, ..Value::from(-neutral.level) }
}

/// The estimates again, with delays between samples; none where they are so, or where fewer steps
/// would be accepted.
fn between_samples(joint: &Joint, estimates: &[&TrialEstimate]) -> Option<Vec<TrialEstimate>> {
    fn delays<'e>(all: impl Iterator<Item = &'e TrialEstimate>) -> usize {
        all.flat_map(|e| &e.decisions).filter(|d| d.accepted_delay().is_some()).count()
    }
    if estimates.iter().flat_map(|estimate| &estimate.decisions).any(|d| d.fine.is_some()) {
        return None;
    }
    let settings = Settings::of(Method::HINGE);
    let finer = estimate_joint(&joint.trials, &settings);
    let finer: Vec<TrialEstimate> = finer.into_iter().flatten().collect();
    (delays(finer.iter()) >= delays(estimates.iter().copied())).then_some(finer)
}

/// The accepted steps, and the regression of the speed after them on the input from `neutral` on.
fn accepted(
    joint: &Joint,
    estimates: &[&TrialEstimate],
    neutral: f64,
) -> (Vec<Start>, Option<f64>) {
    let trials = joint.trials.iter().filter_map(|trial| {
        let estimate = estimates.iter().find(|estimate| estimate.label == trial.label())?;
        Some((trial.period().seconds(), *estimate))
    });
    let (mut starts, mut with_speed, mut squared) = (Vec::new(), 0.0, 0.0);
    for (period, estimate) in trials {
        for decision in estimate.decisions.iter().filter(|d| d.accepted_delay().is_some()) {
            let step = &decision.input_step;
            let (before, after) = (step.before - neutral, step.after - neutral);
            let start = |samples| Start { before, rise: after - before, delay_s: samples * period };
            starts.extend(decision.accepted_delay().map(start));
            let speed = slope_after(decision) / period;
            with_speed += after * speed;
            squared += after.powi(2);
        }
    }
    (starts, (squared > 0.0).then(|| with_speed / squared))
}

fn slope_after(decision: &Decision) -> f64 {
    decision.breakpoint().map_or(0.0, |best| best.candidate.after.slope)
}

/// The delay that explains the longest trial best, in seconds.
fn scanned(joint: &Joint) -> Option<f64> {
    /// Longest delay that is tried, in samples and as a part of the trial.
    const LONGEST: usize = 100;
    const PART: usize = 10;
    let trial = joint.trials.iter().max_by_key(|trial| trial.len())?;
    let longest = LONGEST.min(trial.len() / PART);
    let errors = delay_scan(trial.input(), trial.output(), longest);
    let best = errors.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?;
    Some(best.0 as f64 * trial.period().seconds())
}

/// The quartiles of `delays`.
fn quartiles(mut delays: Vec<f64>) -> Vec<f64> {
    delays.sort_by(f64::total_cmp);
    let last = delays.len().saturating_sub(1);
    let quartiles = [1, 2, 3].map(|part| delays.get(part * last / 4).copied());
    quartiles.into_iter().flatten().collect()
}

/// Speed over input from `neutral` on, from the steps of the output between samples.
fn overall_gain(joint: &Joint, neutral: f64) -> f64 {
    let (mut with_speed, mut squared) = (0.0, 0.0);
    for trial in &joint.trials {
        let speeds = trial.output().windows(2).map(|pair| match pair {
            [from, to] => (to - from) / trial.period().seconds(),
            _ => 0.0,
        });
        for (speed, input) in speeds.zip(trial.input().iter().map(|input| input - neutral)) {
            with_speed += speed * input;
            squared += input * input;
        }
    }
    let gain = with_speed / squared;
    if gain.is_finite() { gain } else { 1.0 }
}
