//! The delay of a model beside the delays that were measured.

use super::EstimatedJoint;
use super::summary::{DelayRange, JointSummary};
use crate::effect::{InputChange, Stage};
use crate::experiment::Trial;
use crate::fit::{Assessment, Status};
use crate::model::Component;
use crate::numerics::median;

/// Measured delays that a model's is held against, at least.
const FEWEST: usize = 3;

/// Standard errors that a fitted delay is off at most by chance.
const BY_CHANCE: f64 = 3.0;

/// Why a fitted delay is shorter than those measured: a step seems late by the lag behind it, too.
fn why_shorter(of: &Assessment) -> String {
    let is_lag = |component: &&Component| component.effect().spec().stage == Stage::Dynamics;
    match of.model.components().iter().find(is_lag) {
        Some(lag) => {
            format!("those include the lag that the model describes by {}", lag.effect().spec().id)
        }
        None => "with it the fit makes up for a motion that the model has too slow after a step"
            .to_owned(),
    }
}

/// What is to be said of the delay of a model: that it was held, or that it lies outside the
/// delays that were measured, and why a fit puts it there. Nothing of a law that was fitted.
pub(super) fn model_delay(of: &Assessment, measured: EstimatedJoint<'_>) -> Option<String> {
    let is_law = |component: &&Component| component.effect().spec().stage == Stage::Transport;
    let laws: Vec<&Component> = of.model.components().iter().filter(is_law).collect();
    let summary = JointSummary::of(measured);
    let range = summary.delay_s.filter(|_| summary.accepted >= FEWEST)?;
    if laws.is_empty() { constant(of, range) } else { held_law(of, &laws, measured) }
}

/// Of a law that was held: where it lies, and how near it comes to what was measured.
fn held_law(of: &Assessment, laws: &[&Component], measured: EstimatedJoint<'_>) -> Option<String> {
    let parameters = laws.iter().flat_map(|law| law.parameters());
    if !of.model.delay.fixed || parameters.into_iter().any(|parameter| !parameter.fixed) {
        return None;
    }
    let EstimatedJoint { joint, estimate } = measured;
    let (mut law_s, mut measured_s, mut off_s) = (Vec::new(), Vec::new(), Vec::new());
    for trial in estimate.estimated() {
        let known = joint.trials.iter().find(|known| known.label() == trial.label);
        let Some(period) = known.map(Trial::period) else { continue };
        for decision in &trial.decisions {
            let Some(delay) = decision.accepted_delay() else { continue };
            let (before, after) = (decision.input_step.before, decision.input_step.after);
            let time_s = period.seconds() * decision.input_step.sample as f64;
            let change = InputChange { before, after, held_s: time_s, time_s };
            let extra_s = laws.iter().map(|law| law.extra_delay_s(&change)).sum::<f64>();
            law_s.push((of.model.delay.value + extra_s).max(0.0));
            measured_s.push(delay * period.seconds());
            off_s.extend(law_s.last().zip(measured_s.last()).map(|(law, is)| (law - is).abs()));
        }
    }
    let ends = |values: &[f64]| {
        let (least, most) = values
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(a, b), value| (a.min(*value), b.max(*value)));
        format!("{least:.3} to {most:.3} s")
    };
    Some(format!(
        "The delay of the model is held at the law of the step that fits the measured ones: {} \
         where those are {}, half of them within {:.3} s of it.",
        ends(&law_s),
        ends(&measured_s),
        median(&off_s)?
    ))
}

fn constant(of: &Assessment, measured: DelayRange) -> Option<String> {
    let delay = of.parameters.iter().find(|parameter| parameter.name == "delay")?;
    let (value, leeway) = (delay.value, BY_CHANCE * delay.std_error.unwrap_or(0.0));
    let DelayRange { min, median, max } = measured;
    let range = format!("{min:.3} to {max:.3} s, median {median:.3} s");
    match delay.status {
        Status::Fixed => Some(format!(
            "The delay of the model is held at {value:.3} s; those measured at the steps are \
             {range}."
        )),
        _ if value + leeway < min => Some(format!(
            "The fitted delay, {value:.3} s, is below all that were measured ({range}): {}.",
            why_shorter(of)
        )),
        _ if value - leeway > max => Some(format!(
            "The fitted delay, {value:.3} s, is above all that were measured ({range}): with it \
             the fit makes up for a motion that the model has too fast after a step."
        )),
        _ => None,
    }
}
