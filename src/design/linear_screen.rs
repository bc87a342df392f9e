//! A linear screen of an input: how far a rival at its known numbers stays from the truth, but
//! for what its sensitivities explain, that is what small changes of its numbers would mend.
//!
//! With the difference `d` of the two outputs and the rival's sensitivities `J`, each window
//! without its mean, and noise of variance `σ²`, the noncentrality is
//!
//! ```text
//! λ ≈ |d − J (JᵀJ)⁻¹ Jᵀ d|² / σ²
//! ```

use super::predict::TestRig;
use super::schedule::Schedule;
use super::suspects::Suspects;
use crate::model::JointModel;
use crate::numerics::{Basis, dot, rank};

/// Samples of a window between steps of the input, at most: as of a fit.
const LONGEST_WINDOW: usize = 200;

/// Differences of two models along an input, for several numbers of the first that are likely,
/// and what each parameter of the second does.
pub(super) struct LinearScreen {
    here: Vec<f64>,
    differences: Vec<Vec<f64>>,
    slopes: Vec<Vec<f64>>,
}

impl LinearScreen {
    /// What suspect number `truth` does with `schedule`, seen by `rival`.
    pub(super) fn of(
        suspects: &Suspects,
        truth: usize,
        rival: &JointModel,
        (rig, schedule): (&TestRig, &Schedule),
    ) -> Option<Self> {
        /// Further numbers of the truth. Chosen: each costs a simulation of every input.
        const DRAWS: usize = 5;
        let here = rig.output(rival, schedule);
        let slopes = free(rival).map(|index| {
            let moved = rig.output(&moved(rival, index), schedule);
            moved.iter().zip(&here).map(|(a, b)| a - b).collect()
        });
        let slopes = slopes.collect();
        let truth = suspects.models.get(truth)?;
        let models = std::iter::once(&truth.model).chain(truth.draws.iter().take(DRAWS));
        let differences = models.map(|model| {
            let there = rig.output(model, schedule);
            there.iter().zip(&here).map(|(a, b)| a - b).collect()
        });
        let differences = differences.collect();
        Some(Self { here, differences, slopes })
    }

    /// Includes one more output of the truth.
    pub(super) fn add(&mut self, there: &[f64]) {
        let difference = there.iter().zip(&self.here).map(|(a, b)| a - b);
        self.differences.push(difference.collect());
    }

    /// The noncentralities of the first `count` holds: at the numbers of the truth that are
    /// known best, and at others.
    pub(super) fn noncentralities(
        &self,
        schedule: &Schedule,
        count: usize,
        noise: f64,
    ) -> Vec<f64> {
        let windows = windows(schedule, count);
        let column = |values: &Vec<f64>| centred(values, &windows);
        let slopes: Vec<f64> = self.slopes.iter().flat_map(column).collect();
        let length = column(&self.here).len();
        let basis = Basis::of(&slopes, length, rank::COARSELY_DIFFERENCED);
        // d − J(JᵀJ)⁻¹Jᵀd, by an orthonormal basis of J.
        let residual = |difference| basis.residual(&column(difference));
        let differences = self.differences.iter().map(residual);
        // λ = |…|²/σ².
        differences.map(|residual| dot(&residual, &residual) / (noise * noise)).collect()
    }
}

/// The parameters of a model that are fitted, in the order of its values.
fn free(model: &JointModel) -> impl Iterator<Item = usize> {
    let specs = model.components().iter().map(|component| component.effect().spec());
    let effects = specs.flat_map(|spec| spec.parameters.iter().map(|p| p.fitted));
    let fitted: Vec<bool> = [true, true].into_iter().chain(effects).collect();
    let values = model.values();
    (0..values.len()).filter(move |index| !values[*index].fixed && fitted[*index])
}

/// `model` with one parameter moved a little.
fn moved(model: &JointModel, index: usize) -> JointModel {
    /// In parts of the value, or of one.
    const PART: f64 = 1e-4;
    let mut values: Vec<f64> = model.values().iter().map(|value| value.value).collect();
    // A value at zero is moved, too.
    values[index] += PART * values[index].abs().max(0.01);
    model.with_values(&values)
}

/// Borders of the windows of the first `count` holds.
pub(super) fn windows(schedule: &Schedule, count: usize) -> Vec<(usize, usize)> {
    let mut windows = Vec::new();
    let mut start = 0;
    for hold in schedule.holds().iter().take(count) {
        let parts = hold.samples.div_ceil(LONGEST_WINDOW).max(1);
        let border = |part: usize| start + hold.samples * part / parts;
        windows.extend((0..parts).map(|part| (border(part), border(part + 1))));
        start += hold.samples;
    }
    windows
}

/// `values` in windows, each without its mean: a fit starts anew there.
pub(super) fn centred(values: &[f64], windows: &[(usize, usize)]) -> Vec<f64> {
    let window = |(start, end): &(usize, usize)| {
        let part = &values[*start..*end];
        let mean = part.iter().sum::<f64>() / part.len().max(1) as f64;
        part.iter().map(|value| value - mean).collect::<Vec<_>>()
    };
    windows.iter().flat_map(window).collect()
}
