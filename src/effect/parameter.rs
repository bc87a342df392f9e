//! One parameter of an effect: its unit, its limits, where a fit starts.

use serde::Serialize;

use super::{Dimension, RecordRange};

/// Stands for "no limit" in a parameter, in any unit: finite, so that it can be written
/// to a file and computed with, and far from anything a joint reaches.
pub const UNLIMITED: f64 = 1e12;

/// Whether `value` stands for "no limit": a number that happens to be larger is one.
pub(crate) fn is_unlimited(value: f64) -> bool {
    value.abs().total_cmp(&UNLIMITED).is_eq()
}

/// One parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name in files, in snake case.
    pub name: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// Its unit.
    pub dimension: Dimension,
    /// The value at which, with the others at theirs, the effect changes nothing.
    pub neutral: f64,
    /// Lowest value allowed.
    pub min: f64,
    /// Highest value allowed.
    pub max: f64,
    /// How far from neutral a fit starts, in parts of
    /// [`RecordRange::size`] of its dimension.
    pub typical: f64,
    /// Lowest and highest value that physics allows, in parts of [`RecordRange::size`] of its
    /// dimension: a fit may go beyond, and is then not believed.
    #[serde(skip)]
    pub plausible: (f64, f64),
    /// Whether a fit may change it. If not it is a choice, such as a reference angle,
    /// and stays where the start put it.
    pub fitted: bool,
}

impl Parameter {
    /// A parameter that is neutral at zero, without limits.
    pub const fn new(name: &'static str, meaning: &'static str, dimension: Dimension) -> Self {
        let (min, max) = (-UNLIMITED, UNLIMITED);
        let plausible = (f64::NEG_INFINITY, f64::INFINITY);
        let (neutral, typical, fitted) = (0.0, 0.1, true);
        Self { name, meaning, dimension, neutral, min, max, typical, plausible, fitted }
    }

    /// This parameter with values from `min` to `max`.
    #[must_use]
    pub const fn between(self, min: f64, max: f64) -> Self {
        Self { min, max, ..self }
    }

    /// This parameter, neutral at `neutral`.
    #[must_use]
    pub const fn neutral(self, neutral: f64) -> Self {
        Self { neutral, ..self }
    }

    /// This parameter with another distance from neutral to start a fit at.
    #[must_use]
    pub const fn typical(self, typical: f64) -> Self {
        Self { typical, ..self }
    }

    /// This parameter with values from `low` to `high` alone [plausible](Self::plausible).
    #[must_use]
    pub const fn plausible(self, low: f64, high: f64) -> Self {
        Self { plausible: (low, high), ..self }
    }

    /// Whether `value` is plausible on a record of this size.
    pub fn allows(&self, value: f64, record: &RecordRange<'_>) -> bool {
        let (low, high) = self.plausible;
        let part = value / record.size(self.dimension);
        is_unlimited(value) || (low..=high).contains(&part)
    }

    /// This parameter as a choice, which a fit leaves alone.
    #[must_use]
    pub const fn not_fitted(self) -> Self {
        Self { fitted: false, ..self }
    }

    /// Its own limits, narrowed to what a record of this size can distinguish.
    pub fn bounds(&self, record: &RecordRange<'_>) -> (f64, f64) {
        let (low, high) = record.extent(self.dimension);
        let (low, high) = (low.max(self.min), high.min(self.max));
        if low < high { (low, high) } else { (self.min, self.max) }
    }

    /// Neutral plus a typical distance, within its bounds.
    pub fn start(&self, record: &RecordRange<'_>) -> f64 {
        let (low, high) = self.bounds(record);
        (self.neutral + self.typical * record.size(self.dimension)).max(low).min(high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_number_stands_for_no_limit() {
        assert!([UNLIMITED, -UNLIMITED].into_iter().all(is_unlimited));
        assert!(![0.0, 5e13, -5e13, f64::NAN].into_iter().any(is_unlimited));
    }

    #[test]
    fn bounds_are_as_wide_as_the_record_but_within_the_own_limits() {
        let record = RecordRange { input_abs_max: 5.0, ..RecordRange::default() };
        let parameter = Parameter::new("upper", "", Dimension::Input).between(0.0, UNLIMITED);
        assert_eq!(parameter.bounds(&record), (0.0, 5.0));
        assert!((parameter.start(&record) - 0.5).abs() < 1e-12);
        assert_eq!(parameter.typical(9.0).start(&record).to_bits(), 5.0_f64.to_bits());
    }
}
