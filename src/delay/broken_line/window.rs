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
//! (profile likelihood, with the segment's own `s²`). The p-value of so good a break in
//! noise alone is that of a random direction coming so near to a curve on a sphere, whose
//! length is `√3/2 · ln(s/(1−s))` between the ends of the search (`s` the break's position as
//! a part of the segment).
//!
//! # References
//! D. J. Hudson, "Fitting segmented curves whose join points have to be estimated", JASA 61
//! (1966). H. Hotelling, "Tubes and spheres in n-spaces", Am. J. Math. 61 (1939).
//! M. Knowles and D. Siegmund, "On Hotelling's approach to testing for a nonlinear parameter
//! in regression", Int. Stat. Rev. 57 (1989).

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use super::frame::{Bends, Frame};
use super::gains::BreakGains;
use super::piece::Piece;
use crate::numerics::{Line, NoiseModel, fisher_tail, moments, student_quantile, subtract_line};
use crate::units::floor_to_index;

/// Fewest samples beside those that the noise remembers.
pub(crate) const FEWEST: usize = 8;

/// Parameters of a broken line.
pub(crate) const PARAMETERS: usize = 4;

/// The interval whose sides give the median of what is likely, and the end of its upper half.
const USUAL: f64 = 0.95;
const UPPER: f64 = 0.975;

/// The best broken line through a window; positions are indices of the window.
#[derive(Clone, Debug, PartialEq)]
pub struct BrokenLine {
    /// Where it breaks.
    pub position: f64,
    /// The first position that the data do not exclude.
    pub low: f64,
    /// The last of them.
    pub high: f64,
    /// The position that the true one is as likely before as behind.
    pub median: f64,
    /// The p-value of so good a break in noise alone.
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
/// assert!((found.position - 33.3).abs() < 1e-9);
/// assert!((found.after.slope - 0.2).abs() < 1e-9);
/// ```
pub fn broken_line(values: &[f64], confidence: f64) -> Option<BrokenLine> {
    let noise = NoiseModel::white();
    let window = Window::of(values, &noise)?;
    Some(window.fit(window.positions(), confidence, 0.0)?.0)
}

impl BrokenLine {
    /// About the standard error of the position in the median of so many samples: that of where
    /// two lines meet that are fitted apart.
    pub(crate) fn position_error(&self, samples: usize) -> f64 {
        // With s² = SSE/n, the end of a line through n/2 samples is known to 2s/√(n/2), and so the
        // gap between two to 4s/√n; it closes by the change of slope per sample.
        4.0 * self.sse.sqrt() / samples as f64 / (self.after.slope - self.before.slope).abs()
    }

    /// Residuals of the window's output.
    pub(crate) fn residuals(&self, values: &[f64]) -> Vec<f64> {
        let fitted = |k: f64| if k < self.position { self.before.at(k) } else { self.after.at(k) };
        values.iter().enumerate().map(|(k, y)| y - fitted(k as f64)).collect()
    }
}

/// The error of broken lines with the break at each sample of a range, and the lines.
#[derive(Clone, Debug)]
pub(crate) struct Evidence {
    pub(crate) first: usize,
    pub(crate) sse: Vec<f64>,
    pub(crate) bends: Bends,
}

/// A window's output, whitened, and its residuals about one line.
#[derive(Clone, Debug)]
pub(crate) struct Window<'a> {
    noise: &'a NoiseModel,
    frame: Frame,
    /// The residuals about one line, whitened once more backwards: sums of it behind a sample are what
    /// a whitened level has for inner product with the residual.
    pulled: Vec<f64>,
    /// The squared error of one line.
    power: f64,
    rows: f64,
}

impl<'a> Window<'a> {
    /// `None` with too few samples for two lines.
    pub(crate) fn of(values: &[f64], noise: &'a NoiseModel) -> Option<Self> {
        let order = noise.order();
        let rows = values.len().checked_sub(order).filter(|rows| *rows >= FEWEST)?;
        let offset = *values.first()?;
        let mut residuals: Vec<f64> = values.iter().map(|y| y - offset).collect();
        noise.whiten(&mut residuals);
        let rows = rows as f64;
        let spread = rows * (rows * rows - 1.0) / 12.0;
        let kept = &mut residuals[order..];
        let (sum, moment, _) = moments(kept, 0.0);
        let half = (rows - 1.0) / 2.0;
        // Σ (k − half)·y/Σ (k − half)².
        let (mean, slope) = (sum / rows, (moment - half * sum) / spread);
        let power = subtract_line(kept, mean - slope * half, slope);
        let line = (offset + mean / noise.level, slope / noise.level);
        // With W whitening, (W·level)·r = level·(Wᵀ·r): plain sums behind a break from here on.
        noise.pull(&mut residuals);
        Some(Self { noise, frame: Frame::of(noise, rows, line), pulled: residuals, power, rows })
    }

    /// Positions at which a break leaves enough samples on both sides.
    pub(crate) fn positions(&self) -> RangeInclusive<usize> {
        let order = self.noise.order();
        order.max(1)..=self.pulled.len().saturating_sub(3 + order)
    }

    /// The best broken line with its break in `positions`.
    pub(crate) fn best(&self, positions: RangeInclusive<usize>) -> Option<BrokenLine> {
        if positions.is_empty() {
            return None;
        }
        Some(self.search(&BreakGains::of(&self.frame, &self.pulled, &positions)))
    }

    /// The best broken line with its break in `positions`, with an interval that holds the
    /// true break as often as `confidence` says; and the error all over the `positions`, with lines
    /// over numbers that are `number` at the window's first sample.
    pub(crate) fn fit(
        &self,
        positions: RangeInclusive<usize>,
        confidence: f64,
        number: f64,
    ) -> Option<(BrokenLine, Evidence)> {
        if positions.is_empty() {
            return None;
        }
        let at = BreakGains::of(&self.frame, &self.pulled, &positions);
        let mut line = self.search(&at);
        let freedom = (self.rows - PARAMETERS as f64).max(1.0);
        let ends = |confidence: f64| {
            let t = student_quantile(f64::midpoint(1.0, confidence), freedom);
            // SSE(τ) ≤ SSE + t²·s² with s² = SSE/ν, as what a break has to explain.
            let limit = self.power - line.sse * (1.0 + t * t / freedom);
            self.interval(&at, limit, line.position)
        };
        let usual = ends(USUAL);
        let asked = if (confidence - USUAL).abs() < 1e-12 { usual } else { ends(confidence) };
        line.median = median(line.position, usual, student_quantile(UPPER, freedom));
        (line.low, line.high) = asked;
        let first = at.first;
        let (sse, changes) = at.into_errors(self.power);
        let bends = Bends::of(self.frame, first, changes, number);
        Some((line, Evidence { first, sse, bends }))
    }

    /// The best break of all, which is its own interval.
    fn search(&self, at: &BreakGains) -> BrokenLine {
        let mut best = (0.0, 0, 0.0, Piece::default());
        for index in at.promising(&self.frame) {
            let piece = at.piece(index, &self.frame);
            let (s, gain) = piece.best();
            if gain >= best.0 {
                best = (gain, at.first + index, s, piece);
            }
        }
        let (gain, j, s, piece) = best;
        let position = j as f64 + s;
        let last = at.first + at.gain.len();
        let ends = (at.first as f64 + 0.5, last as f64);
        let samples = self.pulled.len() as f64;
        let p_value = p_value(gain / self.power, self.rows - 2.0, samples, ends);
        let (before, after) = self.frame.lines(&piece, j as f64, s, 0.0);
        let sse = (self.power - gain).max(0.0);
        let (low, median, high) = (position, position, position);
        BrokenLine { position, low, high, median, p_value, sse, before, after }
    }

    /// The outermost positions whose gain is `limit`.
    fn interval(&self, at: &BreakGains, limit: f64, position: f64) -> (f64, f64) {
        let good = |gain: &f64| *gain >= limit;
        let (first, count) = (at.first, at.gain.len());
        let cross = |j: usize| {
            let index = j.checked_sub(first).filter(|index| *index < count)?;
            let (low, high) = at.piece(index, &self.frame).crossings(limit)?;
            Some((j as f64 + low, j as f64 + high))
        };
        // The best break is inside, although the ends of its piece may not be.
        let piece_of_best = if position >= 0.0 { floor_to_index(position) } else { first };
        let lowest = at.gain.iter().position(good).map_or(piece_of_best + 1, |i| first + i);
        let low = match lowest.min(piece_of_best + 1) {
            j if j > first => cross(j - 1).map_or(j as f64 - 1.0, |(first, _)| first),
            _ => first as f64,
        };
        let highest = at.gain.iter().rposition(good).map_or(piece_of_best, |i| first + i);
        let highest = highest.max(piece_of_best);
        let end = (first + count) as f64;
        let high = if highest + 1 >= first + count && limit <= 0.0 {
            end
        } else {
            cross(highest).map_or(highest as f64 + 1.0, |(_, last)| last)
        };
        (low.min(position), high.max(position))
    }
}

/// The position that the true one is as likely before as behind, given the most likely one and its
/// interval from `low` to `high`, `t` standard errors to each side.
///
/// Where samples are few beside the noise the squared error grows faster to one side than to
/// the other. Of two half normals that meet at the most likely position, each as wide as its side
/// of the interval, the median is on the wider one.
pub(crate) fn median(position: f64, (low, high): (f64, f64), t: f64) -> f64 {
    /// Times the other side: what is wider reaches into another valley.
    const WIDEST: f64 = 2.0;
    let (before, after) = (position - low, high - position);
    let (before, after) = (before.min(WIDEST * after), after.min(WIDEST * before));
    let wide = before.max(after);
    if !(wide > 0.0 && wide.is_finite()) {
        return position;
    }
    // a/(a + b)·2·(1 − Φ(x)) = ½ on the wider side a: Φ(x) = ½ + (1 − b/a)/4.
    let odd = (after - before) / wide;
    // The quantile of a normal variable at ½ + odd/4, to a thousandth.
    position + wide / t * odd * (0.626_7 + 0.047_8 * odd * odd)
}

/// The probability that noise alone gains the `share` of its power with a break between `low`
/// and `high` of `samples`, where there are that many `dimensions` to gain in.
pub(crate) fn p_value(share: f64, dimensions: f64, samples: f64, (low, high): (f64, f64)) -> f64 {
    if !share.is_finite() || dimensions < 3.0 {
        return 1.0;
    }
    let share = share.clamp(0.0, 1.0);
    // The curve's ends are a sample from those of the window at least.
    let odds = |position: f64| (position.max(1.0) / (samples - position).max(1.0)).ln();
    let length = 0.75_f64.sqrt() * (odds(high) - odds(low)).max(0.0);
    // Knowles and Siegmund: length/(2π)·(1 − r²)^((m − 2)/2), for a gain of either sign.
    let tube = length / PI * (1.0 - share).powf((dimensions - 2.0) / 2.0);
    let freedom = dimensions - 1.0;
    let statistic = freedom * share / (1.0 - share).max(f64::MIN_POSITIVE);
    // The caps at both ends of the curve: together what one given direction gains, F with 1 and
    // m − 1 degrees of freedom.
    let ends = fisher_tail(statistic, 1, floor_to_index(freedom)).unwrap_or(1.0);
    (tube + ends).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::uniform;

    fn noisy(samples: i32, position: f64, change: f64, noise: f64) -> Vec<f64> {
        let mut white = uniform(7);
        let y = |k: f64| 3.0 - 0.2 * k + change * (k - position).max(0.0);
        (0..samples).map(|k| y(f64::from(k)) + noise * white()).collect()
    }

    fn fit(values: &[f64], noise: &NoiseModel) -> (BrokenLine, Evidence) {
        let window = Window::of(values, noise).unwrap();
        window.fit(window.positions(), 0.95, 0.0).unwrap()
    }

    #[test]
    fn a_break_between_samples_is_found_where_it_is() {
        for position in [20.25, 33.5, 47.99] {
            let (found, _) = fit(&noisy(80, position, 0.7, 0.0), &NoiseModel::white());
            assert!((found.position - position).abs() < 1e-9, "{found:?}");
            assert!((found.before.slope + 0.2).abs() < 1e-9, "{found:?}");
            assert!((found.after.slope - 0.5).abs() < 1e-9, "{found:?}");
            assert!((found.before.at(position) - found.after.at(position)).abs() < 1e-9);
            assert!((found.before.at(0.0) - 3.0).abs() < 1e-9);
        }
    }

    #[test]
    fn no_place_on_a_fine_grid_is_better() {
        for noise in [NoiseModel::white(), NoiseModel::of(&[coloured()], 0)] {
            let values = noisy(60, 31.3, 0.05, 0.5);
            let (found, evidence) = fit(&values, &noise);
            let window = Window::of(&values, &noise).unwrap();
            let mut least = f64::INFINITY;
            let positions = 100 * evidence.first..100 * (evidence.first + evidence.sse.len());
            for step in positions {
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
    fn brute_force(values: &[f64], position: f64, noise: &NoiseModel) -> f64 {
        let samples = i32::try_from(values.len()).unwrap();
        let columns = |shape: &dyn Fn(f64) -> f64| {
            let mut column: Vec<f64> = (0..samples).map(|k| shape(f64::from(k))).collect();
            noise.whiten(&mut column);
            column.split_off(noise.order())
        };
        let mut y = values.to_vec();
        noise.whiten(&mut y);
        let y = nalgebra::DVector::from_vec(y.split_off(noise.order()));
        let all =
            [columns(&|_| 1.0), columns(&|k| k - 30.0), columns(&|k| (k - position).max(0.0))];
        let all = all.map(nalgebra::DVector::from_vec);
        let matrix = nalgebra::DMatrix::from_columns(&all);
        let solved = matrix.clone().svd(true, true).solve(&y, 1e-14).unwrap();
        (y - matrix * solved).norm_squared()
    }

    #[test]
    fn the_interval_ends_where_the_error_has_grown_enough() {
        let values = noisy(60, 31.3, 0.05, 0.5);
        let noise = NoiseModel::white();
        let (found, _) = fit(&values, &noise);
        let freedom = 56.0;
        let t = student_quantile(0.975, freedom);
        let limit = found.sse * (1.0 + t * t / freedom);
        for end in [found.low, found.high] {
            let sse = brute_force(&values, end, &noise);
            assert!((sse / limit - 1.0).abs() < 1e-6, "{found:?}: {sse} {limit}");
        }
        assert!(found.low < found.position && found.position < found.high);
    }

    #[test]
    fn the_median_of_two_half_normals_halves_them() {
        let t = 1.96;
        assert!((median(5.0, (4.0, 6.0), t) - 5.0).abs() < 1e-12);
        // Half of two unit normals' halves, one 1.6 times as wide: Φ(z) = ½ + 0.6/1.6/4.
        let (narrow, wide) = (t, 1.6 * t);
        let found = median(0.0, (-narrow, wide), t);
        let right = crate::numerics::normal_below(found / 1.6) - 0.5;
        assert!((2.0 * right * 1.6 / 2.6 - (0.5 - 1.0 / 2.6)).abs() < 1e-3, "{found}");
        assert!((median(0.0, (-wide, narrow), t) + found).abs() < 1e-12);
        // Another valley counts no more than a side twice as wide.
        assert!((median(0.0, (-1.0, 40.0), t) - median(0.0, (-1.0, 2.0), t)).abs() < 1e-12);
        assert!(median(3.0, (f64::NEG_INFINITY, 4.0), t).is_finite());
    }

    #[test]
    fn a_line_has_no_break() {
        let (found, _) = fit(&noisy(100, 50.0, 0.0, 1.0), &NoiseModel::white());
        assert!(found.p_value > 0.02, "{found:?}");
        let (found, _) = fit(&noisy(100, 50.0, 0.3, 1.0), &NoiseModel::white());
        assert!(found.p_value < 1e-9, "{found:?}");
    }
}
