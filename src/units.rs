//! Scalars that are valid once they exist.

use std::fmt;

use serde::Serialize;

/// Radians in one unit of an angle; a degree unless the unit says otherwise.
pub(crate) fn radians_in(unit: Option<&str>) -> f64 {
    match unit {
        Some("rad") => 1.0,
        Some("mrad") => 1e-3,
        Some("rev" | "turn") => std::f64::consts::TAU,
        _ => 1_f64.to_radians(),
    }
}

/// Seconds between two samples: finite and greater than zero.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize)]
#[serde(transparent)]
pub struct SamplePeriod(f64);

impl SamplePeriod {
    /// The period of `seconds`, or `None` unless it is finite and positive.
    pub fn from_seconds(seconds: f64) -> Option<Self> {
        (seconds.is_finite() && seconds > 0.0).then_some(Self(seconds))
    }

    /// The period in seconds.
    pub fn seconds(self) -> f64 {
        self.0
    }

    /// Half the sample rate in Hz: nothing above it can be distinguished.
    pub(crate) fn nyquist_hz(self) -> f64 {
        0.5 / self.0
    }
}

impl fmt::Display for SamplePeriod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} s", self.0)
    }
}

/// A length of time as it was given: in samples, or in seconds, which are other numbers of samples
/// at other sample periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// So many samples.
    Samples(usize),
    /// So many seconds.
    Seconds(f64),
}

impl Length {
    /// The samples that come nearest, `period` apart.
    pub fn samples(self, period: SamplePeriod) -> usize {
        match self {
            Self::Samples(samples) => samples,
            Self::Seconds(seconds) => floor_to_index((seconds / period.seconds()).round()),
        }
    }
}

impl From<usize> for Length {
    fn from(samples: usize) -> Self {
        Self::Samples(samples)
    }
}

impl fmt::Display for Length {
    /// As it is typed: `50`, or `0.5s`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Samples(samples) => write!(f, "{samples}"),
            Self::Seconds(seconds) => write!(f, "{seconds}s"),
        }
    }
}

/// A number of samples, for differences that may be negative.
pub(crate) fn signed(samples: usize) -> i64 {
    i64::try_from(samples).unwrap_or(i64::MAX)
}

/// The whole samples in `value`; 0 for what is negative or no number.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates")]
pub(crate) fn floor_to_index(value: f64) -> usize {
    value.max(0.0) as usize
}

/// The first sample that is not before `value`; 0 for what is negative or no number.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates")]
pub(crate) fn ceil_to_index(value: f64) -> usize {
    value.ceil().max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_is_no_period() {
        for seconds in [0.0, -0.01, f64::NAN, f64::INFINITY] {
            assert_eq!(SamplePeriod::from_seconds(seconds), None);
        }
    }

    #[test]
    fn a_length_in_seconds_is_another_number_of_samples_at_another_rate() {
        let samples =
            |length: Length, period| length.samples(SamplePeriod::from_seconds(period).unwrap());
        let half = Length::Seconds(0.5);
        assert_eq!([0.01, 0.02, 1.2].map(|period| samples(half, period)), [50, 25, 0]);
        assert_eq!(samples(Length::Samples(7), 0.02), 7);
        assert_eq!([half, 7.into()].map(|length| length.to_string()), ["0.5s", "7"]);
    }

    #[test]
    fn nyquist_is_half_the_rate() {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        assert!((period.nyquist_hz() - 50.0).abs() < 1e-12);
    }
}
