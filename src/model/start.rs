//! The plain integrator that the estimated delays suggest: where a model begins.

use super::JointModel;
use super::delay_law::{Start, with_law};
use crate::delay::{Decision, TrialEstimate, are_strokes, delay_scan};
use crate::experiment::Joint;
use crate::numerics::median;

/// The delay of a joint of which nothing is known, in seconds.
const UNKNOWN_DELAY_S: f64 = 0.1;

/// Plain integrators for `joint`: one gain, and delays from short to long.
///
/// The gain is the regression of the output's slope behind each accepted step on the
/// input there, `Σ u·v / Σ u²`; the delays are the quartiles of the accepted ones.
/// Without an accepted step they come from the whole record, as for an input that changes
/// all the time.
///
/// Where the joint was driven in strokes, the delay is that of the accepted ones, by the law of
/// size and direction of the step that they follow or as their median, and fixed: each start from
/// rest shows its delay to some hundredths of a second, while in a fit a speed that is wrong along a
/// stroke moves the delay by tenths.
pub fn integrators(joint: &Joint, estimates: &[&TrialEstimate]) -> Vec<JointModel> {
    let (mut starts, gain) = accepted(joint, estimates);
    let gain = gain.unwrap_or_else(|| overall_gain(joint));
    let delays: Vec<f64> = starts.iter().map(|start| start.delay_s).collect();
    if are_strokes(&joint.trials)
        && let Some(delay) = median(&delays)
    {
        let mut model = JointModel::integrator(gain, delay.max(0.0));
        model.delay.fixed = true;
        starts.retain(Start::is_from_rest);
        return vec![with_law(model.clone(), &starts).unwrap_or(model)];
    }
    let mut delays: Vec<f64> = quartiles(delays);
    if delays.is_empty() {
        delays = scanned(joint).into_iter().chain([UNKNOWN_DELAY_S]).collect();
    }
    delays.dedup();
    delays.into_iter().map(|delay| JointModel::integrator(gain, delay.max(0.0))).collect()
}

/// The accepted steps, and the regression of the speed behind them on the input.
fn accepted(joint: &Joint, estimates: &[&TrialEstimate]) -> (Vec<Start>, Option<f64>) {
    let trials = joint.trials.iter().filter_map(|trial| {
        let estimate = estimates.iter().find(|estimate| estimate.label == trial.label())?;
        Some((trial.period().seconds(), *estimate))
    });
    let (mut starts, mut with_speed, mut squared) = (Vec::new(), 0.0, 0.0);
    for (period, estimate) in trials {
        for decision in estimate.decisions.iter().filter(|d| d.accepted_delay().is_some()) {
            let step = &decision.input_step;
            let (before, rise) = (step.before, step.after - step.before);
            let start = |samples| Start { before, rise, delay_s: samples * period };
            starts.extend(decision.accepted_delay().map(start));
            let speed = slope_after(decision) / period;
            with_speed += decision.input_step.after * speed;
            squared += decision.input_step.after.powi(2);
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

/// Speed over input, from the steps of the output between samples.
fn overall_gain(joint: &Joint) -> f64 {
    let (mut with_speed, mut squared) = (0.0, 0.0);
    for trial in &joint.trials {
        let speeds = trial.output().windows(2).map(|pair| match pair {
            [from, to] => (to - from) / trial.period().seconds(),
            _ => 0.0,
        });
        for (speed, input) in speeds.zip(trial.input()) {
            with_speed += speed * input;
            squared += input * input;
        }
    }
    let gain = with_speed / squared;
    if gain.is_finite() { gain } else { 1.0 }
}
