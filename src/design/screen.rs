//! A linear screen of an input: how far a rival at its known numbers stays from the truth, but
//! for what its sensitivities explain, that is what small changes of its numbers would mend.
//!
//! With the difference `d` of the two outputs and the rival's sensitivities `J`, each window
//! without its mean, and noise of variance `σ²`, the noncentrality is
//!
//! ```text
//! λ ≈ |d − J (JᵀJ)⁻¹ Jᵀ d|² / σ²
//! ```

use super::power::{Distance, Expected};
use super::predict::{TestRig, values, with_value};
use super::schedule::Schedule;
use super::suspects::Suspects;
use crate::model::JointModel;
use crate::numerics::{Basis, dot, rank};

/// What both suspects do along an input, beside one another and the model with neither.
pub(super) struct Screen {
    schedule: Schedule,
    /// Outputs of each suspect: at the numbers that are known best, and at others.
    truths: [Vec<Vec<f64>>; 2],
    suspects: [Rival; 2],
    neither: Rival,
    noise: f64,
}

/// What a model does along an input, and what each of its parameters adds.
struct Rival {
    here: Vec<f64>,
    slopes: Vec<Vec<f64>>,
}

impl Screen {
    pub(super) fn of(suspects: &Suspects, rig: &TestRig, schedule: &Schedule) -> Self {
        /// Further numbers of the truth. Chosen: each costs a simulation of every input.
        const DRAWS: usize = 5;
        let [one, other] = &suspects.models;
        let rivals = [one, other].map(|known| Rival::of(&known.model, rig, schedule));
        let truths = [0, 1].map(|truth| {
            let draws = suspects.models[truth].draws.iter().take(DRAWS);
            let drawn = draws.map(|model| rig.output(model, schedule));
            std::iter::once(rivals[truth].here.clone()).chain(drawn).collect()
        });
        Self {
            schedule: schedule.clone(),
            truths,
            suspects: rivals,
            neither: Rival::of(&suspects.base, rig, schedule),
            noise: suspects.noise,
        }
    }

    /// Includes one more output of the suspect number `truth`.
    pub(super) fn add(&mut self, truth: usize, output: Vec<f64>) {
        self.truths[truth].push(output);
    }

    /// The power for one suspect of the first `count` holds, at the numbers that are known best.
    fn best_known(&self, truth: usize, count: usize) -> f64 {
        self.expected(truth, count, 1).first().map_or(0.0, Expected::power)
    }

    /// The power of the whole input for the suspects of `targets`.
    pub(super) fn best_power(&self, targets: [bool; 2]) -> f64 {
        let all = self.schedule.holds().len();
        let truths = (0..2).filter(|truth| targets[*truth]);
        truths.map(|truth| self.best_known(truth, all)).fold(1.0, f64::min)
    }

    /// What is expected for one suspect of the first `count` holds: at the numbers that are
    /// known best, and at others, `most` in all.
    fn expected(&self, truth: usize, count: usize, most: usize) -> Vec<Expected> {
        let windows = self.schedule.windows(count);
        let truths = &self.truths[truth];
        let truths = truths.get(..most).unwrap_or(truths);
        let of = |rival: &Rival| rival.noncentralities(truths, &windows, self.noise);
        let samples = (self.schedule.first(count).samples(), 0);
        let distance = |training| Distance { training, ..Distance::default() };
        let pairs = of(&self.suspects[1 - truth]).into_iter().zip(of(&self.neither));
        let expected = pairs.map(|(rival, neither)| Expected {
            samples,
            rival: distance(rival),
            own: Distance::default(),
            neither: distance(neither),
        });
        expected.collect()
    }

    /// By how many standard deviations the suspects of `targets` are separated at least.
    pub(super) fn margin(&self, targets: [bool; 2], count: usize) -> f64 {
        let truths = (0..2).filter(|truth| targets[*truth]);
        let expected = truths.flat_map(|truth| self.expected(truth, count, usize::MAX));
        let margins = expected.map(|expected| expected.margin());
        margins.fold(f64::INFINITY, f64::min)
    }

    /// The fewest holds that may separate the suspects of `targets`; `None` where all of them do
    /// not.
    pub(super) fn fewest(&self, targets: [bool; 2], power: f64) -> Option<usize> {
        let enough = |count: usize| {
            let mut truths = (0..2).filter(|truth| targets[*truth]);
            truths.all(|truth| self.best_known(truth, count) >= power)
        };
        let all = self.schedule.holds().len();
        if targets == [false; 2] || !enough(all) {
            return None;
        }
        let (mut below, mut above) = (1, all);
        while above - below > 1 {
            let middle = usize::midpoint(below, above);
            if enough(middle) { above = middle } else { below = middle }
        }
        Some(above)
    }
}

impl Rival {
    fn of(model: &JointModel, rig: &TestRig, schedule: &Schedule) -> Self {
        let here = rig.output(model, schedule);
        let slope = |index| difference(&rig.output(&moved(model, index), schedule), &here);
        let slopes = free(model).map(slope).collect();
        Self { here, slopes }
    }

    /// The noncentralities where the outputs are `truths`, in `windows`.
    fn noncentralities(
        &self,
        truths: &[Vec<f64>],
        windows: &[(usize, usize)],
        noise: f64,
    ) -> Vec<f64> {
        let slopes: Vec<f64> =
            self.slopes.iter().flat_map(|slope| centred(slope, windows)).collect();
        let length = centred(&self.here, windows).len();
        let basis = Basis::of(&slopes, length, rank::COARSELY_DIFFERENCED);
        let noncentrality = |there: &Vec<f64>| {
            // d − J(JᵀJ)⁻¹Jᵀd, by an orthonormal basis of J; λ = |…|²/σ².
            let residual = basis.residual(&centred(&difference(there, &self.here), windows));
            dot(&residual, &residual) / (noise * noise)
        };
        truths.iter().map(noncentrality).collect()
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The parameters of a model that are fitted, in the order of its values.
fn free(model: &JointModel) -> impl Iterator<Item = usize> {
    let specs = model.components().iter().map(|component| component.effect().spec());
    let effects = specs.flat_map(|spec| spec.parameters.iter().map(|p| p.fitted));
    let fitted: Vec<bool> = [true, true].into_iter().chain(effects).collect();
    let values = model.values();
    (0..values.len()).filter(move |index| !values[*index].fixed && fitted[*index])
}

/// `model` with one parameter moved a little; a value at zero is moved, too.
fn moved(model: &JointModel, index: usize) -> JointModel {
    /// In parts of the value, or of one.
    const PART: f64 = 1e-4;
    let value = values(model)[index];
    with_value(model, index, value + PART * value.abs().max(0.01))
}

/// `values` in windows, each without its mean: a fit starts anew there.
fn centred(values: &[f64], windows: &[(usize, usize)]) -> Vec<f64> {
    let window = |(start, end): &(usize, usize)| {
        let part = &values[*start..*end];
        let mean = part.iter().sum::<f64>() / part.len().max(1) as f64;
        part.iter().map(|value| value - mean).collect::<Vec<_>>()
    };
    windows.iter().flat_map(window).collect()
}
