//! Quantiles of a sample.

/// The value below which this part (0 to 1) of `values` lies, on a line between the two
/// nearest; `None` when there are none. What is not a number must be left out by the caller.
pub fn quantile(values: &[f64], part: f64) -> Option<f64> {
    let mut values = values.to_vec();
    let place = part.clamp(0.0, 1.0) * values.len().checked_sub(1)? as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    let index = place as usize;
    // Quickselect: linear time, where sorting takes n log n.
    let (_, lower, above) = values.select_nth_unstable_by(index, f64::total_cmp);
    let lower = *lower;
    let upper = above.iter().copied().min_by(f64::total_cmp).unwrap_or(lower);
    Some(lower + place.fract() * (upper - lower))
}

/// The least and the greatest of `values`; infinite where there are none.
pub(crate) fn limits(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    values.into_iter().fold(none, |(low, high), value| (low.min(value), high.max(value)))
}

/// The middle value, or the mean of the two in the middle.
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// Median distance of a normal variable from zero, in standard deviations.
const NORMAL: f64 = 0.674_489_750_196_081_7;

/// The standard deviation of normal values, from their median distance from zero.
pub(crate) fn robust_scale(values: &[f64]) -> f64 {
    scale_of_distances(values.iter().map(|value| value.abs()).collect())
}

/// The least change from one value to the next of `pairs` that is one: of a sensor with counts, a count.
/// None where nothing changes.
pub(crate) fn least_change<'a>(pairs: impl Iterator<Item = &'a [f64]>) -> Option<f64> {
    let changes = pairs.map(|pair| (pair[1] - pair[0]).abs()).filter(|change| *change > 0.0);
    changes.min_by(f64::total_cmp).filter(|least| least.is_finite())
}

/// [`robust_scale`] of values whose distances from zero are given.
fn scale_of_distances(mut distances: Vec<f64>) -> f64 {
    let middle = distances.len() / 2;
    if distances.is_empty() {
        return 0.0;
    }
    *distances.select_nth_unstable_by(middle, f64::total_cmp).1 / NORMAL
}

/// The standard deviation of the noise of a series, from the second differences of `triples` of
/// neighbours, in which an even motion has no part: `Var(e₁ − 2e₂ + e₃) = 6σ²`. Of what is measured in
/// coarse steps it may be zero.
pub(crate) fn noise_of_bends<'a>(triples: impl Iterator<Item = &'a [f64]>) -> f64 {
    let bends = triples.map(|y| (y[0] - 2.0 * y[1] + y[2]).abs());
    scale_of_distances(bends.collect()) / 6.0_f64.sqrt()
}

/// The standard deviation of the noise of several series, from differences of neighbours, which
/// leave little of a motion.
pub(crate) fn noise_of_differences<'a>(series: impl Iterator<Item = &'a [f64]>) -> f64 {
    let pairs = series.flat_map(|values| values.windows(2));
    let distances = pairs.map(|pair| (pair[1] - pair[0]).abs());
    scale_of_distances(distances.collect()) / std::f64::consts::SQRT_2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is(found: Option<f64>, expected: f64) -> bool {
        found.is_some_and(|found| (found - expected).abs() < 1e-15)
    }

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median(&[]), None);
        assert!(is(median(&[5.0]), 5.0));
        assert!(is(median(&[3.0, 1.0, 2.0]), 2.0));
        assert!(is(median(&[4.0, 1.0, 2.0, 9.0]), 3.0));
    }

    #[test]
    fn quartiles_lie_between_their_neighbours() {
        // As `numpy.quantile` has them.
        let values = [7.0, 1.0, 3.0, 9.0, 4.0, 8.0];
        assert!(is(quantile(&values, 0.25), 3.25));
        assert!(is(quantile(&values, 0.75), 7.75));
        assert!(is(quantile(&values, 0.0), 1.0) && is(quantile(&values, 1.0), 9.0));
    }
}
