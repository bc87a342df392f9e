//! The onset of one step between those of its neighbours, for known time constants.
//!
//! For every onset what is linear is solved for; the onset itself is searched over the window and
//! then narrowed by golden sections.

use super::response::{Constants, Response, combined};
use crate::numerics::{NoiseModel, NormalEquations, Projection, dot};
use crate::units::ceil_to_index;

/// Fewest samples of a window.
pub(super) const FEWEST: usize = 8;

/// Samples to which an onset is found.
const FINE: f64 = 1e-3;

/// Positions that are tried over a window, at most.
const TRIED: usize = 80;

/// Positions over a time constant, at least.
const PER_CONSTANT: f64 = 10.0;

/// The output about a step; positions are indices of its samples.
#[derive(Clone, Debug)]
pub(super) struct StepWindow<'a> {
    /// The first value.
    origin: f64,
    /// About it, whitened.
    values: Vec<f64>,
    noise: &'a NoiseModel,
}

impl<'a> StepWindow<'a> {
    /// `None` with too few samples.
    pub(super) fn of(values: &[f64], noise: &'a NoiseModel) -> Option<Self> {
        let origin = *values.first().filter(|_| values.len() >= FEWEST + noise.order())?;
        let mut values: Vec<f64> = values.iter().map(|y| y - origin).collect();
        noise.whiten(&mut values);
        Some(Self { origin, values, noise })
    }

    pub(super) fn len(&self) -> usize {
        self.values.len()
    }

    /// Samples that count: those with a past that the noise remembers.
    pub(super) fn rows(&self) -> f64 {
        (self.len() - self.noise.order()) as f64
    }

    /// Degrees of freedom of the residual.
    pub(super) fn freedom(&self, constants: &Constants) -> f64 {
        (self.rows() - constants.columns() as f64 - 1.0).max(1.0)
    }

    fn columns(&self, constants: &Constants, onset: f64) -> Vec<f64> {
        let mut columns = constants.responses(onset, self.len());
        columns.chunks_exact_mut(self.len()).for_each(|column| self.noise.whiten(column));
        columns
    }

    /// The squared error with an onset.
    pub(super) fn sse(&self, constants: &Constants, onset: f64) -> f64 {
        let mut columns = self.columns(constants, onset);
        columns.extend(&self.values);
        let mut equations = NormalEquations::of(&columns, self.len(), &[]);
        (0..constants.columns()).for_each(|column| equations.eliminate(column));
        equations.error()
    }

    /// The squared error without one.
    pub(super) fn sse_without(&self, constants: &Constants) -> f64 {
        self.sse(constants, self.len() as f64)
    }

    /// The residual with an onset.
    pub(super) fn residual(&self, constants: &Constants, onset: f64) -> Vec<f64> {
        Projection::of(&self.columns(constants, onset), &self.values).into_residuals()
    }

    /// The regression on the columns and on how they change with the onset, for the noise: with
    /// values that were not whitened.
    pub(super) fn projection(&self, constants: &Constants, onset: f64) -> Projection {
        /// Samples to each side.
        const STEP: f64 = 0.1;
        let mut columns = self.columns(constants, onset);
        let parts = self.parts(constants, onset);
        let moved = |by: f64| combined(&self.columns(constants, onset + by), self.len(), &parts);
        let [before, behind] = [-STEP, STEP].map(moved);
        columns.extend(before.iter().zip(behind).map(|(a, b)| b - a));
        Projection::of(&columns, &self.values)
    }

    /// The linear parameters with an onset.
    fn parts(&self, constants: &Constants, onset: f64) -> Vec<f64> {
        let count = constants.columns();
        let mut all = self.columns(constants, onset);
        all.extend(&self.values);
        let mut equations = NormalEquations::of(&all, self.len(), &[]);
        (0..count).for_each(|column| equations.eliminate(column));
        equations.coefficients(count, &[])
    }

    /// The output with an onset, without noise; `explained` is what it removes of the error.
    pub(super) fn response(&self, constants: &Constants, onset: f64, explained: f64) -> Response {
        Response {
            constants: *constants,
            parts: self.parts(constants, onset),
            origin: self.origin,
            onset,
            samples: self.len(),
            explained,
        }
    }

    /// The best onset from `low` to `high`, and its squared error; none where there is no room.
    pub(super) fn best(&self, constants: &Constants, low: f64, high: f64) -> Option<(f64, f64)> {
        /// The part of a golden section: (√5 − 1)/2.
        const GOLDEN: f64 = 0.618_033_988_749_895;
        if low.is_nan() || high.is_nan() || low > high {
            return None;
        }
        let apart = (constants.behind.min(constants.before) / PER_CONSTANT).max(1.0);
        let count = ceil_to_index((high - low) / apart).clamp(2, TRIED);
        let step = (high - low) / count as f64;
        let tried = (0..=count).map(|n| low + step * n as f64);
        let at = |onset: f64| (onset, self.sse(constants, onset));
        let found = tried.map(at).min_by(|a, b| a.1.total_cmp(&b.1))?;
        let (mut low, mut high) = ((found.0 - step).max(low), (found.0 + step).min(high));
        let mut inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)].map(at);
        while high - low > FINE {
            if inner[0].1 <= inner[1].1 {
                high = inner[1].0;
                // One of the two inner points stays, since GOLDEN² = 1 − GOLDEN.
                inner = [at(high - GOLDEN * (high - low)), inner[0]];
            } else {
                low = inner[0].0;
                inner = [inner[1], at(low + GOLDEN * (high - low))];
            }
        }
        inner.into_iter().chain([found]).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// How the residual changes with the onset, per sample.
    pub(super) fn onset_slope(&self, constants: &Constants, onset: f64) -> Vec<f64> {
        /// Samples to each side.
        const STEP: f64 = 0.05;
        let [before, behind] = [-STEP, STEP].map(|by| self.residual(constants, onset + by));
        before.iter().zip(behind).map(|(a, b)| (b - a) / (2.0 * STEP)).collect()
    }

    /// How far the onset may move, about as far as `guess`, until the squared error has grown
    /// from `sse` by `growth`.
    pub(super) fn reach(
        &self,
        constants: &Constants,
        (onset, sse): (f64, f64),
        guess: f64,
        growth: f64,
    ) -> f64 {
        /// Corrections of the guess, and by what part each at most.
        const CORRECTIONS: usize = 3;
        const MOST: f64 = 3.0;
        let last = self.len() as f64;
        let mut reach = guess;
        for _ in 0..CORRECTIONS {
            let there = (onset + reach).clamp(0.0, last);
            let grown = self.sse(constants, there) - sse;
            // The error grows with the square of the distance.
            let ratio = (growth / grown.max(f64::MIN_POSITIVE)).sqrt();
            reach *= ratio.clamp(MOST.recip(), MOST);
        }
        reach.abs()
    }

    /// Standard error of an onset, samples, for time constants that are known.
    pub(super) fn standard_error(&self, constants: &Constants, (onset, sse): (f64, f64)) -> f64 {
        let slope = self.onset_slope(constants, onset);
        (sse / self.freedom(constants) / dot(&slope, &slope)).sqrt()
    }
}
