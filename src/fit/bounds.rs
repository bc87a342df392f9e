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
const MARGIN: f64 = 1e-5;

/// Standard errors by which a value may miss a bound and still be on it: less than anyone
/// can tell.
const ON_BOUND: f64 = 0.02;

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

    /// Whether `value` lies on a bound, as far as its standard error allows to say.
    pub(super) fn is_at(self, value: f64, std_error: f64) -> bool {
        let room = (ON_BOUND * std_error).max(f64::EPSILON * (self.high - self.low));
        self.is_bounded() && self.distance(value) <= room
    }

    /// From `value` to the nearest bound.
    fn distance(self, value: f64) -> f64 {
        (value - self.low).min(self.high - value)
    }

    /// Whether a descent has ended at a bound: `free` is on it, and the error falls beyond.
    ///
    /// `error_slope` is the slope of half the squared error to `free`, `std_error` the
    /// standard error of `free` by itself.
    pub(super) fn stops(self, free: f64, error_slope: f64, std_error: f64) -> bool {
        let (value, slope) = (self.value(free), 0.5 * (self.high - self.low) * free.cos());
        let downhill = -error_slope * slope;
        let outward = if value - self.low < self.high - value { -downhill } else { downhill };
        outward > 0.0 && self.is_at(value, 0.5 * std_error * slope.abs())
    }

    /// Two values on either side of `value` for a difference, within the bounds.
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
        assert!(bounds.is_at(5.0, 0.0) && !bounds.is_at(4.9, 1.0) && bounds.is_at(4.9, 10.0));
    }

    #[test]
    fn a_descent_stops_at_a_bound_beyond_which_the_error_falls() {
        let bounds = Bounds { low: 0.0, high: 10.0 };
        let near_low = bounds.free(0.0);
        assert!(bounds.stops(near_low, 1.0, 10.0) && !bounds.stops(near_low, -1.0, 10.0));
        assert!(!bounds.stops(near_low, 1.0, 1e-6) && !bounds.stops(0.0, 1.0, 1.0));
        assert!(bounds.stops(bounds.free(10.0), -1.0, 10.0));
    }

    #[test]
    fn without_bounds_nothing_changes() {
        let bounds = Bounds { low: f64::MIN, high: f64::MAX };
        assert!((bounds.value(bounds.free(1e7)) - 1e7).abs() < 1e-300);
        assert!(!bounds.is_at(f64::MAX, 1.0));
    }
}
