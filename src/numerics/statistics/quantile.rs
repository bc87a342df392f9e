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

/// Values that are copied, which is faster; of more it would take too much memory.
const COPIED: usize = 1 << 20;

/// [`quantile`] of values that are not copied where they are very many.
pub(crate) fn quantile_of(values: &(impl Iterator<Item = f64> + Clone), part: f64) -> Option<f64> {
    let last = values.clone().count().checked_sub(1)?;
    if last < COPIED {
        return quantile(&values.clone().collect::<Vec<f64>>(), part);
    }
    Some(quantile_by_digits(values, last, part))
}

/// The quantile of values whose last index is `last`, by passes over them.
fn quantile_by_digits(values: &(impl Iterator<Item = f64> + Clone), last: usize, part: f64) -> f64 {
    let place = part.clamp(0.0, 1.0) * last as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
    let index = place as usize;
    let lower = nth(values, index);
    let upper = if index < last { next(values, lower, index) } else { lower };
    lower + place.fract() * (upper - lower)
}

/// The value that so many others, `rank`, come before in their order, found digit by digit of
/// its bits: every pass counts the values that begin as it does.
fn nth(values: &(impl Iterator<Item = f64> + Clone), mut rank: usize) -> f64 {
    /// Bits of a digit, and where the digits begin.
    const DIGIT: u32 = 11;
    const STARTS: [u32; 6] = [55, 44, 33, 22, 11, 0];
    let mut known = 0;
    for start in STARTS {
        let mut counts = [0_usize; 1 << DIGIT];
        let rest = values.clone().map(|value| ordered(value) >> start);
        for digits in rest.filter(|digits| digits >> DIGIT == known) {
            let digit = usize::try_from(digits % (1 << DIGIT)).unwrap_or_default();
            counts[digit] += 1;
        }
        let mut digit = 0;
        for (count, number) in counts.into_iter().zip(0..) {
            digit = number;
            if rank < count {
                break;
            }
            rank -= count;
        }
        known = (known << DIGIT) | digit;
    }
    // The inverse of `ordered`.
    let bits = if known & SIGN == 0 { !known } else { known ^ SIGN };
    f64::from_bits(bits)
}

/// The value behind `value`, which is the one at `index` in their order.
fn next(values: &(impl Iterator<Item = f64> + Clone), value: f64, index: usize) -> f64 {
    let this = ordered(value);
    let up_to = values.clone().filter(|other| ordered(*other) <= this).count();
    // Others equal it: the next in the order is one of them.
    if up_to > index + 1 {
        return value;
    }
    let above = values.clone().filter(|other| ordered(*other) > this);
    above.min_by(f64::total_cmp).unwrap_or(value)
}

/// The bit of the sign.
const SIGN: u64 = 1 << 63;

/// The bits of a number, as a number that is the larger the larger it is.
fn ordered(value: f64) -> u64 {
    let bits = value.to_bits();
    if bits & SIGN == 0 { bits ^ SIGN } else { !bits }
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
pub(crate) fn noise_of_differences<'a>(series: impl Iterator<Item = &'a [f64]> + Clone) -> f64 {
    let of_one = |values: &'a [f64]| values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let count: usize = series.clone().map(|values| values.len().saturating_sub(1)).sum();
    let scale = if count > COPIED {
        nth(&series.flat_map(of_one), count / 2) / NORMAL
    } else {
        let mut distances = Vec::with_capacity(count);
        series.for_each(|values| distances.extend(of_one(values)));
        scale_of_distances(distances)
    };
    scale / std::f64::consts::SQRT_2
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
    #[test]
    fn values_that_are_not_copied_have_the_same_quantiles() {
        let wild = |k: u32| ((f64::from(k) * 12.9898).sin() * 43_758.545).fract();
        let values: Vec<f64> = (0..500).map(|k| wild(k) * 10_f64.powf(9.0 * wild(k + 7))).collect();
        for values in [&values[..], &values[..2], &[-0.0, 0.0, 3.0], &[1.0; 7], &[]] {
            for part in [0.0, 0.001, 0.37, 0.5, 0.999, 1.0] {
                let expected = quantile(values, part).map(f64::to_bits);
                let found = quantile_of(&values.iter().copied(), part);
                assert_eq!(found.map(f64::to_bits), expected);
                let Some(last) = values.len().checked_sub(1) else { continue };
                let found = quantile_by_digits(&values.iter().copied(), last, part);
                assert_eq!(Some(found.to_bits()), expected);
            }
        }
    }
}
