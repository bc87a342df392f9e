//! A model with one effect more, fitted.

use super::separate::Separation;
use crate::diagnosis::ErrorFigures;
use crate::fit::Fit;

/// Probability below which the best of a whole catalogue is no chance.
const OF_A_CATALOGUE: f64 = 1e-3;

/// The same of all pairs of a catalogue.
const OF_ALL_PAIRS: f64 = 1e-6;

/// A model with one effect more, or several, beside the measurement.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Ids of what was added.
    pub effects: Vec<&'static str>,
    /// The fitted model.
    pub fit: Fit,
    /// The error on the part it was fitted to.
    pub training: Option<ErrorFigures>,
    /// The error on the part it was not fitted to.
    pub validation: Option<ErrorFigures>,
    /// How much of the root mean square error it takes away, in percent: on the validation
    /// part, or on the training part where there is no other.
    pub error_reduction_percent: f64,
    /// The same on the training part.
    pub training_reduction_percent: f64,
    /// Probability of so much or more when the effect is not there: the smaller of two tests',
    /// times two (see `evidence`).
    pub p_value: f64,
    /// Share of the misfit that it takes away: of the mean square error of the training part
    /// beyond the noise of the measurement.
    pub share_of_misfit: f64,
    /// Twice the difference in log-likelihood to the best candidate, both parts of the
    /// record, with Schwarz's penalty: 0 for the best.
    pub behind: f64,
    /// Twice the negative log-likelihood, without a penalty.
    pub(super) deviance: f64,
    /// Other candidates that this record cannot tell from this one.
    pub indistinguishable_from: Vec<&'static str>,
    /// What would tell it from each of them, where it is significant.
    pub separated_by: Vec<Separation>,
    /// Standard deviation of the measurement noise with its delay, output units.
    pub noise_floor: Option<f64>,
}

/// Probability that no memory of the noise accounts for.
pub(crate) const BEYOND_DOUBT: f64 = 1e-6;

/// Percent of the error that an effect beyond doubt takes away.
pub(crate) const BEYOND_DOUBT_PERCENT: f64 = 5.0;

impl Candidate {
    /// What was added, in one word: `dead_band`, or `dead_band + actuator_lag`.
    pub fn name(&self) -> String {
        self.effects.join(" + ")
    }

    /// Whether it takes away so much of the error that it is worth a name.
    pub(super) fn is_significant(&self) -> bool {
        match self.effects.as_slice() {
            [_] => self.p_value < OF_A_CATALOGUE && self.takes_away(2.0),
            _ => self.p_value < OF_ALL_PAIRS && self.takes_away(10.0),
        }
    }

    /// Whether it is needed even where the model passes for adequate.
    pub(super) fn is_beyond_doubt(&self) -> bool {
        self.p_value < BEYOND_DOUBT && self.takes_away(BEYOND_DOUBT_PERCENT)
    }

    /// Whether it takes `percent` off the error: on data that were not fitted, or, where it
    /// does not show there, on those that were.
    fn takes_away(&self, percent: f64) -> bool {
        /// An effect that does not act on the validation part changes its error so little.
        const NOTHING_PERCENT: f64 = 1.0;
        self.error_reduction_percent > percent
            || self.error_reduction_percent > -NOTHING_PERCENT
                && self.training_reduction_percent > percent
    }

    /// The error by which it is judged: on the validation part where there is one.
    pub fn rmse(&self) -> f64 {
        self.validation.or(self.training).map_or(f64::NAN, |error| error.rmse)
    }
}
