//! What a line through a window can do of levels and ramps that begin within it, all whitened
//! with the window's noise.
//!
//! A line stays a line when it is whitened, and a level or a ramp changes only in the first
//! samples behind its beginning, so that sums over any of them are known in closed form.

use super::piece::Piece;
use crate::numerics::Line;
use crate::numerics::NoiseModel;

/// The line of a window, and what its levels and ramps are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    order: f64,
    /// Index of the last sample, and of the middle of the whitened ones.
    last: f64,
    middle: f64,
    /// What whitening makes of 1 and of a ramp.
    level: f64,
    shift: f64,
    onset: OnsetSums,
    /// The square of a ramp, and its inner products with a constant and a slope: cubics in the
    /// samples behind its beginning.
    ramps: [[f64; 4]; 3],
    /// One over the length of a constant, and of a slope.
    per_level: f64,
    per_slope: f64,
    /// One over what whitening makes of 1.
    per_noise_level: f64,
    /// The line's value in the middle, and its slope.
    value: f64,
    slope: f64,
}

/// A ramp without what a line can do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramp {
    /// Its residual square.
    pub(super) square: f64,
    /// Its parts along a constant, and along a slope.
    line: [f64; 2],
}

/// The lines of breaks at each sample from one on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bends {
    frame: Frame,
    first: usize,
    changes: Vec<f64>,
    /// The number that lines stand over at the first sample.
    number: f64,
}

impl Bends {
    /// Breaks at `first` and behind, with these changes of slope.
    pub(super) fn of(frame: Frame, first: usize, changes: Vec<f64>, number: f64) -> Self {
        Self { frame, first, changes, number }
    }

    /// The lines before and behind the break of an index.
    pub(crate) fn get(&self, index: usize) -> Option<(Line, Line)> {
        let change = *self.changes.get(index)?;
        let position = (self.first + index) as f64;
        let ramp = self.frame.ramp(self.frame.last - position);
        let along = ramp.line.map(|part| change * part);
        Some(self.frame.lines_of(along, position, change, self.number))
    }
}

impl Frame {
    /// For so many whitened `rows`, through which a line goes with its value in the middle and
    /// its slope.
    pub(super) fn of(noise: &NoiseModel, rows: f64, (value, slope): (f64, f64)) -> Self {
        let order = noise.order() as f64;
        // Σ (k − middle)² over consecutive k.
        let spread = rows * (rows * rows - 1.0) / 12.0;
        let (last, middle) = (rows + order - 1.0, order + (rows - 1.0) / 2.0);
        let (per_level, per_slope) = (rows.sqrt().recip(), spread.sqrt().recip());
        let (level, shift, onset) = (noise.level, noise.shift, OnsetSums::of(noise));
        Self {
            order,
            last,
            middle,
            level,
            shift,
            onset,
            ramps: onset.ramps(noise, last - middle, [per_level, per_slope]),
            per_level,
            per_slope,
            per_noise_level: level.recip(),
            value,
            slope,
        }
    }

    /// Samples behind each one from `first` on.
    pub(super) fn reaches(&self, first: usize) -> impl Iterator<Item = f64> + use<> {
        let reach = self.behind(first);
        (0_i32..).map(move |index| reach - f64::from(index))
    }

    /// Samples behind each of so many from `first` on.
    #[inline]
    pub(super) fn reaches_of<const COUNT: usize>(&self, first: usize) -> [f64; COUNT] {
        let reach = self.behind(first);
        let mut reaches = [reach; COUNT];
        for (slot, index) in reaches.iter_mut().zip(0_i32..) {
            *slot -= f64::from(index);
        }
        reaches
    }

    /// Samples behind one.
    fn behind(&self, position: usize) -> f64 {
        self.last - position as f64
    }

    /// The ramp behind the sample that has `reach` samples behind it.
    #[inline]
    pub(super) fn ramp(&self, reach: f64) -> Ramp {
        let [square, a, b] =
            self.ramps.map(|[p, q, r, s]| p + reach * (q + reach * (r + reach * s)));
        // |h|² − (h·q₀)² − (h·q₁)², with the orthonormal constant q₀ and slope q₁.
        Ramp { square: square - a * a - b * b, line: [a, b] }
    }

    /// Parts along a constant and along a slope of what begins before `reach` samples, given its
    /// sum and its moment.
    #[inline]
    fn along(&self, reach: f64, sum: f64, moment: f64) -> [f64; 2] {
        let x = self.last - reach - self.middle;
        [sum * self.per_level, (x * sum + moment) * self.per_slope]
    }

    /// The piece behind sample `j`, given the inner products of its level and its ramp with the
    /// output.
    pub(super) fn piece(&self, j: usize, level_y: f64, ramp_y: f64) -> Piece {
        let Self { order, level, shift, onset, .. } = *self;
        let reach = self.behind(j);
        let count = reach - order;
        // Σ d over d = order + 1 … reach.
        let sum = (reach * (reach + 1.0) - order * (order + 1.0)) * 0.5;
        let (with_count, with_sum) = (level * count, level * sum);
        let level_line @ [a, b] =
            self.along(reach, onset.level + with_count, onset.level_d + with_sum);
        let level_level = onset.level_level + level * with_count;
        // There w_d = level and h_d = level·d + shift.
        let level_ramp = onset.level_ramp + level * (with_sum + shift * count);
        let Ramp { square, line } = self.ramp(reach);
        Piece {
            level_y,
            ramp_y,
            level_level: level_level - a * a - b * b,
            level_ramp: level_ramp - a * line[0] - b * line[1],
            ramp_ramp: square,
            level_line,
            ramp_line: line,
        }
    }

    /// No level that begins before `reach` samples has a larger square beside the line.
    #[inline]
    pub(super) fn most_level(&self, reach: f64) -> f64 {
        // Beside a constant, a level over m of n samples has the square m (n − m)/n: at most the
        // smaller of both.
        let (behind, before) = (reach - self.order, self.last - reach + 1.0);
        let count = if behind < before { behind } else { before };
        self.onset.level_level + self.level * self.level * count
    }

    /// The lines of a break at `j + s`, over numbers that are `number` at the first sample.
    pub(super) fn lines(&self, piece: &Piece, j: f64, s: f64, number: f64) -> (Line, Line) {
        let change = piece.change(s);
        let [[ramp, ramp_slope], [level, level_slope]] = [piece.ramp_line, piece.level_line];
        // The break's column is h − s·w.
        let along = [change * (ramp - s * level), change * (ramp_slope - s * level_slope)];
        self.lines_of(along, j + s, change, number)
    }

    /// The lines of a `change` of slope at a `position`, whose inner products with a constant and
    /// with a slope are `along`.
    fn lines_of(&self, along: [f64; 2], position: f64, change: f64, number: f64) -> (Line, Line) {
        let [along_level, along_slope] = along.map(|part| part * self.per_noise_level);
        let slope = self.slope - along_slope * self.per_slope;
        let value = self.value - along_level * self.per_level;
        // Whitening makes level·(c + v·(k + shift/level)) of c + v·k.
        let at = number + self.middle + self.shift * self.per_noise_level;
        let before = Line { slope, intercept: value - slope * at };
        // Both lines meet at the break.
        let intercept = before.intercept - change * (position + number);
        (before, Line { slope: slope + change, intercept })
    }
}

/// Sums of a whitened level and ramp over the samples in which they begin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct OnsetSums {
    level: f64,
    ramp: f64,
    level_d: f64,
    ramp_d: f64,
    level_level: f64,
    level_ramp: f64,
    ramp_ramp: f64,
}

impl OnsetSums {
    /// The cubics of [`Frame::ramps`], for a last sample so far behind the `middle` one.
    ///
    /// Behind the `order` samples of its onset a whitened ramp is `level·d + shift`, `d` samples
    /// after its beginning: sums of `1`, `d` and `d²` over `d = order + 1 … reach`.
    fn ramps(
        &self,
        noise: &NoiseModel,
        last: f64,
        [per_level, per_slope]: [f64; 2],
    ) -> [[f64; 4]; 3] {
        let order = noise.order() as f64;
        let (level, shift) = (noise.level, noise.shift);
        let ones = [-order, 1.0, 0.0, 0.0];
        let numbers = [-order * (order + 1.0) / 2.0, 0.5, 0.5, 0.0];
        let before = order * (order + 1.0) * (2.0 * order + 1.0) / 6.0;
        let squares = [-before, 1.0 / 6.0, 0.5, 1.0 / 3.0];
        let cubic = |onset: f64, parts: [f64; 3]| -> [f64; 4] {
            let mut found = [onset, 0.0, 0.0, 0.0];
            for (sum, part) in [ones, numbers, squares].iter().zip(parts) {
                found.iter_mut().zip(sum).for_each(|(slot, power)| *slot += part * power);
            }
            found
        };
        let with_itself =
            cubic(self.ramp_ramp, [shift * shift, 2.0 * level * shift, level * level]);
        let with_level = cubic(self.ramp, [shift, level, 0.0]);
        let mut with_slope = cubic(self.ramp_d, [0.0, shift, level]);
        // The ramp begins `last − reach` behind the middle.
        let later = [0.0].into_iter().chain(with_level);
        for ((slot, here), before) in with_slope.iter_mut().zip(with_level).zip(later) {
            *slot += last * here - before;
        }
        [with_itself, with_level.map(|part| part * per_level), with_slope.map(|p| p * per_slope)]
    }

    fn of(noise: &NoiseModel) -> Self {
        let mut sums = Self::default();
        for ((w, h), d) in noise.onset().into_iter().zip(1_u32..) {
            let d = f64::from(d);
            sums.level += w;
            sums.ramp += h;
            sums.level_d += w * d;
            sums.ramp_d += h * d;
            sums.level_level += w * w;
            sums.level_ramp += w * h;
            sums.ramp_ramp += h * h;
        }
        sums
    }
}
