//! What a joint behind a lag does between two reactions, and products of it over any piece.
//!
//! Level, ramp and modes, counted from the beginning of a piece, make up every column of a
//! regression: what an earlier reaction did since is another sum of the same motions. With
//! white noise the products of whole columns so follow from a few sums over each piece,
//! which depend on its length alone; only the output is gone through sample by sample.

use super::model::{LagModel, MAX_PARAMETERS};
use super::motion::{COLUMNS, LINE, Motion, inner_product};
use super::response::Response;
use crate::numerics::moments;
use crate::units::floor_to_index;

/// The motions behind a lag, as far as its modes are felt.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    pub(crate) model: LagModel,
    pub(crate) response: Response,
    /// The modes of each sample; 0 for those that the lag has not.
    modes: Vec<[f64; MAX_PARAMETERS]>,
    /// Sums over as many samples.
    sums: Vec<Sums>,
}

/// Sums of the modes, of their products with the sample's number, and with each other.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    ones: [f64; MAX_PARAMETERS],
    ramps: [f64; MAX_PARAMETERS],
    products: [[f64; MAX_PARAMETERS]; MAX_PARAMETERS],
}

/// Products over a piece: of the motions with each other, with the output, and of the output
/// with itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Products {
    motions: [Motion; COLUMNS],
    with: Motion,
    pub(crate) square: f64,
}

impl Basis {
    /// For pieces of `longest` samples at most.
    pub(crate) fn of(model: &LagModel, longest: usize) -> Self {
        let response = Response::of(model);
        let felt =
            if response.modes() > 0 { floor_to_index(response.over()).min(longest) + 1 } else { 0 };
        let mut columns = vec![0.0; response.modes() * felt];
        response.fill_modes(&mut columns, felt);
        let mut modes = vec![[0.0; MAX_PARAMETERS]; felt];
        for (index, column) in columns.chunks_exact(felt.max(1)).enumerate() {
            for (row, value) in modes.iter_mut().zip(column) {
                row[index] = *value;
            }
        }
        let mut sums = vec![Sums::default()];
        let mut now = Sums::default();
        for (k, row) in modes.iter().enumerate() {
            now.add(k as f64, row);
            sums.push(now);
        }
        Self { model: *model, response, modes, sums }
    }

    /// The products over `values`, less `offset`.
    pub(crate) fn products(&self, values: &[f64], offset: f64) -> Products {
        let (sum, moment, square) = moments(values, offset);
        let mut felt = [0.0; MAX_PARAMETERS];
        for (y, row) in values.iter().zip(&self.modes) {
            felt.iter_mut().zip(row).for_each(|(sum, mode)| *sum += (y - offset) * mode);
        }
        let [r, s, t] = felt;
        let with = [sum, moment, r, s, t];
        Products { motions: self.motions(values.len()), with, square }
    }

    /// The products of the motions over `length` samples.
    fn motions(&self, length: usize) -> [Motion; COLUMNS] {
        let n = length as f64;
        let ramp = n * (n - 1.0) / 2.0;
        let mut motions = [[0.0; COLUMNS]; COLUMNS];
        // Behind the last sample that feels the modes they add nothing more.
        let sums = self.sums[length.min(self.sums.len() - 1)];
        let [r, s, t] = sums.ones;
        let [kr, ks, kt] = sums.ramps;
        motions[0] = [n, ramp, r, s, t];
        motions[1] = [ramp, ramp * (2.0 * n - 1.0) / 3.0, kr, ks, kt];
        let modes = sums.ones.iter().zip(sums.ramps).zip(sums.products);
        for (row, ((one, ramp), [r, s, t])) in motions[LINE..].iter_mut().zip(modes) {
            *row = [*one, ramp, r, s, t];
        }
        motions
    }

    /// `motion` seen `by` samples later.
    pub(crate) fn later(&self, motion: &Motion, by: usize) -> Motion {
        let [level, ramp, modes @ ..] = *motion;
        // They have decayed behind the last sample that feels them.
        let decayed = self.modes.get(by).copied().unwrap_or([0.0; MAX_PARAMETERS]);
        let [a, b, c] = self.response.later(modes, decayed);
        [level + ramp * by as f64, ramp, a, b, c]
    }
}

impl Sums {
    fn add(&mut self, k: f64, row: &[f64; MAX_PARAMETERS]) {
        let slots = self.ones.iter_mut().zip(&mut self.ramps).zip(&mut self.products);
        for (((one, ramp), products), mode) in slots.zip(row) {
            *one += mode;
            *ramp += k * mode;
            products.iter_mut().zip(row).for_each(|(slot, other)| *slot += mode * other);
        }
    }
}

impl Products {
    /// The inner products of `motion` with each of the motions.
    pub(crate) fn along(&self, motion: &Motion) -> Motion {
        self.motions.map(|row| inner_product(&row, motion))
    }

    /// The inner product of `motion` with the output.
    pub(crate) fn with_output(&self, motion: &Motion) -> f64 {
        inner_product(&self.with, motion)
    }
}
