//! A gain that depends on a measured signal: the pressure of the supply or of the load, the force
//! on the joint, the temperature of the oil.
//!
//! ```text
//! out = in · max(1 + positive · (s − reference), 0.05)   where in > 0
//! out = in · max(1 + negative · (s − reference), 0.05)   where in < 0
//! ```
//!
//! `s` is a further column of the joint in the log. The flow of a valve, `√((p_s ± p_L) / ρ)`, is
//! linear in either pressure as long as that changes little: a higher pressure of the supply makes
//! both directions faster, and that of the load one faster and the other slower. The gain of the
//! joint is that at `reference`, which is a choice and not fitted: zero where the signal has both
//! signs, as a force has, so that the two directions differ by nothing else; else the middle of the
//! signal. Where the signal was not measured, the effect does nothing.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems, section 5.2 (flow gain and load pressure).

use super::interned::{Interned, part_of_interned, text_of_interned};
use super::{Dimension, Effect, Moment, Parameter, RecordRange, Spec, Stage};

/// Of any signal: without a name it is not in the catalogue.
static SPEC: Spec = Spec::new("signal_gain", Stage::Load, "the gain depends on a measured signal")
    .equation("out = in (1 + (in > 0 ? positive : negative) (s - reference))")
    .source("Merritt, 1967, Hydraulic Control Systems, section 5.2")
    .parameters(&[
        Parameter::new("positive", "change of a positive speed with the signal", PER_SIGNAL),
        Parameter::new("negative", "change of a negative speed with the signal", PER_SIGNAL),
        Parameter::new(
            "reference",
            "signal at which the gain is that of the joint",
            Dimension::Signal,
        )
        .not_fitted(),
    ]);

const PER_SIGNAL: Dimension = Dimension::PerSignal;

/// Smallest factor that is left of the gain.
const SMALLEST_FACTOR: f64 = 0.05;

#[derive(Debug)]
struct SignalGain {
    signal: String,
    spec: &'static Spec,
}

/// The effect of the signal with this name, with an id of its own: `signal_gain[pressure]`.
///
/// # Examples
/// ```
/// use tauscope::effect::signal_gain;
///
/// let supply = signal_gain("supply_pressure");
/// assert_eq!(supply.spec().id, "signal_gain[supply_pressure]");
/// assert_eq!(supply.measured_signal(), Some("supply_pressure"));
/// ```
pub fn signal_gain(signal: &str) -> &'static dyn Effect {
    static KNOWN: Interned<SignalGain> = Interned::none();
    KNOWN.get_or_make(signal, |one, signal| one.signal == *signal, SignalGain::new)
}

/// Whether `id` is that of the effect without its signal.
pub(super) fn is_signal_gain(id: &str) -> bool {
    id == SPEC.id
}

impl SignalGain {
    fn new(signal: &str) -> Self {
        let spec = Spec {
            id: text_of_interned(format!("{}[{signal}]", SPEC.id)),
            summary: text_of_interned(format!("the gain depends on the measured `{signal}`")),
            ..SPEC.clone()
        };
        Self { signal: signal.to_owned(), spec: part_of_interned(spec) }
    }
}

impl Effect for SignalGain {
    fn spec(&self) -> &'static Spec {
        self.spec
    }

    fn measured_signal(&self) -> Option<&str> {
        Some(&self.signal)
    }

    fn depends_on_angle(&self) -> bool {
        false
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[positive, negative, reference] = parameters else { return at.signal };
        if !at.measured.is_finite() {
            return at.signal;
        }
        let change = if at.signal > 0.0 { positive } else { negative };
        at.signal * (1.0 + change * (at.measured - reference)).max(SMALLEST_FACTOR)
    }

    /// So that the gain stays above the floor within the signal's range.
    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let most = (1.0 - SMALLEST_FACTOR) / record.signal(&self.signal).half();
        let all = self.spec.parameters.iter().map(|p| (p.min, p.max));
        all.zip([(-most, most), (-most, most), (f64::MIN, f64::MAX)])
            .map(|((min, max), (low, high))| (low.max(min), high.min(max)))
            .collect()
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        /// Part of the speed that changes from the middle of the signal to its end.
        const TYPICAL: f64 = 0.1;
        let signal = record.signal(&self.signal);
        let slope = TYPICAL / signal.half();
        let has_both_signs = signal.min < 0.0 && signal.max > 0.0;
        let reference = if has_both_signs { 0.0 } else { signal.middle() };
        vec![vec![slope, slope, reference], vec![slope, -slope, reference]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, moment};
    use super::*;
    use crate::effect::contract::check;

    #[test]
    fn the_gain_follows_the_signal_in_each_direction_by_itself() {
        let speed = |signal, measured| {
            let at = Moment { measured, ..moment(signal) };
            signal_gain("p").step(&[0.01, -0.002, 100.0], &mut [], &at)
        };
        assert_close(&[100.0, 150.0, 0.0].map(|p| speed(4.0, p)), &[4.0, 6.0, 0.2]);
        assert_close(&[100.0, 150.0, 0.0].map(|p| speed(-4.0, p)), &[-4.0, -3.6, -4.8]);
        assert_close(&[speed(4.0, f64::NAN)], &[4.0]);
    }

    #[test]
    fn it_keeps_the_contract_and_is_there_once() {
        assert_eq!(check(signal_gain("p_load")), Ok(()));
        assert!(std::ptr::eq(signal_gain("p_load").spec(), signal_gain("p_load").spec()));
    }
}
