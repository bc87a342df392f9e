//! The continuous broken line with its break between samples, and its interval.
//!
//! ```text
//! y_k = A + v·k + c·max(k − τ, 0) + e_k
//! ```
//!
//! For τ between samples j and j+1, with `w` a level and `h` a ramp that begin behind j,
//! the break's column is `h − s·w`, `s = τ − j`: the squared error is a quotient of two
//! quadratics in `s`, whose minimum is known in closed form. All j together cost one pass
//! from the back. Coloured noise is whitened first; a line stays a line then, and only the
//! first samples behind the break change.
//!
//! The interval holds every τ whose squared error is within `t²·s²` of the least one
//! (profile likelihood, with the segment's own `s²`). The chance of so good a break in
//! noise alone is that of a random direction coming so near to a curve on a sphere, whose
//! length is `√3/2 · ln(s/(1−s))` between the ends of the search (`s` the break's place as
//! a part of the segment).
//!
//! # References
//! D. J. Hudson, "Fitting segmented curves whose join points have to be estimated", JASA 61
//! (1966). H. Hotelling, "Tubes and spheres in n-spaces", Am. J. Math. 61 (1939).
//! M. Knowles and D. Siegmund, "On Hotelling's approach to testing for a nonlinear parameter
//! in regression", Int. Stat. Rev. 57 (1989).

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use super::line::Line;
use super::noise::Noise;
use crate::statistics::{fisher_tail, student_quantile};

/// Fewest samples beside those that the noise remembers.
pub(super) const FEWEST: usize = 8;

/// Parameters of a broken line.
pub(super) const PARAMETERS: usize = 4;

/// The best broken line through a window; places are indices of the window.
#[derive(Clone, Debug, PartialEq)]
pub struct BrokenLine {
    /// Where it breaks.
    pub place: f64,
    /// The first place that is as good as the data can tell.
    pub low: f64,
    /// The last of them.
    pub high: f64,
    /// The chance of so good a break in noise alone.
    pub p_value: f64,
    /// Squared error, of whitened residuals where the noise is not white.
    pub sse: f64,
    /// The line before the break, over the indices.
    pub before: Line,
    /// The line behind it.
    pub after: Line,
}

/// The best broken line through equally spaced `values` with white noise; its interval
/// holds the true break as often as `confidence` says. `None` for fewer than eight values.
///
/// # Examples
/// ```
/// use tauscope::delay::broken_line;
///
/// let values: Vec<f64> = (0..80).map(|k| 0.2 * (f64::from(k) - 33.3).max(0.0)).collect();
/// let found = broken_line(&values, 0.95).unwrap();
/// assert!((found.place - 33.3).abs() < 1e-9);
/// assert!((found.after.slope - 0.2).abs() < 1e-9);
/// ```
pub fn broken_line(values: &[f64], confidence: f64) -> Option<BrokenLine> {
    let noise = Noise::white();
    let window = Window::of(values, &noise)?;
    Some(window.fit(window.places(), confidence)?.0)
}

impl BrokenLine {
    /// About the standard error of the place in the middle of so many samples: that of where
    /// two lines meet that are fitted apart.
    pub(super) fn place_error(&self, samples: usize) -> f64 {
        4.0 * self.sse.sqrt() / samples as f64 / (self.after.slope - self.before.slope).abs()
    }

    /// What it leaves of the window's output.
    pub(super) fn residuals(&self, values: &[f64]) -> Vec<f64> {
        let fitted = |k: f64| if k < self.place { self.before.at(k) } else { self.after.at(k) };
        values.iter().enumerate().map(|(k, y)| y - fitted(k as f64)).collect()
    }
}

/// The error of broken lines with the break at each sample of a range.
#[derive(Clone, Debug, Default)]
pub(super) struct Evidence {
    pub(super) first: usize,
    pub(super) sse: Vec<f64>,
    pub(super) before: Vec<Line>,
    pub(super) after: Vec<Line>,
}

/// A window's output, whitened, and what one line leaves of it.
#[derive(Clone, Debug)]
pub(super) struct Window<'a> {
    noise: &'a Noise,
    onset: Onset,
    /// What one line leaves, whitened once more backwards: sums of it behind a sample are what
    /// a whitened level has in common with what is left.
    pulled: Vec<f64>,
    /// The squared error of one line.
    power: f64,
    rows: f64,
    middle: f64,
    /// One over the length of a constant, and of a slope.
    per_level: f64,
    per_slope: f64,
    /// One over what whitening makes of 1.
    per_noise_level: f64,
    /// The line's value in the middle, and its slope.
    value: f64,
    slope: f64,
}

/// Level and ramp behind a sample, without what a line can do.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Piece {
    pub(super) level_y: f64,
    pub(super) ramp_y: f64,
    pub(super) level_level: f64,
    pub(super) level_ramp: f64,
    pub(super) ramp_ramp: f64,
    /// Parts of level and ramp along a constant, and along a slope.
    pub(super) level_line: [f64; 2],
    pub(super) ramp_line: [f64; 2],
}

impl Piece {
    /// How much of the squared error a break at `s` takes away.
    #[inline]
    fn gain(&self, s: f64) -> f64 {
        let with = self.ramp_y - s * self.level_y;
        let size = self.size(s);
        if size > 0.0 { with * with / size } else { 0.0 }
    }

    /// The change of slope at a break at `s`.
    #[inline]
    fn change(&self, s: f64) -> f64 {
        let size = self.size(s);
        if size > 0.0 { (self.ramp_y - s * self.level_y) / size } else { 0.0 }
    }

    #[inline]
    fn size(&self, s: f64) -> f64 {
        self.ramp_ramp - 2.0 * s * self.level_ramp + s * s * self.level_level
    }

    /// The best break within the piece, 0 to 1, and what it takes away.
    #[inline]
    pub(super) fn best(&self) -> (f64, f64) {
        let below = self.level_y * self.level_ramp - self.ramp_y * self.level_level;
        let above = self.level_y * self.ramp_ramp - self.ramp_y * self.level_ramp;
        // Most pieces have nothing inside: they cost no division.
        let within = above * below >= 0.0 && above.abs() <= below.abs() && below != 0.0;
        let inside = if within { above / below } else { 0.0 };
        (inside, self.gain(inside))
    }

    /// Where the gain crosses `limit` between 0 and 1: the first time, and the last.
    fn crossings(&self, limit: f64) -> Option<(f64, f64)> {
        let a = self.level_y * self.level_y - limit * self.level_level;
        let b = self.ramp_y * self.level_y - limit * self.level_ramp;
        let c = self.ramp_y * self.ramp_y - limit * self.ramp_ramp;
        let root = (b * b - a * c).max(0.0).sqrt();
        let roots = [(b - root) / a, (b + root) / a].into_iter();
        let mut inside: Vec<f64> = roots.filter(|s| (0.0..=1.0).contains(s)).collect();
        inside.sort_by(f64::total_cmp);
        inside.first().copied().zip(inside.last().copied())
    }
}

impl<'a> Window<'a> {
    /// `None` with too few samples for two lines.
    pub(super) fn of(values: &[f64], noise: &'a Noise) -> Option<Self> {
        let order = noise.order();
        let rows = values.len().checked_sub(order).filter(|rows| *rows >= FEWEST)?;
        let offset = *values.first()?;
        let mut left: Vec<f64> = values.iter().map(|y| y - offset).collect();
        noise.whiten(&mut left);
        let rows = rows as f64;
        let middle = order as f64 + (rows - 1.0) / 2.0;
        let spread = rows * (rows * rows - 1.0) / 12.0;
        let (mut sum, mut moment) = (0.0, 0.0);
        let mut x = order as f64 - middle;
        for y in left.iter().skip(order) {
            sum += y;
            moment += x * y;
            x += 1.0;
        }
        let (mean, slope) = (sum / rows, moment / spread);
        let (mut power, mut fitted) = (0.0, mean + slope * (order as f64 - middle));
        for y in left.iter_mut().skip(order) {
            *y -= fitted;
            power += *y * *y;
            fitted += slope;
        }
        let (value, slope) = (offset + mean / noise.level, slope / noise.level);
        noise.pull(&mut left);
        let (onset, pulled) = (Onset::of(noise), left);
        let (per_level, per_slope) = (rows.sqrt().recip(), spread.sqrt().recip());
        let per_noise_level = noise.level.recip();
        Some(Self {
            noise,
            onset,
            pulled,
            power,
            rows,
            middle,
            per_level,
            per_slope,
            per_noise_level,
            value,
            slope,
        })
    }

    /// Places at which a break leaves enough samples on both sides.
    pub(super) fn places(&self) -> RangeInclusive<usize> {
        let order = self.noise.order();
        order.max(1)..=self.pulled.len().saturating_sub(3 + order)
    }

    /// The piece behind sample `j`, given what its level and its ramp have in common with the
    /// output.
    #[inline]
    fn piece(&self, j: usize, level_y: f64, ramp_y: f64) -> Piece {
        let order = self.noise.order() as f64;
        let (level, shift) = (self.noise.level, self.noise.shift);
        let reach = (self.pulled.len() - 1 - j) as f64;
        let count = reach - order;
        let sum = (reach * (reach + 1.0) - order * (order + 1.0)) * 0.5;
        let cubes = |d: f64| d * (d + 1.0) * (2.0 * d + 1.0) * (1.0 / 6.0);
        let squares = cubes(reach) - cubes(order);
        let (with_count, with_sum) = (level * count, level * sum);
        let onset = &self.onset;
        let levels = onset.level + with_count;
        let ramps = onset.ramp + with_sum + shift * count;
        let level_d = onset.level_d + with_sum;
        let ramp_d = onset.ramp_d + level * squares + shift * sum;
        let level_level = onset.level_level + level * with_count;
        let level_ramp = onset.level_ramp + level * (with_sum + shift * count);
        let ramp_ramp =
            onset.ramp_ramp + level * (level * squares + 2.0 * shift * sum) + shift * shift * count;
        let x = j as f64 - self.middle;
        let along =
            |sum: f64, moment: f64| [sum * self.per_level, (x * sum + moment) * self.per_slope];
        let (level_line, ramp_line) = (along(levels, level_d), along(ramps, ramp_d));
        let less = |product: f64, a: [f64; 2], b: [f64; 2]| product - a[0] * b[0] - a[1] * b[1];
        Piece {
            level_y,
            ramp_y,
            level_level: less(level_level, level_line, level_line),
            level_ramp: less(level_ramp, level_line, ramp_line),
            ramp_ramp: less(ramp_ramp, ramp_line, ramp_line),
            level_line,
            ramp_line,
        }
    }

    /// Goes through the pieces of `places` from the back.
    #[inline]
    fn for_each_piece(&self, places: RangeInclusive<usize>, mut visit: impl FnMut(usize, Piece)) {
        let (mut level_y, mut ramp_y) = (0.0, 0.0);
        let mut add = |y: &f64| {
            level_y += y;
            ramp_y += level_y;
            (level_y, ramp_y)
        };
        let (first, behind) = (places.start() + 1, places.end() + 2);
        let (searched, rest) = self.pulled.split_at(behind.min(self.pulled.len()));
        rest.iter().rev().for_each(|y| {
            add(y);
        });
        let searched = searched.get(first..).unwrap_or_default();
        for (index, y) in searched.iter().enumerate().rev() {
            let (level_y, ramp_y) = add(y);
            let j = places.start() + index;
            visit(j, self.piece(j, level_y, ramp_y));
        }
    }

    /// The best broken line with its break in `places`.
    pub(super) fn best(&self, places: RangeInclusive<usize>) -> Option<BrokenLine> {
        self.search(places, |_, _| ())
    }

    /// The best broken line with its break in `places`, with an interval that holds the
    /// true break as often as `confidence` says; and the error all over the `places`.
    pub(super) fn fit(
        &self,
        places: RangeInclusive<usize>,
        confidence: f64,
    ) -> Option<(BrokenLine, Evidence)> {
        let first = *places.start();
        let count = (*places.end() + 1).checked_sub(first)?;
        let empty = vec![Line::default(); count];
        let mut evidence =
            Evidence { first, sse: vec![0.0; count], before: empty.clone(), after: empty };
        let Evidence { sse, before, after, .. } = &mut evidence;
        let mut slots = sse.iter_mut().zip(before.iter_mut().zip(after)).rev();
        let mut line = self.search(places, |j, piece| {
            if let Some((sse, (before, after))) = slots.next() {
                let change = piece.change(0.0);
                *sse = (self.power - change * piece.ramp_y).max(0.0);
                (*before, *after) = self.lines_of(piece, j as f64, 0.0, change);
            }
        })?;
        let freedom = (self.rows - PARAMETERS as f64).max(1.0);
        let t = student_quantile(f64::midpoint(1.0, confidence), freedom);
        let limit = self.power - line.sse * (1.0 + t * t / freedom);
        (line.low, line.high) = self.interval(&evidence, limit, line.place);
        Some((line, evidence))
    }

    /// Goes through the `places` from the back for the best break, which is its own
    /// interval.
    fn search(
        &self,
        places: RangeInclusive<usize>,
        mut visit: impl FnMut(usize, &Piece),
    ) -> Option<BrokenLine> {
        let (first, last) = (*places.start(), *places.end());
        if first > last {
            return None;
        }
        let mut best = (f64::NEG_INFINITY, 0, 0.0, Piece::default());
        self.for_each_piece(places, |j, piece| {
            let (s, gain) = piece.best();
            if gain >= best.0 {
                best = (gain, j, s, piece);
            }
            visit(j, &piece);
        });
        let (gain, j, s, piece) = best;
        let place = j as f64 + s;
        let ends = (first as f64 + 0.5, last as f64 + 1.0);
        let samples = self.pulled.len() as f64;
        let p_value = chance(gain / self.power, self.rows - 2.0, samples, ends);
        let (before, after) = self.lines(&piece, j as f64, s);
        let sse = (self.power - gain).max(0.0);
        Some(BrokenLine { place, low: place, high: place, p_value, sse, before, after })
    }

    /// The lines of a break at `j + s`, over the indices of the window.
    fn lines(&self, piece: &Piece, j: f64, s: f64) -> (Line, Line) {
        self.lines_of(piece, j, s, piece.change(s))
    }

    /// The same given the change of slope.
    #[inline]
    fn lines_of(&self, piece: &Piece, j: f64, s: f64, change: f64) -> (Line, Line) {
        let part = |index: usize| match (piece.ramp_line.get(index), piece.level_line.get(index)) {
            (Some(ramp), Some(level)) => change * (ramp - s * level) * self.per_noise_level,
            _ => 0.0,
        };
        let slope = self.slope - part(1) * self.per_slope;
        let value = self.value - part(0) * self.per_level;
        let at = self.middle + self.noise.shift * self.per_noise_level;
        let before = Line { slope, intercept: value - slope * at };
        let after = Line { slope: slope + change, intercept: before.intercept - change * (j + s) };
        (before, after)
    }

    /// The outermost places whose gain is `limit`.
    fn interval(&self, evidence: &Evidence, limit: f64, place: f64) -> (f64, f64) {
        let most = self.power - limit;
        let good = |sse: &f64| *sse <= most;
        let (first, count) = (evidence.first, evidence.sse.len());
        let cross = |j: usize| {
            let mut found = None;
            self.for_each_piece(j..=j, |_, piece| found = piece.crossings(limit));
            found.map(|(first, last)| (j as f64 + first, j as f64 + last))
        };
        let piece_of_best = if place >= 0.0 { floor(place) } else { first };
        let lowest = evidence.sse.iter().position(good).map_or(piece_of_best + 1, |i| first + i);
        let low = match lowest.min(piece_of_best + 1) {
            j if j > first => cross(j - 1).map_or(j as f64 - 1.0, |(first, _)| first),
            _ => first as f64,
        };
        let highest = evidence.sse.iter().rposition(good).map_or(piece_of_best, |i| first + i);
        let highest = highest.max(piece_of_best);
        let end = (first + count) as f64;
        let high = if highest + 1 >= first + count && limit <= 0.0 {
            end
        } else {
            cross(highest).map_or(highest as f64 + 1.0, |(_, last)| last)
        };
        (low.min(place), high.max(place))
    }
}

/// The chance that noise alone gains the `share` of its power with a break between `low`
/// and `high` of `samples`, where there are that many `dimensions` to gain in.
pub(super) fn chance(share: f64, dimensions: f64, samples: f64, (low, high): (f64, f64)) -> f64 {
    if !share.is_finite() || dimensions < 3.0 {
        return 1.0;
    }
    let share = share.clamp(0.0, 1.0);
    // The curve's ends are a sample from those of the window at least.
    let odds = |place: f64| (place.max(1.0) / (samples - place).max(1.0)).ln();
    let length = 0.75_f64.sqrt() * (odds(high) - odds(low)).max(0.0);
    let tube = length / PI * (1.0 - share).powf((dimensions - 2.0) / 2.0);
    let freedom = dimensions - 1.0;
    let statistic = freedom * share / (1.0 - share).max(f64::MIN_POSITIVE);
    let ends = fisher_tail(statistic, 1, floor(freedom)).unwrap_or(1.0);
    (tube + ends).min(1.0)
}

/// Whole samples in `value`, which is not negative.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is not negative")]
pub(super) fn floor(value: f64) -> usize {
    value.max(0.0) as usize
}

/// Sums of a whitened level and ramp over the samples in which they begin.
#[derive(Clone, Copy, Debug, Default)]
struct Onset {
    level: f64,
    ramp: f64,
    level_d: f64,
    ramp_d: f64,
    level_level: f64,
    level_ramp: f64,
    ramp_ramp: f64,
}

impl Onset {
    fn of(noise: &Noise) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn noisy(samples: i32, place: f64, change: f64, noise: f64) -> Vec<f64> {
        let mut state = 7_u32;
        let mut white = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1_u32 << 24) - 0.5
        };
        let y = |k: f64| 3.0 - 0.2 * k + change * (k - place).max(0.0);
        (0..samples).map(|k| y(f64::from(k)) + noise * white()).collect()
    }

    fn fit(values: &[f64], noise: &Noise) -> (BrokenLine, Evidence) {
        let window = Window::of(values, noise).unwrap();
        window.fit(window.places(), 0.95).unwrap()
    }

    #[test]
    fn a_break_between_samples_is_found_where_it_is() {
        for place in [20.25, 33.5, 47.99] {
            let (found, _) = fit(&noisy(80, place, 0.7, 0.0), &Noise::white());
            assert!((found.place - place).abs() < 1e-9, "{found:?}");
            assert!((found.before.slope + 0.2).abs() < 1e-9, "{found:?}");
            assert!((found.after.slope - 0.5).abs() < 1e-9, "{found:?}");
            assert!((found.before.at(place) - found.after.at(place)).abs() < 1e-9);
            assert!((found.before.at(0.0) - 3.0).abs() < 1e-9);
        }
    }

    #[test]
    fn no_place_on_a_fine_grid_is_better() {
        for noise in [Noise::white(), Noise::of(&[coloured()], 0)] {
            let values = noisy(60, 31.3, 0.05, 0.5);
            let (found, evidence) = fit(&values, &noise);
            let window = Window::of(&values, &noise).unwrap();
            let mut least = f64::INFINITY;
            let places = 100 * evidence.first..100 * (evidence.first + evidence.sse.len());
            for step in places {
                least = least.min(brute_force(&values, step as f64 / 100.0, &noise));
            }
            assert!(found.sse <= least + 1e-9, "{} {least}", found.sse);
            assert!(least - found.sse < 1e-3 * found.sse, "{} {least}", found.sse);
            assert!(window.power > found.sse);
            for (index, sse) in evidence.sse.iter().enumerate() {
                let expected = brute_force(&values, (evidence.first + index) as f64, &noise);
                assert!((sse - expected).abs() < 1e-9, "{index}: {sse} {expected}");
            }
        }
    }

    fn coloured() -> Vec<f64> {
        let mut value = 0.0;
        noisy(5000, 0.0, 0.2, 1.0)
            .into_iter()
            .map(|white| {
                value = 0.8 * value + white;
                value
            })
            .collect()
    }

    /// The squared error of the whitened regression on constant, slope and ramp.
    fn brute_force(values: &[f64], place: f64, noise: &Noise) -> f64 {
        let samples = i32::try_from(values.len()).unwrap();
        let columns = |shape: &dyn Fn(f64) -> f64| {
            let mut column: Vec<f64> = (0..samples).map(|k| shape(f64::from(k))).collect();
            noise.whiten(&mut column);
            column.split_off(noise.order())
        };
        let mut y = values.to_vec();
        noise.whiten(&mut y);
        let y = nalgebra::DVector::from_vec(y.split_off(noise.order()));
        let all = [columns(&|_| 1.0), columns(&|k| k - 30.0), columns(&|k| (k - place).max(0.0))];
        let all = all.map(nalgebra::DVector::from_vec);
        let matrix = nalgebra::DMatrix::from_columns(&all);
        let solved = matrix.clone().svd(true, true).solve(&y, 1e-14).unwrap();
        (y - matrix * solved).norm_squared()
    }

    #[test]
    fn the_interval_ends_where_the_error_has_grown_enough() {
        let values = noisy(60, 31.3, 0.05, 0.5);
        let noise = Noise::white();
        let (found, _) = fit(&values, &noise);
        let freedom = 56.0;
        let t = student_quantile(0.975, freedom);
        let limit = found.sse * (1.0 + t * t / freedom);
        for end in [found.low, found.high] {
            let sse = brute_force(&values, end, &noise);
            assert!((sse / limit - 1.0).abs() < 1e-6, "{found:?}: {sse} {limit}");
        }
        assert!(found.low < found.place && found.place < found.high);
    }

    #[test]
    fn a_line_has_no_break() {
        let (found, _) = fit(&noisy(100, 50.0, 0.0, 1.0), &Noise::white());
        assert!(found.p_value > 0.02, "{found:?}");
        let (found, _) = fit(&noisy(100, 50.0, 0.3, 1.0), &Noise::white());
        assert!(found.p_value < 1e-9, "{found:?}");
    }
}
