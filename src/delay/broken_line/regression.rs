//! A line that breaks once, through points that are not equally spaced.
//!
//! ```text
//! y = A + b·x + c·max(x − ψ, 0) + e
//! ```
//!
//! Between two neighbouring `x` the squared error is the same quotient of two quadratics as
//! between two samples, so that every position is searched exactly. Standard errors are those
//! of the regression on `1, x, max(x − ψ, 0)` and `−c·[x > ψ]`, whose last coefficient is how
//! far ψ would still move (the delta method).
//!
//! # References
//! V. M. R. Muggeo, "Estimating regression models with unknown break-points", Statistics in
//! Medicine 22 (2003).

use nalgebra::{Matrix4, Vector4};

use super::piece::Piece;
use crate::delay::lag::LagPart;

/// Fewest points, for a variance beside four parameters.
const FEWEST: usize = 6;

/// The best line that breaks once, with standard errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrokenRegression {
    /// ψ: where it breaks.
    pub position: LagPart,
    /// Slope before the break.
    pub slope_before: LagPart,
    /// Slope behind it.
    pub slope_after: LagPart,
    /// Value of the first line at zero.
    pub intercept: f64,
    /// Squared error.
    pub sse: f64,
    /// Degrees of freedom.
    pub freedom: usize,
}

/// The best broken line through `points` of x and y, in any order. `None` for fewer than
/// six, for less than four different x, and where no line breaks between them.
///
/// # Examples
/// ```
/// use tauscope::delay::broken_regression;
///
/// let y = |x: f64| 1.0 - 0.5 * x - 2.0 * (x - 0.3_f64).max(0.0);
/// let points: Vec<_> = [-1.0, -0.4, 0.1, 0.2, 0.5, 0.9, 1.4].map(|x| (x, y(x))).into();
/// let found = broken_regression(&points).unwrap();
/// assert!((found.position.value - 0.3).abs() < 1e-9);
/// assert!((found.slope_after.value + 2.5).abs() < 1e-9);
/// ```
pub fn broken_regression(points: &[(f64, f64)]) -> Option<BrokenRegression> {
    let mut points = points.to_vec();
    if points.len() < FEWEST || points.iter().any(|(x, y)| !x.is_finite() || !y.is_finite()) {
        return None;
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    regression(&points, best_position(&points)?)
}

/// Sums over some points, `x` and `y` about their means.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    n: f64,
    x: f64,
    xx: f64,
    y: f64,
    xy: f64,
}

impl Sums {
    fn add(&mut self, x: f64, y: f64) {
        self.n += 1.0;
        self.x += x;
        self.xx += x * x;
        self.y += y;
        self.xy += x * y;
    }
}

/// The position of the least squared error among sorted points.
fn best_position(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len() as f64;
    let mean_x = points.iter().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = points.iter().map(|(_, y)| y).sum::<f64>() / n;
    let about = |(x, y): &(f64, f64)| (x - mean_x, y - mean_y);
    let mut whole = Sums::default();
    points.iter().map(about).for_each(|(x, y)| whole.add(x, y));
    let mut behind = Sums::default();
    let mut best: Option<(f64, f64)> = None;
    let pairs: Vec<_> = points.windows(2).collect();
    for pair in pairs.into_iter().rev() {
        let [before, after] = pair else { continue };
        let ((x, _), (next, y)) = (about(before), about(after));
        behind.add(next, y);
        let width = next - x;
        // One slope on each side takes two points.
        if width <= 0.0 || behind.n < 2.0 || whole.n - behind.n < 2.0 {
            continue;
        }
        let (s, gain) = piece(&whole, &behind, x, width).best();
        if best.is_none_or(|(most, _)| gain > most) {
            best = Some((gain, mean_x + x + s * width));
        }
    }
    best.map(|(_, position)| position)
}

/// Level and ramp over the points `behind` `x`, the ramp in units of `width`, without what a
/// line through the `whole` can do.
fn piece(whole: &Sums, behind: &Sums, x: f64, width: f64) -> Piece {
    let Sums { n, x: sum, xx, y, xy } = *behind;
    // Σ (x_i − x)/width over the points behind, and its products likewise.
    let ramp = (sum - x * n) / width;
    let ramp_x = (xx - x * sum) / width;
    let ramp_ramp = (xx - 2.0 * x * sum + x * x * n) / (width * width);
    let (per_level, per_slope) = (whole.n.sqrt().recip(), whole.xx.sqrt().recip());
    let (level_line, ramp_line) =
        ([n * per_level, sum * per_slope], [ramp * per_level, ramp_x * per_slope]);
    let line_y = [0.0, whole.xy * per_slope];
    let less = |product: f64, a: [f64; 2], b: [f64; 2]| product - a[0] * b[0] - a[1] * b[1];
    Piece {
        level_y: less(y, level_line, line_y),
        ramp_y: less((xy - x * y) / width, ramp_line, line_y),
        level_level: less(n, level_line, level_line),
        level_ramp: less(ramp, level_line, ramp_line),
        ramp_ramp: less(ramp_ramp, ramp_line, ramp_line),
        level_line,
        ramp_line,
    }
}

/// The regression at a position, and what is known of it.
fn regression(points: &[(f64, f64)], position: f64) -> Option<BrokenRegression> {
    let columns = |x: f64, change: f64| {
        let step = if x > position { -change } else { 0.0 };
        Vector4::new(1.0, x - position, (x - position).max(0.0), step)
    };
    // The change only scales the last column: one regression determines it, another uses it.
    let (found, ..) = solved(points, |x| {
        let mut row = columns(x, 1.0);
        row[3] = 0.0;
        row
    })?;
    let [value, slope, change, _] = found.into();
    let row = |x: f64| columns(x, change);
    let (_, covariance, _) = solved(points, row)?;
    let residual = |(x, y): &(f64, f64)| y - row(*x).dot(&Vector4::new(value, slope, change, 0.0));
    let sse: f64 = points.iter().map(residual).map(|r| r * r).sum();
    // A, b, c and ψ.
    let freedom = points.len() - 4;
    let variance = sse / freedom as f64;
    let part = |value: f64, along: Vector4<f64>| {
        let square = (covariance * along).dot(&along) * variance;
        LagPart { value, std_error: square.max(0.0).sqrt() }
    };
    Some(BrokenRegression {
        position: part(position, Vector4::w()),
        slope_before: part(slope, Vector4::y()),
        // Their variances and twice their covariance.
        slope_after: part(slope + change, Vector4::y() + Vector4::z()),
        intercept: value - slope * position,
        sse,
        freedom,
    })
}

/// Coefficients, inverse of the products of columns, and whether all columns count; a column
/// of zeros gets a coefficient of 0.
fn solved(
    points: &[(f64, f64)],
    row: impl Fn(f64) -> Vector4<f64>,
) -> Option<(Vector4<f64>, Matrix4<f64>, bool)> {
    let (mut products, mut with) = (Matrix4::zeros(), Vector4::zeros());
    for (x, y) in points {
        let row = row(*x);
        products += row * row.transpose();
        with += row * *y;
    }
    let empty = products[(3, 3)] == 0.0;
    if empty {
        // A column of zeros stands alone: the inverse of the others stays what it is.
        products[(3, 3)] = 1.0;
    }
    let inverse = products.try_inverse()?;
    let found = inverse * with;
    found.iter().all(|value| value.is_finite()).then_some((found, inverse, !empty))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_spacing_gives_what_the_broken_line_of_samples_does() {
        let y = |k: i32| 0.3 * f64::from((k - 17).max(0)) + f64::from(k * k % 7) * 0.1;
        let values: Vec<f64> = (0..40).map(y).collect();
        let points: Vec<_> = (0..40).map(|k| (f64::from(k), y(k))).collect();
        let expected = crate::delay::broken_line(&values, 0.95).unwrap();
        let found = broken_regression(&points).unwrap();
        assert!((found.position.value - expected.position).abs() < 1e-9, "{found:?} {expected:?}");
        assert!((found.sse - expected.sse).abs() < 1e-9);
        assert!((found.slope_after.value - expected.after.slope).abs() < 1e-9);
        assert!((found.intercept - expected.before.intercept).abs() < 1e-9);
    }

    #[test]
    fn too_few_points_have_no_break() {
        let points: Vec<_> = (0..5).map(|k| (f64::from(k), f64::from(k % 2))).collect();
        assert_eq!(broken_regression(&points), None);
        assert_eq!(broken_regression(&[(1.0, 2.0); 9]), None);
        assert_eq!(broken_regression(&[(f64::NAN, 2.0); 9]), None);
    }
}
