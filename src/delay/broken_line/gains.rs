//! The positions of a window where a line may break: the inner product of a ramp behind each with the
//! output, and what a break there subtracts from the squared error.

use std::ops::RangeInclusive;

use super::frame::Frame;
use super::piece::Piece;
use crate::numerics::moments;

/// Ramps behind each position of a range, and what a break there takes away.
#[derive(Clone, Debug, Default)]
pub(super) struct BreakGains {
    pub(super) first: usize,
    /// The inner product of each ramp with the output; one more, behind the last.
    ramp_y: Vec<f64>,
    /// Each ramp's own residual square; 0 behind the last.
    size: Vec<f64>,
    pub(super) gain: Vec<f64>,
}

impl BreakGains {
    /// The `positions` of a window whose output, without what a line can do and pulled through the
    /// noise, is `pulled`.
    pub(super) fn of(frame: &Frame, pulled: &[f64], positions: &RangeInclusive<usize>) -> Self {
        /// Samples at a time: of these only two sums depend on those before.
        const TOGETHER: usize = 4;
        let (first, count) =
            (*positions.start(), (positions.end() + 1).saturating_sub(*positions.start()));
        let (searched, rest) = pulled.split_at((first + 1 + count).min(pulled.len()));
        let (level_sum, moment, _) = moments(rest, 0.0);
        // Behind the last position the ramp is d = k + 1: Σ (k + 1)·y.
        let ramp_sum = level_sum + moment;
        let mut ramp_y = vec![ramp_sum; count + 1];
        let searched = searched.get(first + 1..).unwrap_or_default();
        let ramps = &mut ramp_y[..count];
        let (mut ramps, values) =
            (ramps.rchunks_exact_mut(TOGETHER), searched.rchunks_exact(TOGETHER));
        let first_values = values.remainder();
        let mut sums = [ramp_sum, level_sum];
        for (ramps, values) in (&mut ramps).zip(values) {
            sums = add_up(sums, ramps, values);
        }
        add_up(sums, ramps.into_remainder(), first_values);
        let mut size = vec![0.0; count + 1];
        let mut gain = vec![0.0; count];
        let slots = size.iter_mut().zip(&mut gain).zip(&ramp_y);
        for (((size, gain), ramp_y), reach) in slots.zip(frame.reaches(first)) {
            *size = frame.ramp(reach).square;
            // (h·y)²/|h|², of residuals.
            let taken = ramp_y * ramp_y / *size;
            *gain = if *size > 0.0 { taken } else { 0.0 };
        }
        Self { first, ramp_y, size, gain }
    }

    /// Squared errors of breaks there, given that of one line, and their changes of slope.
    pub(super) fn into_errors(self, power: f64) -> (Vec<f64>, Vec<f64>) {
        let Self { ramp_y: mut changes, size, gain: mut errors, .. } = self;
        for error in &mut errors {
            *error = (power - *error).max(0.0);
        }
        changes.truncate(errors.len());
        for (change, size) in changes.iter_mut().zip(size) {
            *change = if size > 0.0 { *change / size } else { 0.0 };
        }
        (errors, changes)
    }

    /// Positions behind which a break between two samples may take away the most, from the
    /// back: its inner product with the output is linear between them, and its own square
    /// at most by a quarter of the level's below both ends.
    pub(super) fn promising(&self, frame: &Frame) -> impl Iterator<Item = usize> + use<> {
        /// More than rounding.
        const SLACK: f64 = 1.0 - 1e-9;
        /// Positions that are judged at a time; most of them have none that may.
        const BLOCK: usize = 8;
        let most = SLACK * self.gain.iter().copied().fold(0.0, larger);
        let spare = |[a, b]: [f64; 2], [size, next]: [f64; 2], reach: f64| {
            // |h − s·w|² bends by |w|²: between its ends it is s·(1 − s)·|w|² below their chord.
            let least = if size < next { size } else { next };
            larger(a * a, b * b) - most * (least - 0.25 * frame.most_level(reach))
        };
        let mut good = Vec::new();
        let [next_ramps, next_sizes] = [&self.ramp_y, &self.size].map(|values| &values[1..]);
        let ramps = self.ramp_y.chunks(BLOCK).zip(next_ramps.chunks(BLOCK));
        let sizes = self.size.chunks(BLOCK).zip(next_sizes.chunks(BLOCK));
        for (index, ((a, b), (size, next))) in ramps.zip(sizes).enumerate() {
            let from = BLOCK * index;
            let block = [a, b, size, next].map(<&[f64; BLOCK]>::try_from);
            let [Ok(a), Ok(b), Ok(size), Ok(next)] = block else {
                good.extend(from..self.gain.len());
                continue;
            };
            let reaches = frame.reaches_of::<BLOCK>(self.first + from);
            let mut spares = [0.0; BLOCK];
            let ends = a.iter().zip(b).zip(size.iter().zip(next)).zip(reaches);
            for (slot, (((a, b), (size, next)), reach)) in spares.iter_mut().zip(ends) {
                *slot = spare([*a, *b], [*size, *next], reach);
            }
            let may = |spare: &f64| *spare >= 0.0;
            if spares.iter().any(may) {
                let promising = spares.iter().enumerate().filter(|(_, spare)| may(spare));
                good.extend(promising.map(|(lane, _)| from + lane));
            }
        }
        good.into_iter().rev()
    }

    /// The piece behind the position of an index.
    pub(super) fn piece(&self, index: usize, frame: &Frame) -> Piece {
        // A ramp less the one that begins a sample later is the level between.
        let (here, next) = (self.ramp_y[index], self.ramp_y[index + 1]);
        frame.piece(self.first + index, here - next, here)
    }
}

/// Puts the inner products of ramps behind each sample with the output into `ramps`, given the
/// `values` there and the sums over all behind them; those sums with the values.
#[inline]
fn add_up([ramp_sum, level_sum]: [f64; 2], ramps: &mut [f64], values: &[f64]) -> [f64; 2] {
    let (mut level, mut ramp, mut behind) = (0.0, 0.0, 0.0);
    for (slot, y) in ramps.iter_mut().zip(values).rev() {
        level += y;
        ramp += level;
        behind += level_sum;
        // Each ramp that begins a sample earlier is larger by 1 at every sample behind.
        *slot = ramp_sum + (behind + ramp);
    }
    [ramp_sum + (behind + ramp), level_sum + level]
}

/// The larger of two numbers; unlike `f64::max` it is one instruction.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
