//! The lag of a joint as it is reported: time constants in seconds, with standard errors.

use super::model::{LagModel, MAX_PARAMETERS};
use super::response::Response;
use crate::units::SamplePeriod;

/// A number that was estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LagPart {
    /// Its value.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// The lag that all steps of a joint share, behind the dead time that each has of its own.
///
/// With neither part the joint follows at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Lag {
    period: SamplePeriod,
    model: LagModel,
    /// Covariance of the model's parameters.
    covariance: [[f64; MAX_PARAMETERS]; MAX_PARAMETERS],
    determined: bool,
}

impl Lag {
    pub(crate) fn new(
        period: SamplePeriod,
        model: LagModel,
        covariance: [[f64; MAX_PARAMETERS]; MAX_PARAMETERS],
    ) -> Self {
        Self { period, model, covariance, determined: true }
    }

    /// Of a joint whose steps do not show it.
    pub(crate) fn undetermined() -> Self {
        Self { determined: false, ..Self::none() }
    }

    /// Whether the record shows a lag that its steps share, or that there is none. Strokes from
    /// rest do not: each gathers speed in its own way.
    pub fn is_determined(&self) -> bool {
        self.determined
    }

    /// A joint that follows at once.
    pub(crate) fn none() -> Self {
        Self::new(SamplePeriod::ONE_SECOND, LagModel::NONE, [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS])
    }

    /// Number of its parameters: 0 to 3.
    pub fn order(&self) -> usize {
        self.model.order()
    }

    /// Time constant of the first-order part, seconds.
    pub fn time_constant_s(&self) -> Option<LagPart> {
        let value = self.model.time_constant()? * self.period.seconds();
        // The parameter is ln T: σ(T) = T·σ(ln T).
        Some(LagPart { value, std_error: value * self.error_of(0) })
    }

    /// Period of the second-order part without its damping, seconds.
    pub fn period_s(&self) -> Option<LagPart> {
        let (omega, _) = self.model.pair()?;
        let value = std::f64::consts::TAU / omega * self.period.seconds();
        Some(LagPart { value, std_error: value * self.error_of(self.model.pair_at()) })
    }

    /// Damping ratio of the second-order part.
    pub fn damping(&self) -> Option<LagPart> {
        let (_, value) = self.model.pair()?;
        Some(LagPart { value, std_error: value * self.error_of(self.model.pair_at() + 1) })
    }

    /// How late a steady motion is behind the dead time, seconds.
    pub fn mean_s(&self) -> LagPart {
        // The delta method: g' C g with g the slopes of the mean.
        let slope = self.model.slopes(|model| Response::of(model).mean);
        let std_error = self.variance_along(&slope).sqrt() * self.period.seconds();
        LagPart { value: Response::of(&self.model).mean * self.period.seconds(), std_error }
    }

    /// The model for samples of another period.
    pub(crate) fn model_at(&self, period: SamplePeriod) -> LagModel {
        self.model.scaled(self.period.seconds() / period.seconds())
    }

    /// Variance of what changes by `slopes` with the parameters.
    pub(crate) fn variance_along(&self, slopes: &[f64; MAX_PARAMETERS]) -> f64 {
        let rows = self.covariance.iter().zip(slopes);
        rows.map(|(row, a)| row.iter().zip(slopes).map(|(c, b)| a * c * b).sum::<f64>())
            .sum::<f64>()
            .max(0.0)
    }

    fn error_of(&self, index: usize) -> f64 {
        let row = self.covariance.get(index);
        row.and_then(|row| row.get(index)).copied().unwrap_or(f64::NAN).max(0.0).sqrt()
    }
}
