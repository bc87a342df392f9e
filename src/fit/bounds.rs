//! Lowest and highest values of the parameters of a fit.

/// Lowest and highest value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) low: f64,
    pub(super) high: f64,
}

/// Beyond this, a bound is none.
const FAR: f64 = 1e9;

/// Standard errors by which a value may miss a bound and still be on it: less than anyone
/// can tell.
const ON_BOUND: f64 = 0.02;

/// The part of the way between two bounds by which a value may miss one, whatever its standard
/// error: no record determines it so well, but the slope at a corner may look as if it did. Of a
/// delay 5 µs.
const NEAREST: f64 = 1e-6;

impl Bounds {
    fn is_bounded(self) -> bool {
        self.low > -FAR && self.high < FAR && self.low < self.high
    }

    /// The nearest value within.
    pub(super) fn clamped(self, value: f64) -> f64 {
        value.max(self.low).min(self.high)
    }

    /// These bounds, or `value` alone where it lies outside.
    pub(super) fn holding(self, value: f64) -> Self {
        if (self.low..=self.high).contains(&value) {
            self
        } else {
            Self { low: value, high: value }
        }
    }

    /// Whether a value that goes down (with a negative `change`) or up from `value` leaves them.
    pub(super) fn stop(self, value: f64, change: f64) -> bool {
        change < 0.0 && value <= self.low || change > 0.0 && value >= self.high
    }

    /// A small step from `value` for a difference, away from a bound it is at; 0 where there is
    /// no room.
    pub(super) fn step(self, value: f64) -> f64 {
        /// Large against rounding, small against what curves.
        const PART: f64 = 1e-6;
        let size = if self.is_bounded() { self.high - self.low } else { 0.1 };
        let step = PART * value.abs().max(0.01 * size);
        if value + step <= self.high {
            step
        } else if value - step >= self.low {
            -step
        } else {
            0.0
        }
    }

    /// Those of the sizes `values`, of either sign, that lie within.
    pub(super) fn within(self, values: &[f64]) -> Vec<f64> {
        let signed = values.iter().rev().map(|value| -value).chain(values.iter().copied());
        signed.filter(|value| (self.low..=self.high).contains(value)).collect()
    }

    /// Whether `value` lies on a bound, as far as its standard error allows to say.
    pub(super) fn is_at(self, value: f64, std_error: f64) -> bool {
        let room = (ON_BOUND * std_error).max(NEAREST * (self.high - self.low));
        self.is_bounded() && self.distance(value) <= room
    }

    /// From `value` to the nearest bound.
    fn distance(self, value: f64) -> f64 {
        (value - self.low).min(self.high - value)
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
    fn values_stay_inside_and_steps_lead_inside() {
        let bounds = Bounds { low: -2.0, high: 5.0 };
        let clamped = [-9.0, 3.3, 9.0].map(|value| bounds.clamped(value).to_string());
        assert_eq!(clamped, ["-2", "3.3", "5"]);
        assert!(bounds.step(-2.0) > 0.0 && bounds.step(5.0) < 0.0);
        assert!(bounds.stop(5.0, 0.1) && !bounds.stop(5.0, -0.1) && bounds.stop(-2.0, -0.1));
        assert!(bounds.is_at(5.0, 0.0) && !bounds.is_at(4.9, 1.0) && bounds.is_at(4.9, 10.0));
    }

    #[test]
    fn a_value_outside_is_held() {
        let held = Bounds { low: 0.0, high: 10.0 }.holding(1e12);
        assert!(held.step(1e12) == 0.0 && held.stop(1e12, 1.0) && held.stop(1e12, -1.0));
        assert_eq!(Bounds { low: 0.0, high: 10.0 }.holding(3.0), Bounds { low: 0.0, high: 10.0 });
    }

    #[test]
    fn without_bounds_there_is_none_to_be_at() {
        let bounds = Bounds { low: f64::MIN, high: f64::MAX };
        assert!(!bounds.is_at(f64::MAX, 1.0) && bounds.step(1e7) > 0.0);
    }
}
