//! Bounds by a change of variable, so that the optimiser knows none.

/// Lowest and highest value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) low: f64,
    pub(super) high: f64,
}

/// Beyond this, a bound is none.
const FAR: f64 = 1e9;

/// How near to a bound, as a part of the range, a start may be: at the bound itself the
/// change of variable has no slope.
const MARGIN: f64 = 1e-3;

/// Part of the range by which a value may miss a bound and still be on it.
const ON_BOUND: f64 = 1e-4;

impl Bounds {
    fn is_bounded(self) -> bool {
        self.low > -FAR && self.high < FAR && self.low < self.high
    }

    /// The free variable of `value`: `value = low + (high − low)·(1 + sin x)/2`, or the
    /// value itself without bounds (as MINUIT does it: F. James, "MINUIT", CERN Program
    /// Library D506, section 1.2.1).
    pub(super) fn free(self, value: f64) -> f64 {
        if !self.is_bounded() {
            return value;
        }
        let part = (value - self.low) / (self.high - self.low);
        (2.0 * part.clamp(MARGIN, 1.0 - MARGIN) - 1.0).asin()
    }

    /// The value of a free variable.
    pub(super) fn value(self, free: f64) -> f64 {
        if !self.is_bounded() {
            return free;
        }
        self.low + (self.high - self.low) * f64::midpoint(1.0, free.sin())
    }

    /// Those of the sizes `values`, of either sign, that lie within.
    pub(super) fn within(self, values: &[f64]) -> Vec<f64> {
        let signed = values.iter().rev().map(|value| -value).chain(values.iter().copied());
        signed.filter(|value| (self.low..=self.high).contains(value)).collect()
    }

    /// Whether `value` lies on a bound.
    pub(super) fn is_at(self, value: f64) -> bool {
        let room = ON_BOUND * (self.high - self.low);
        self.is_bounded() && (value < self.low + room || value > self.high - room)
    }

    /// Two values about `value` for a difference, within the bounds.
    pub(super) fn around(self, value: f64) -> (f64, f64) {
        /// Large against rounding, small against what curves.
        const PART: f64 = 1e-5;
        let size = if self.is_bounded() { self.high - self.low } else { value.abs().max(1e-3) };
        let step = PART * size.min(value.abs().max(0.01 * size));
        ((value - step).max(self.low), (value + step).min(self.high))
    }

    /// Whether an error of this size leaves the value anywhere within the bounds.
    pub(super) fn is_lost_in(self, std_error: f64) -> bool {
        self.is_bounded() && std_error > 0.5 * (self.high - self.low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back_and_stay_inside() {
        let bounds = Bounds { low: -2.0, high: 5.0 };
        for value in [-1.9, 0.0, 3.3, 4.9] {
            assert!((bounds.value(bounds.free(value)) - value).abs() < 1e-12);
        }
        for free in [-100.0, -1.0, 0.3, 9.0] {
            assert!((-2.0..=5.0).contains(&bounds.value(free)));
        }
        assert!(bounds.is_at(5.0) && !bounds.is_at(4.9));
    }

    #[test]
    fn without_bounds_nothing_changes() {
        let bounds = Bounds { low: f64::MIN, high: f64::MAX };
        assert!((bounds.value(bounds.free(1e7)) - 1e7).abs() < 1e-300);
        assert!(!bounds.is_at(f64::MAX));
    }
}
