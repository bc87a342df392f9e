//! What `explain` and `improve` have found of a joint, what effects explain of its error, and what remains.

use super::{Before, ComparedJoint};
use crate::diagnosis::{ErrorFigures, sensor_noise};
use crate::effect::Spec;
use crate::experiment::Joint;
use crate::explain::{Attribution, Candidate, Contribution, Judgement, Verdict};
use crate::fit::AssessedModel;
use crate::model::Component;
use crate::study::JointEstimate;
use crate::wording::{measure, percent, times_noise};

/// A joint, the verdict on its model, and the ranking it follows from.
#[derive(Clone, Copy, Debug)]
pub struct Finding<'a> {
    /// The model that the verdict is about.
    pub compared: ComparedJoint<'a>,
    /// The verdict.
    pub verdict: Verdict,
    /// The candidates, best first.
    pub ranking: &'a [Candidate],
    /// What follows the effect on the command line that adds it.
    pub add_arguments: &'a str,
    /// The model to which effects were added, where any were.
    pub before: Option<Before<'a>>,
    /// What each effect carries that was added, or is proposed, where that was found out.
    pub attribution: Option<&'a Attribution>,
    /// The delays of its steps, where they were estimated.
    pub delays: Option<&'a JointEstimate>,
}

impl<'a> Finding<'a> {
    /// The candidate that is proposed.
    pub(super) fn proposed(&self) -> Option<&'a Candidate> {
        let mut added = self.ranking.iter().filter(|candidate| candidate.judgement.is_added());
        added.next().filter(|_| self.verdict == Verdict::MissingEffect)
    }

    /// What the effects explain that were added, or that are proposed.
    pub(super) fn consequence(&self) -> Consequence<'a> {
        let comparison = self.compared.comparison;
        let (fit, before, after) = match (self.before, self.proposed()) {
            (None, Some(best)) => {
                let before = comparison.judged().map(|error| error.rmse);
                (&best.fit.assessed, before, best.validation.or(best.training))
            }
            (before, _) => {
                let before = before.and_then(|before| before.rmse());
                (&comparison.fit.assessed, before, comparison.judged())
            }
        };
        let (joint, attribution) = (self.compared.joint, self.attribution);
        Consequence {
            joint,
            fit,
            attribution,
            before,
            after,
            sensor_noise: sensor_noise(&joint.trials),
        }
    }
}

/// The effects that a candidate added, in its order.
pub(super) fn added(candidate: &Candidate) -> impl Iterator<Item = &Component> {
    let components = candidate.fit.model.components();
    let of_id =
        |id: &&'static str| components.iter().find(|component| component.effect().spec().id == *id);
    candidate.effects.iter().filter_map(of_id)
}

pub(super) fn specs(candidate: &Candidate) -> impl Iterator<Item = &'static Spec> {
    added(candidate).map(|component| component.effect().spec())
}

/// `added: shown, …` or `refused: …`.
pub(super) fn judgement_text(judgement: &Judgement) -> String {
    format!("{}: {}", decision_id(judgement), judgement.reason())
}

/// What became of a candidate.
pub(super) fn decision_id(judgement: &Judgement) -> &'static str {
    if judgement.is_added() { "added" } else { "refused" }
}

/// A model with effects that were added, or are proposed, beside the model without them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Consequence<'a> {
    pub(crate) joint: &'a Joint,
    /// The model with the effects.
    pub(crate) fit: &'a AssessedModel,
    /// What each of them carries, where that was found out.
    pub(crate) attribution: Option<&'a Attribution>,
    /// The root-mean-square error without them, where there are any.
    pub(crate) before: Option<f64>,
    /// The error with them.
    pub(crate) after: Option<ErrorFigures>,
    /// The noise of the sensor, from the record alone.
    pub(crate) sensor_noise: Option<f64>,
}

/// `5.6 times the noise`; where that is not known, `a fit of 88 % to the output`.
pub(crate) fn in_proportion(error: ErrorFigures, noise: Option<f64>) -> String {
    match (noise, error.fit_percent / 100.0) {
        (Some(noise), _) => times_noise(error.rmse / noise),
        (None, fit) if fit > 0.0 => format!("a fit of {} to the output", percent(fit)),
        // A model that runs away, or an output that hardly moves.
        (None, _) => "no better than the mean of the output".to_owned(),
    }
}

impl Consequence<'_> {
    /// The part of the error that the effects explain, 0 to 1: `1 − (e − s)/(e₀ − s)` with the
    /// root-mean-square errors `e₀` before and `e` with them, and the noise `s`.
    pub(crate) fn explained(&self) -> Option<f64> {
        let (before, after) = (self.before?, self.after?.rmse);
        let noise = self.sensor_noise.unwrap_or(0.0).min(after);
        let share = 1.0 - (after - noise) / (before - noise).max(f64::MIN_POSITIVE);
        Some(share.clamp(0.0, 1.0))
    }

    /// How many times the noise the remaining error is.
    pub(crate) fn times_noise(&self) -> Option<f64> {
        Some(self.after?.rmse / self.sensor_noise?)
    }

    /// `0.28 deg remain, 5.6 times the noise`.
    pub(super) fn remains(&self) -> String {
        let Some(after) = self.after else { return "an error remains".to_owned() };
        let error = measure(after.rmse, self.joint.output_unit.as_deref());
        format!("{error} remain, {}", in_proportion(after, self.sensor_noise))
    }

    /// What each of several effects carries, and what could stand in its place.
    pub(super) fn sentences(&self) -> Vec<String> {
        let others = self.alternatives().chain(self.hidden());
        let sentences = self.shares().into_iter().chain(others);
        sentences.chain(self.doubtful()).chain(self.refinements()).collect()
    }

    /// What each of several effects carries.
    fn shares(&self) -> Option<String> {
        let found = &self.attribution.filter(|known| known.found.len() > 1)?.found;
        let share = |one: &Contribution| format!("{} {}", one.effect, percent(one.error_share));
        let shares: Vec<String> = found.iter().map(share).collect();
        let sum: f64 = found.iter().map(|one| one.error_share).sum();
        let overlap = if sum > 1.0 { " (shares overlap and do not add up)" } else { "" };
        Some(format!(
            "Share of the initial error beyond the noise that each effect explains (growth of the \
             error when it is left out and the rest is refitted): {}{overlap}.",
            shares.join(", ")
        ))
    }

    /// What could stand in the place of each effect.
    fn alternatives(&self) -> impl Iterator<Item = String> {
        let found = self.attribution.iter().flat_map(|known| &known.found);
        found.filter(|one| !one.alternatives.is_empty()).map(|one| {
            let others: Vec<String> = one.alternatives.iter().map(|own| own.join(" + ")).collect();
            let others = others.join(" or ");
            format!("In place of {}, {others} fits about as well.", one.effect)
        })
    }

    /// What would not show beside each effect.
    fn hidden(&self) -> impl Iterator<Item = String> {
        let found = self.attribution.iter().flat_map(|known| &known.found);
        found.filter(|one| !one.hidden.is_empty()).map(|one| {
            let (effect, hidden) = (one.effect, one.hidden.join(" or "));
            format!(
                "Beside {effect}, {hidden} could not be identified from this record: they act alike \
                 on the output."
            )
        })
    }

    /// What may stand for something else.
    fn doubtful(&self) -> Option<String> {
        let doubtful = &self.attribution?.doubtful;
        let share = |one: &Contribution| format!("{} {}", one.effect, percent(one.error_share));
        let shares: Vec<String> = doubtful.iter().map(share).collect();
        (!shares.is_empty()).then(|| {
            format!(
                "Doubtful: {}. Such an effect removes less than half of the squared error beyond the noise \
                 that the model has without it, so it may only imitate an effect outside the \
                 catalogue.",
                shares.join(", ")
            )
        })
    }

    /// What is of no consequence.
    pub(super) fn refinements(&self) -> Option<String> {
        let refinements = self.attribution.map_or(&[][..], |known| &known.refinements);
        (!refinements.is_empty()).then(|| {
            let names = refinements.join(", ");
            format!("Statistically significant, but of no practical consequence: {names}.")
        })
    }
}
