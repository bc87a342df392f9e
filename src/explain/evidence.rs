//! How likely a record is under each of several models.
//!
//! The noise of the measurement may have a memory. One autoregression is fitted to what the
//! best model leaves; the residuals of all models are filtered by it, and what remains is
//! held to be white. With sums of squares `R_t` of `n_t` samples that were fitted with `k`
//! parameters, and `R_v` of `n_v` samples that were not, a model is judged by
//!
//! ```text
//! n_t ln R_t + k ln n_t + n_v ln R_v
//! ```
//!
//! which is twice its negative log-likelihood with Schwarz's penalty on the part that was
//! fitted.

use crate::diagnosis::whitening::{autoregression, whitened};
use crate::diagnosis::{BEYOND_NOISE, ErrorFigures, floor_of};
use crate::fit::{Evaluation, Fit, Part, Record};
use crate::statistics::fisher_tail;

/// The noise of a record, as the best model leaves it.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    memory: Vec<f64>,
}

/// Whitened squares of one model's residuals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evidence {
    training: Squares,
    validation: Squares,
    /// Parameters that were fitted.
    parameters: usize,
}

#[derive(Clone, Copy, Debug)]
struct Squares {
    sum: f64,
    samples: usize,
}

impl Noise {
    /// The memory of what `fit` leaves, both parts together.
    ///
    /// What is far more than the noise of the measurement is a misfit, whose memory is no
    /// noise's: models are then compared as if noise had none.
    pub(super) fn of(record: &Record<'_>, fit: &Fit) -> Self {
        let mut windows = record.cut(&fit.evaluation.residuals, Part::Training);
        windows.extend(record.cut(&fit.evaluation.residuals, Part::Validation));
        let error = ErrorFigures::of(record, &fit.evaluation, Part::Training);
        let is_misfit = error
            .zip(floor_of(record, fit))
            .is_some_and(|(error, floor)| error.rmse > BEYOND_NOISE * floor);
        Self { memory: if is_misfit { Vec::new() } else { autoregression(&windows) } }
    }

    /// The evidence of a model with so many fitted parameters.
    pub(super) fn evidence(
        &self,
        record: &Record<'_>,
        evaluation: &Evaluation,
        parameters: usize,
    ) -> Evidence {
        let squares = |part| {
            let windows = whitened(&record.cut(&evaluation.residuals, part), &self.memory);
            let sum: f64 = windows.iter().flatten().map(|e| e * e).sum();
            Squares { sum, samples: windows.iter().map(Vec::len).sum() }
        };
        let (training, validation) = (squares(Part::Training), squares(Part::Validation));
        Evidence { training, validation, parameters }
    }
}

impl Evidence {
    /// The criterion: less is better.
    pub(super) fn criterion(&self) -> f64 {
        let penalty = self.parameters as f64 * (self.training.samples.max(2) as f64).ln();
        self.deviance() + penalty
    }

    /// The criterion without its penalty: twice the negative log-likelihood.
    pub(super) fn deviance(&self) -> f64 {
        self.training.deviance() + self.validation.deviance()
    }

    /// The same beside a simpler model that is no special case of it: the way from that to
    /// the nearest of its own is a direction in which noise may lie, too, and counts as a
    /// parameter.
    pub(super) fn apart(self) -> Self {
        Self { parameters: self.parameters + 1, ..self }
    }

    /// Fisher's test of this model against one with fewer parameters, on the training part.
    pub(super) fn p_value_against(&self, simpler: &Self) -> f64 {
        let added = self.parameters.saturating_sub(simpler.parameters).max(1);
        let freedom = self.training.samples.saturating_sub(self.parameters).max(1);
        let gained = (simpler.training.sum - self.training.sum).max(0.0) / added as f64;
        let left = (self.training.sum / freedom as f64).max(f64::MIN_POSITIVE);
        fisher_tail(gained / left, added, freedom).unwrap_or(1.0)
    }
}

impl Squares {
    fn deviance(self) -> f64 {
        if self.samples == 0 {
            return 0.0;
        }
        self.samples as f64 * (self.sum / self.samples as f64).max(f64::MIN_POSITIVE).ln()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evidence(sum: f64, parameters: usize) -> Evidence {
        let training = Squares { sum, samples: 1000 };
        Evidence { training, validation: Squares { sum: 400.0, samples: 400 }, parameters }
    }

    #[test]
    fn a_parameter_must_earn_its_penalty() {
        let plain = evidence(1000.0, 2);
        // One parameter gains about 1 of 1000 by chance, and must gain ln 1000 = 6.9.
        assert!(evidence(999.0, 3).criterion() > plain.criterion());
        assert!(evidence(990.0, 3).criterion() < plain.criterion());
    }

    #[test]
    fn fisher_judges_what_a_parameter_gains() {
        let plain = evidence(1000.0, 2);
        // F(1, 997) of 2.7 is exceeded with probability 0.10, of 10 with 0.0016.
        let by = |gain: f64| evidence(1000.0 - gain, 3).p_value_against(&plain);
        assert!((by(2.7) - 0.1).abs() < 0.01 && (by(10.0) - 0.0015).abs() < 0.0003);
    }

    #[test]
    fn the_way_to_a_model_that_does_not_nest_counts_as_a_parameter() {
        // One parameter turns a shift of any size: it meets the larger part of noise in two
        // directions, whose square is beyond 9.21 with probability 0.01.
        let plain = evidence(1000.0, 2);
        let found = |parameters| evidence(1000.0 - 9.21, parameters);
        let nested = found(3).p_value_against(&plain);
        let apart = found(3).apart().p_value_against(&plain);
        assert!((apart - 0.01).abs() < 0.001 && nested < 0.003);
        // Without a parameter of its own there is only the way.
        assert!((found(2).apart().p_value_against(&plain) / nested - 1.0).abs() < 1e-9);
    }

    #[test]
    fn without_a_validation_part_only_training_counts() {
        let none = Squares { sum: 0.0, samples: 0 };
        let evidence = Evidence { validation: none, ..evidence(500.0, 0) };
        assert!((evidence.criterion() - 1000.0 * 0.5_f64.ln()).abs() < 1e-9);
    }
}
