//! The delay of a model beside the delays that were measured.

use super::{DelayRange, EstimatedJoint, JointSummary};
use crate::delay::{Bounds, DeadTime, Finding, InputStep};
use crate::effect::{InputChange, Stage};
use crate::fit::{AssessedModel, Parameter, Status};
use crate::model::Component;
use crate::numerics::median;

/// Measured delays that a model's is held against, at least.
const FEWEST: usize = 3;

/// Standard errors that a fitted delay is off at most by chance.
const BY_CHANCE: f64 = 3.0;

/// Why a fitted delay is shorter than those measured: a step seems late by the lag after it, too.
fn why_shorter(of: &AssessedModel) -> String {
    let is_lag = |component: &&Component| {
        matches!(component.effect().spec().stage, Stage::Spool | Stage::Dynamics)
    };
    match of.model.components().iter().find(is_lag) {
        Some(lag) => {
            format!(
                "the measured delays include the lag that the model describes by {}",
                lag.effect().spec().id
            )
        }
        None => "it compensates for a simulated motion that is too slow after a step".to_owned(),
    }
}

/// What is to be said of the delay of a model: that it was held, or that it lies outside the
/// delays that were measured, and why a fit puts it there. Nothing of a law that was fitted.
pub(super) fn model_delay(of: &AssessedModel, measured: EstimatedJoint<'_>) -> Option<String> {
    let is_law = |component: &&Component| component.effect().spec().stage == Stage::Transport;
    let laws: Vec<&Component> = of.model.components().iter().filter(is_law).collect();
    if let Some(found) = &measured.estimate.dead_time {
        return if laws.is_empty() { over_the_record(of, found) } else { None };
    }
    let summary = JointSummary::of(measured);
    let range = summary.delay_s.filter(|_| summary.accepted >= FEWEST)?;
    if !laws.is_empty() {
        return held_law(of, &laws, measured);
    }
    let delay = of.parameters.iter().find(|parameter| parameter.name == "delay")?;
    outside(of, delay, range).or_else(|| apart(delay, measured))
}

/// Of a fitted delay among those that were measured, the kinds of steps whose typical delay is another
/// by more than both are uncertain and than a sample: what the model has after its delay, as play or
/// friction, makes a step seem early or late to who looks at the output alone.
fn apart(delay: &Parameter, measured: EstimatedJoint<'_>) -> Option<String> {
    let leeway = BY_CHANCE * delay.std_error?;
    let periods = measured.joint.trials.iter().map(|trial| trial.period().seconds());
    let leeway = leeway + periods.fold(0.0, f64::max);
    let kinds = measured.delay_table().kinds;
    let other = kinds.iter().filter_map(|kind| {
        let typical = kind.typical?;
        let (low, high) = typical.interval_s?;
        let is_other = delay.value + leeway < low || delay.value - leeway > high;
        is_other.then(|| {
            format!("{} {:.3} s (95 %: {low:.3} to {high:.3} s)", kind.transition, typical.median_s)
        })
    });
    let other: Vec<String> = other.collect();
    (!other.is_empty()).then(|| {
        format!(
            "The model has one delay, {:.3} s, which differs from those measured at the steps: \
             {}. If no lack of fit is shown, use the delay of the model.",
            delay.value,
            other.join(", ")
        )
    })
}

/// Of a law that was held: where it lies, and how near it comes to what was measured.
fn held_law(
    of: &AssessedModel,
    laws: &[&Component],
    measured: EstimatedJoint<'_>,
) -> Option<String> {
    let parameters = laws.iter().flat_map(|law| law.parameters());
    if !of.model.delay.fixed || parameters.into_iter().any(|parameter| !parameter.fixed) {
        return None;
    }
    let accepted = accepted(measured);
    let (law_s, measured_s): (Vec<f64>, Vec<f64>) =
        accepted.iter().map(|(change, delay_s)| (of.model.delay_s(change), delay_s)).unzip();
    let off_s: Vec<f64> = law_s.iter().zip(&measured_s).map(|(law, is)| (law - is).abs()).collect();
    let ends = |values: &[f64]| {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(0.0, f64::max);
        format!("{least:.3} to {most:.3} s")
    };
    Some(format!(
        "The delay of the model is not fitted: it is a function of the step, fitted to the \
         measured delays before. It is {} at the steps where {} were measured; half of these \
         differ from it by at most {:.3} s.",
        ends(&law_s),
        ends(&measured_s),
        median(&off_s)?
    ))
}

/// The accepted steps of a joint and their delays in seconds.
fn accepted(measured: EstimatedJoint<'_>) -> Vec<(InputChange, f64)> {
    let accepted = measured.decisions().filter_map(|(trial, _, decision)| {
        let period_s = trial.period().seconds();
        let InputStep { sample, before, after } = decision.input_step;
        let time_s = period_s * sample as f64;
        let change = InputChange { before, after, held_s: time_s, time_s };
        Some((change, decision.accepted_delay()? * period_s))
    });
    accepted.collect()
}

/// Of a constant delay beside the dead time of an input that moves all the time, where it lies
/// outside the interval of that.
fn over_the_record(of: &AssessedModel, found: &DeadTime) -> Option<String> {
    let (Finding::Known(Bounds { low_s, high_s, .. })
    | Finding::LagOnly(Bounds { low_s, high_s, .. })) = found.finding
    else {
        return None;
    };
    let delay = of.parameters.iter().find(|parameter| parameter.name == "delay")?;
    let interval = format!("the dead time of the record ({low_s:.3} to {high_s:.3} s)");
    beyond((of, delay), (low_s, high_s), (&interval, "too fast, or too early"))
}

/// Of a constant delay that was held, or lies outside all those that were measured.
fn outside(of: &AssessedModel, delay: &Parameter, measured: DelayRange) -> Option<String> {
    let DelayRange { min, median, max } = measured;
    let range = format!("{min:.3} to {max:.3} s, median {median:.3} s");
    if delay.status == Status::Fixed {
        let value = delay.value;
        return Some(format!(
            "The delay of the model is fixed at {value:.3} s; those measured at the steps are \
             {range}."
        ));
    }
    let all = format!("all that were measured ({range})");
    beyond((of, delay), (min, max), (&all, "too fast after a step"))
}

/// Of a delay that is below `low` or above `high` by more than chance, what it lies beyond and what
/// motion of the model it makes up for.
fn beyond(
    (of, delay): (&AssessedModel, &Parameter),
    (low, high): (f64, f64),
    (what, too_fast): (&str, &str),
) -> Option<String> {
    let (value, leeway) = (delay.value, BY_CHANCE * delay.std_error.unwrap_or(0.0));
    let (side, why) = if value + leeway < low {
        ("below", why_shorter(of))
    } else if value - leeway > high {
        ("above", format!("it compensates for a simulated motion that is {too_fast}"))
    } else {
        return None;
    };
    let how = if delay.status == Status::Fixed { "held" } else { "fitted" };
    Some(format!("The {how} delay, {value:.3} s, is {side} {what}: {why}."))
}
