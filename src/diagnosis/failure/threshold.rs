//! Where a feature is cut: numbers with few digits that separate the data.

use crate::numerics::{decimal_exponent, to_multiple};

/// Digits after which a number is taken as it is.
const DIGITS: i32 = 17;

/// The different values, ascending, or `None` when there are more than `most`.
pub(super) fn levels(values: &[f64], most: usize) -> Option<Vec<f64>> {
    let mut found: Vec<f64> = Vec::new();
    let mut last = f64::NAN;
    for &value in values.iter().filter(|value| !value.is_nan()) {
        // `-0.0` is the level 0.
        let value = value + 0.0;
        if value.to_bits() == last.to_bits() {
            continue;
        }
        last = value;
        if let Err(index) = found.binary_search_by(|level| level.total_cmp(&value)) {
            if found.len() == most {
                return None;
            }
            found.insert(index, value);
        }
    }
    Some(found)
}

/// Numbers that cut `values` into `parts` or fewer: between all levels where there are no
/// more than `parts` of them, else near the quantiles.
///
/// A number `c` parts the values below it from those at and above it.
pub(super) fn cuts(values: &[f64], parts: usize) -> Vec<f64> {
    match levels(values, parts) {
        Some(levels) => between_levels(&levels),
        None => near_quantiles(values, parts),
    }
}

/// The roundest number in the middle half between each two levels.
fn between_levels(levels: &[f64]) -> Vec<f64> {
    let cut = |(low, high): (&f64, &f64)| {
        let quarter = (high - low) / 4.0;
        roundest(low + quarter, high - quarter)
    };
    levels.iter().zip(levels.iter().skip(1)).map(cut).collect()
}

/// The roundest number near each quantile, a quarter of a part on each side.
fn near_quantiles(values: &[f64], parts: usize) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    // A quarter of a part.
    let margin = sorted.len() / (4 * parts);
    let cut = |part: usize| {
        let rank = part * sorted.len() / parts;
        let low = *sorted.get(rank.saturating_sub(margin + 1))?;
        let high = *sorted.get(rank + margin)?;
        (low < high).then(|| roundest(low, high))
    };
    let mut cuts: Vec<f64> = (1..parts).filter_map(cut).collect();
    cuts.dedup_by(|later, earlier| later <= earlier);
    cuts
}

/// The number of fewest decimals in `(low, high]`, the nearest to the middle of those.
fn roundest(low: f64, high: f64) -> f64 {
    if low < 0.0 && high >= 0.0 {
        return 0.0;
    }
    let largest = low.abs().max(high.abs());
    let exponent = decimal_exponent(largest);
    let middle = f64::midpoint(low, high);
    let rounded = (0..DIGITS).map(|digit| to_multiple(middle, exponent - digit));
    let mut inside = rounded.filter(|value| *value > low && *value <= high);
    inside.next().unwrap_or(high)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn levels_are_cut_between_at_few_digits() {
        let levels = [-2.5, -1.0, 0.0, 1.0, 1.5, 4.0].repeat(9);
        let shown: Vec<String> = cuts(&levels, 12).iter().map(f64::to_string).collect();
        assert_eq!(shown, ["-2", "-0.5", "0.5", "1.3", "3"]);
    }

    #[test]
    fn quantiles_of_a_ramp_are_round() {
        let ramp: Vec<f64> = (0..1000).map(|k| 0.010_01 * f64::from(k)).collect();
        let shown: Vec<String> = cuts(&ramp, 5).iter().map(f64::to_string).collect();
        assert_eq!(shown, ["2", "4", "6", "8"]);
    }

    #[test]
    fn a_value_that_stands_still_is_one_part() {
        let mut values = vec![0.0; 500];
        values.extend((0..500).map(|k| 1.0 + f64::from(k)));
        let cuts = cuts(&values, 10);
        assert!(cuts[0] > 0.0 && cuts[0] < 60.0, "{cuts:?}");
    }

    proptest! {
        #[test]
        fn the_roundest_number_is_in_its_interval(low in -1e6..1e6_f64, width in 1e-9..1e3_f64) {
            let high = low + width;
            prop_assume!(high > low);
            let value = roundest(low, high);
            prop_assert!(value > low && value <= high);
            prop_assert!(value.to_string().len() <= high.to_string().len().max(low.to_string().len()));
        }

        #[test]
        fn cuts_ascend_and_leave_no_part_empty(
            values in prop::collection::vec(-100_i32..100, 1..400),
            parts in 2_usize..40,
        ) {
            let values: Vec<f64> = values.into_iter().map(|value| f64::from(value) / 8.0).collect();
            let cuts = cuts(&values, parts);
            prop_assert!(cuts.len() < parts);
            prop_assert!(cuts.is_sorted_by(|a, b| a < b));
            for cut in cuts {
                prop_assert!(values.iter().any(|v| *v < cut) && values.iter().any(|v| *v >= cut));
            }
        }
    }
}
