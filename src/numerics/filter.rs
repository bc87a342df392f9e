//! Zero-phase low-pass filter: it smooths without adding a delay of its own.

use serde::Serialize;

use crate::units::SamplePeriod;
use sci_rs::signal::filter::design::{
    DigitalFilter, FilterBandType, FilterOutputType, Sos, butter_dyn,
};
use sci_rs::signal::filter::{sosfilt_dyn, sosfilt_zi_dyn};

/// A Butterworth low-pass, to be run forward and backward over a signal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LowPass {
    /// Frequency in Hz at which one pass damps to 1/√2 (and two passes to 1/2).
    pub cutoff_hz: f64,
    /// Order of one pass.
    pub order: usize,
}

/// Highest order that is designed; above it the design itself is badly conditioned.
pub const MAX_ORDER: usize = 12;

/// Lowest cutoff, as a part of the Nyquist frequency: at order 4 a constant then still
/// passes to 1e-9 of its value, and below it the digits go fast.
const LOWEST_CUTOFF: f64 = 1e-4;

/// Why a [`LowPass`] cannot be designed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FilterError {
    /// The cutoff is at or above half the sample rate.
    #[error("a passband of {cutoff_hz} Hz is not below the Nyquist frequency of {nyquist_hz} Hz")]
    AboveNyquist {
        /// What was asked for.
        cutoff_hz: f64,
        /// Half the sample rate.
        nyquist_hz: f64,
    },
    /// The cutoff is so low that the filter cannot be computed with enough digits.
    #[error(
        "a passband of {cutoff_hz:e} Hz is too low for this sample rate; choose {lowest_hz:e} Hz \
         or more"
    )]
    TooLow {
        /// What was asked for.
        cutoff_hz: f64,
        /// The lowest that can be computed at this sample rate.
        lowest_hz: f64,
    },
    /// The cutoff is not a positive number.
    #[error("a passband of {cutoff_hz} Hz is not above zero")]
    NotPositive {
        /// What was asked for.
        cutoff_hz: f64,
    },
    /// The order is zero or too high.
    #[error("a filter order of {order} is not between 1 and {MAX_ORDER}")]
    Order {
        /// What was asked for.
        order: usize,
    },
}

impl LowPass {
    /// Smooths `signal`, sampled every `period`, without shifting it in time.
    ///
    /// Equals SciPy's `sosfiltfilt(butter(order, cutoff_hz, fs=1/period, output="sos"),
    /// signal)`: second-order sections, run forward and backward from their steady
    /// state, over the signal extended at both ends by its point reflection ("odd
    /// padding"). A signal shorter than that extension, which SciPy refuses, is extended
    /// by as much as it has.
    ///
    /// # Errors
    /// [`FilterError`] when the cutoff or the order is out of range.
    pub fn smooth(&self, signal: &[f64], period: SamplePeriod) -> Result<Vec<f64>, FilterError> {
        let mut sections = self.design(period)?;
        let Some(&offset) = signal.first() else {
            return Ok(Vec::new());
        };
        let samples = signal.len();
        // As in `sosfiltfilt`: odd extension, forward from the steady state, backward, and the
        // extension off again.
        let pad = padding(&sections).min(samples - 1);
        sosfilt_zi_dyn::<_, _, Sos<f64>>(sections.iter_mut());
        let mut smoothed = extend_odd(signal, pad, offset);
        for _ in 0..2 {
            smoothed = one_pass(&sections, &smoothed);
            smoothed.reverse();
        }
        Ok(smoothed[pad..pad + samples].iter().map(|value| value + offset).collect())
    }

    /// How many of the last samples of a growing signal are smoothed to something else when
    /// it grows: before them the change is below a millionth of the signal's span.
    ///
    /// The end acts through the backward pass, whose slowest pole sets how soon it is
    /// forgotten.
    ///
    /// # Errors
    /// [`FilterError`] when the cutoff or the order is out of range.
    pub fn reach(&self, period: SamplePeriod) -> Result<usize, FilterError> {
        /// Part that remains of the end: below a millionth, poles of several sections
        /// acting together.
        const LEFT: f64 = 1e-8;
        let sections = self.design(period)?;
        let slowest = sections.iter().map(pole_radius).fold(0.0, f64::max);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "above zero")]
        // |p|^n = LEFT, with p the slowest pole.
        let samples = (LEFT.ln() / slowest.max(f64::MIN_POSITIVE).ln()).ceil() as usize;
        Ok(samples + padding(&sections))
    }

    fn design(&self, period: SamplePeriod) -> Result<Vec<Sos<f64>>, FilterError> {
        let Self { cutoff_hz, order } = *self;
        if !(1..=MAX_ORDER).contains(&order) {
            return Err(FilterError::Order { order });
        }
        if !(cutoff_hz.is_finite() && cutoff_hz > 0.0) {
            return Err(FilterError::NotPositive { cutoff_hz });
        }
        let nyquist_hz = period.nyquist_hz();
        if cutoff_hz >= nyquist_hz {
            return Err(FilterError::AboveNyquist { cutoff_hz, nyquist_hz });
        }
        let lowest_hz = LOWEST_CUTOFF * nyquist_hz;
        if cutoff_hz < lowest_hz || !nyquist_hz.is_finite() {
            return Err(FilterError::TooLow { cutoff_hz, lowest_hz });
        }
        let filter = butter_dyn(
            order,
            vec![cutoff_hz],
            Some(FilterBandType::Lowpass),
            Some(false),
            Some(FilterOutputType::Sos),
            Some(1.0 / period.seconds()),
        );
        match filter {
            DigitalFilter::Sos(filter) => Ok(filter.sos),
            DigitalFilter::Ba(_) | DigitalFilter::Zpk(_) => Err(FilterError::Order { order }),
        }
    }
}

/// Distance from zero of the farther pole of `section`: of z² + a₁ z + a₂.
fn pole_radius(section: &Sos<f64>) -> f64 {
    let [_, a1, a2] = section.a;
    let discriminant = a1 * a1 - 4.0 * a2;
    if discriminant < 0.0 { a2.sqrt() } else { f64::midpoint(a1.abs(), discriminant.sqrt()) }
}

/// Length of the extension at each end: three times the number of taps, as in SciPy.
fn padding(sections: &[Sos<f64>]) -> usize {
    let zeros_at_origin = sections.iter().filter(|section| section.b[2] == 0.0).count();
    let poles_at_origin = sections.iter().filter(|section| section.a[2] == 0.0).count();
    3 * (2 * sections.len() + 1 - zeros_at_origin.min(poles_at_origin))
}

/// `signal − offset`, extended by its point reflection at both ends.
///
/// Taking the offset off keeps the digits of a joint that is at 1e6 degrees.
fn extend_odd(signal: &[f64], pad: usize, offset: f64) -> Vec<f64> {
    let first = signal.first().copied().unwrap_or_default();
    let last = signal.last().copied().unwrap_or_default();
    let head = signal.iter().skip(1).take(pad).rev().map(|value| 2.0 * first - value);
    let tail = signal.iter().rev().skip(1).take(pad).map(|value| 2.0 * last - value);
    head.chain(signal.iter().copied()).chain(tail).map(|value| value - offset).collect()
}

/// One run of the sections over `signal`, from the steady state at the first value.
fn one_pass(sections: &[Sos<f64>], signal: &[f64]) -> Vec<f64> {
    let first = signal.first().copied().unwrap_or_default();
    let mut sections = sections.to_vec();
    for section in &mut sections {
        section.zi0 *= first;
        section.zi1 *= first;
    }
    sosfilt_dyn(signal.iter(), &mut sections)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn period() -> SamplePeriod {
        SamplePeriod::from_seconds(0.01).unwrap()
    }

    const DEFAULT: LowPass = LowPass { cutoff_hz: 5.0, order: 4 };

    #[test]
    fn what_comes_later_changes_nothing_before_its_reach() {
        // A joint that swings to and fro, and stops in the middle of a motion.
        let signal: Vec<f64> = (0..1200)
            .map(|k| (f64::from(k) * 0.05).sin() + (f64::from(k % 90) - 45.0).abs() * 0.2)
            .collect();
        for (cutoff_hz, order) in [(5.0, 4), (5.0, 1), (2.0, 4), (20.0, 8), (1.0, 2)] {
            let low_pass = LowPass { cutoff_hz, order };
            let whole = low_pass.smooth(&signal, period()).unwrap();
            let reach = low_pass.reach(period()).unwrap();
            for end in [700, 755, 800, 833] {
                let part = low_pass.smooth(&signal[..end], period()).unwrap();
                let change = |k: usize| (part[k] - whole[k]).abs();
                let settled = (0..end - reach).map(change).fold(0.0, f64::max);
                assert!(settled < 1e-6 * 10.0, "{low_pass:?}, {end}: {settled}");
                // It is no longer than needed by much.
                let close = (end - reach / 2..end).map(change).fold(0.0, f64::max);
                assert!(close > 1e-6 * 10.0, "{low_pass:?}, {end}: {close}");
            }
        }
    }

    #[test]
    fn a_straight_line_passes_unchanged_but_for_its_ends() {
        let line: Vec<f64> = (0..300).map(|k| 1e6 + 0.3 * f64::from(k)).collect();
        let smooth = DEFAULT.smooth(&line, period()).unwrap();
        for (a, b) in line.iter().zip(&smooth).skip(120).take(60) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }

    #[test]
    fn a_symmetric_kink_stays_where_it_is() {
        let kink: Vec<f64> = (0..401).map(|k| f64::from((k - 200i32).abs())).collect();
        let smooth = DEFAULT.smooth(&kink, period()).unwrap();
        let lowest = smooth.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).unwrap().0;
        assert_eq!(lowest, 200);
    }

    #[test]
    fn short_signals_are_filtered_too() {
        for length in 0..20 {
            let signal = vec![2.5; length];
            let smooth = DEFAULT.smooth(&signal, period()).unwrap();
            assert_eq!(smooth.len(), length);
            assert!(smooth.iter().all(|value| (value - 2.5).abs() < 1e-12));
        }
    }

    #[test]
    fn at_the_lowest_cutoff_a_ramp_is_not_shifted() {
        let ramp: Vec<f64> = (0..20_000).map(f64::from).collect();
        let lowest = LowPass { cutoff_hz: 50.0 * LOWEST_CUTOFF, order: 4 };
        let smooth = lowest.smooth(&ramp, period()).unwrap();
        assert!(smooth.iter().all(|value| value.is_finite() && value.abs() < 30_000.0));
        let constant = lowest.smooth(&vec![1e6; 20_000], period()).unwrap();
        assert!(constant.iter().all(|value| (value - 1e6).abs() < 1e-3));
    }

    #[test]
    fn what_cannot_be_designed_says_why() {
        let smooth = |cutoff_hz, order| LowPass { cutoff_hz, order }.smooth(&[1.0], period());
        assert!(matches!(smooth(50.0, 4), Err(FilterError::AboveNyquist { .. })));
        assert!(matches!(smooth(1e-9, 4), Err(FilterError::TooLow { .. })));
        assert!(matches!(smooth(0.0, 4), Err(FilterError::NotPositive { .. })));
        assert!(matches!(smooth(f64::NAN, 4), Err(FilterError::NotPositive { .. })));
        assert!(matches!(smooth(5.0, 0), Err(FilterError::Order { .. })));
        assert!(smooth(5.0, MAX_ORDER).is_ok());
    }
}
