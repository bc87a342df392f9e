//! Levels that are worth a trial.

use crate::effect::Dimension;
use crate::explain::extension::components_of;
use crate::explain::separation::Pattern;
use crate::model::JointModel;
use crate::numerics::{decimal_exponent, to_digits, to_multiple};

/// Magnitudes of levels that are worth a trial between a least and a largest one, and the
/// patterns to try them in: near both, near the `thresholds` of the effects, and beyond the
/// largest.
pub(crate) fn level_sets(
    (least, largest): (f64, f64),
    thresholds: &[f64],
) -> Vec<(Vec<f64>, &'static [Pattern])> {
    const ALL: &[Pattern] = &[Pattern::Ladder, Pattern::Pulses, Pattern::Reversals];
    const LADDER: &[Pattern] = &[Pattern::Ladder];
    let parts_of = |level: f64, parts: &[f64]| -> Vec<f64> {
        let mut levels: Vec<f64> = parts.iter().map(|part| two_digits(part * level)).collect();
        levels.dedup();
        levels
    };
    let mut sets = vec![
        (parts_of(least, &[0.25, 0.5, 0.75, 1.0]), LADDER),
        (parts_of(largest, &[0.25, 0.5, 0.75, 1.0]), LADDER),
        (parts_of(largest, &[0.5, 1.0]), ALL),
        (parts_of(largest, &[1.25, 1.5]), ALL),
    ];
    sets.extend(thresholds.iter().map(|t| (parts_of(*t, &[0.6, 0.8, 1.2, 1.4]), LADDER)));
    sets
}

/// The levels of the input at which the effects `ids` of their models switch or bend,
/// different ones.
///
/// A level within 15 % of one before counts as the same; one below 2 % of the largest is none.
pub(crate) fn thresholds(suspects: [(&JointModel, &[&'static str]); 2], largest: f64) -> Vec<f64> {
    /// Thresholds that are tried, at most. Chosen: each multiplies the inputs to simulate.
    const TRIED: usize = 4;
    const SAME: f64 = 0.15;
    const LEAST: f64 = 0.02;
    let mut found: Vec<f64> = Vec::new();
    let components = suspects.into_iter().flat_map(|(model, ids)| components_of(model, ids));
    for component in components {
        let specs = component.effect().spec().parameters.iter();
        let levels = specs.zip(component.parameters());
        for (_, value) in levels.filter(|(spec, _)| spec.dimension == Dimension::Input) {
            let level = value.value.abs();
            let is_new = found.iter().all(|known| (level / known - 1.0).abs() > SAME);
            if is_new && level > LEAST * largest && level < largest {
                found.push(level);
            }
        }
    }
    found.truncate(TRIED);
    found
}

/// `value` to two significant digits, so that what is said is what was tried.
pub(crate) fn two_digits(value: f64) -> f64 {
    to_digits(value, 2)
}

/// `value` to the second significant digit of `size`.
pub(crate) fn two_digits_of(value: f64, size: f64) -> f64 {
    if size == 0.0 || !size.is_finite() {
        return value;
    }
    to_multiple(value, decimal_exponent(size) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_said_in_two_digits() {
        assert!((two_digits(0.123_4) - 0.12).abs() < 1e-12);
        assert!((two_digits_of(32.456, 80.0) - 32.0).abs() < 1e-12);
    }
}
