//! A model with one effect more, beside the measurement, and when it is worth a name.

use super::determined::{DISTINCT, are_determined, is_distinct};
use super::extension::{Extension, components_of};
use super::judgement::Judgement;
use super::outcome::FitOutcome;
use super::separation::Separation;
use crate::diagnosis::ErrorFigures;
use crate::fit::{AssessedModel, Status};
use crate::model::Component;

/// The p-value below which the best of a whole catalogue is significant: about 0.02 for all of
/// 19 effects together (Bonferroni).
const OF_A_CATALOGUE: f64 = 1e-3;

/// The p-value below which the best of all pairs of a catalogue is significant: 1.7e-4 for 171
/// pairs together. A pair has more freedom to follow what is no effect at all.
const OF_ALL_PAIRS: f64 = 1e-6;

/// The p-value below which an effect is needed even in a model that passes for adequate: no
/// memory of the noise accounts for it.
pub(crate) const BEYOND_DOUBT: f64 = 1e-6;

/// Percent of the error that an effect beyond doubt explains.
pub(crate) const BEYOND_DOUBT_PERCENT: f64 = 5.0;

/// Percent of the error that a single effect must explain to be worth a name.
const SINGLE_PERCENT: f64 = 2.0;

/// Percent of the error that a pair of effects must explain to be worth its names.
const PAIR_PERCENT: f64 = 10.0;

/// Twice the difference in log-likelihood below which two models are as likely: a likelihood
/// ratio of one in 150.
pub(crate) const ALIKE: f64 = 10.0;

/// A model with one effect more, or several, beside the measurement.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Ids of what was added.
    pub effects: Vec<&'static str>,
    /// The fitted model.
    pub fit: FitOutcome,
    /// The error on the part it was fitted to.
    pub training: Option<ErrorFigures>,
    /// The error on the part it was not fitted to.
    pub validation: Option<ErrorFigures>,
    /// How much of the root mean square error it explains, in percent: on the validation
    /// part, or on the training part where there is no other.
    pub error_reduction_percent: f64,
    /// How much of the root mean square error of the training part it explains, in percent.
    pub training_reduction_percent: f64,
    /// The p-value: probability of so much or more when the effect is not there, the smaller of
    /// two tests', times two (see `evidence`).
    pub p_value: f64,
    /// Share of the misfit that it explains: of the mean square error of the training part
    /// beyond the noise of the measurement; from −1 (as much worse) to 1 (all of it).
    pub share_of_misfit: f64,
    /// Twice the difference in log-likelihood to the best candidate, both parts of the
    /// record, with Schwarz's penalty: 0 for the best.
    pub behind: f64,
    /// Twice the difference in log-likelihood to the model without it, both parts of the record,
    /// with Schwarz's penalty: above 0 where this one is more likely.
    pub evidence: f64,
    /// Whether it is worth adding, and why.
    pub judgement: Judgement,
    /// Twice the negative log-likelihood, without a penalty.
    pub(super) deviance: f64,
    /// Other candidates that this record cannot distinguish from this one.
    pub indistinguishable_from: Vec<&'static str>,
    /// What would separate it from each of them, where it is significant.
    pub separated_by: Vec<Separation>,
}

impl Candidate {
    /// What was added, in one word: `dead_band`, or `dead_band + actuator_lag`.
    pub fn name(&self) -> String {
        self.effects.join(" + ")
    }

    /// The effects that were added, with their fitted parameters.
    pub(super) fn added(&self) -> impl Iterator<Item = &Component> {
        components_of(&self.fit.model, &self.effects)
    }

    /// What it is, without what is thought of it.
    pub(super) fn extension(&self) -> Extension {
        Extension { effects: self.effects.clone(), fit: self.fit.clone() }
    }

    /// Id of the effect that was added last.
    pub(super) fn newest(&self) -> &'static str {
        self.effects[self.effects.len() - 1]
    }

    /// Whether it explains so much of the error that it is worth a name, and the record determines
    /// each effect of it.
    pub(crate) fn is_significant(&self) -> bool {
        self.is_shown() && are_determined(&self.fit, &self.effects)
    }

    /// Whether it explains so much of the error that it is worth a name.
    pub(super) fn is_shown(&self) -> bool {
        match self.effects.as_slice() {
            [_] => self.p_value < OF_A_CATALOGUE && self.explains(SINGLE_PERCENT),
            _ => self.p_value < OF_ALL_PAIRS && self.explains(PAIR_PERCENT),
        }
    }

    /// Whether at least as many parameters are determined with it as in `base`: an effect that
    /// does what others do already leaves them all undetermined.
    pub(super) fn determines_as_much_as(&self, base: &AssessedModel) -> bool {
        let determined = |fit: &AssessedModel| {
            fit.parameters.iter().filter(|parameter| parameter.status == Status::Fitted).count()
        };
        determined(&self.fit) >= determined(base)
    }

    /// Whether a value of what it adds is known to be another than that at which it does nothing.
    pub(super) fn is_distinct(&self) -> bool {
        self.added().any(|effect| is_distinct(&self.fit, effect, DISTINCT))
    }

    /// Whether all that it adds are curves of the input.
    pub(super) fn is_steady(&self) -> bool {
        self.added().all(|effect| effect.effect().is_steady())
    }

    /// Whether it is needed even where the model passes for adequate.
    pub(super) fn is_beyond_doubt(&self) -> bool {
        self.p_value < BEYOND_DOUBT && self.explains(BEYOND_DOUBT_PERCENT)
    }

    /// Whether it explains `percent` of the error: on data that were not fitted, or, where it
    /// does not show there, on those that were.
    fn explains(&self, percent: f64) -> bool {
        self.error_reduction_percent > percent
            || self.judgement.generalises && self.training_reduction_percent > percent
    }

    /// The error by which it is judged: on the validation part where there is one.
    pub fn rmse(&self) -> f64 {
        self.validation.or(self.training).map_or(f64::NAN, |error| error.rmse)
    }
}
