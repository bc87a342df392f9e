//! A delay that depends on the step of the input and on what came before it.
//!
//! ```text
//! extra = size · f(|after − before|, size_scale) + falling · [after < before]
//!         + dwell · f(held, dwell_scale) + drift · f(t, drift_scale)
//! f(x, s) = s · (1 − exp(−x / s)): x where s is much larger, s where it is much smaller
//! ```
//!
//! with `held` the seconds the level before was held, and `t` the time of the step in
//! the record. It is added to the joint's delay; the whole is kept at zero or above.
//!
//! A small step opens the valve less, so that pressure builds up later (`size` below 0);
//! beyond `size_scale` a larger step gains nothing. The two directions have other loads
//! and volumes. Static friction rises with the time at rest, and is at its height after
//! some `dwell_scale`. Oil thins as it warms, and is warm after some `drift_scale`.
//! With `per_step` at 1 the law does nothing, and each step has the delay that was measured
//! of it: what sets the delays may then be anything, and need not be known. So many numbers
//! are as many parameters; where the law does as well, it is the better explanation.
//!
//! The scales are neutral at 1e12, where `f` is a straight line.
//!
//! # References
//! Armstrong-Hélouvry, B., Dupont, P., and Canudas de Wit, C., 1994, A survey of models,
//! analysis tools and compensation methods for the control of machines with friction,
//! Automatica 30 (rising static friction); Merritt, H. E., 1967, Hydraulic Control
//! Systems (compressed volumes, viscosity).

use std::borrow::Cow;

use super::{
    Dimension, Effect, Equations, InputChange, Moment, Parameter, RecordRange, Spec, Stage,
    UNLIMITED,
};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct VariableDelay;

static SPEC: Spec = Spec::new(
    "variable_delay",
    Stage::Transport,
    "the delay depends on step size, direction, dwell and time",
)
.equation(
    "extra = size f(abs(after - before), size_scale) + falling [after < before] + \
               dwell f(held, dwell_scale) + drift f(t, drift_scale); f(x, s) = s (1 - exp(-x / s))",
)
.source(
    "Armstrong-Hélouvry, Dupont and Canudas de Wit, 1994, A survey of models, analysis \
             tools and compensation methods for the control of machines with friction, \
             Automatica 30; Merritt, 1967, Hydraulic Control Systems",
)
.parameters(&[
    Parameter::new("size", "extra delay per size of the step", Dimension::SecondsPerInput)
        .between(-UNLIMITED, UNLIMITED)
        .typical(-0.05),
    Parameter::new("falling", "extra delay of a step downward", Dimension::Seconds)
        .between(-10.0, 10.0)
        .typical(0.02),
    Parameter::new("dwell", "extra delay per second at the level before", Dimension::One)
        .between(-1.0, 1.0)
        .typical(0.01),
    Parameter::new("drift", "extra delay per second at the start", Dimension::One)
        .between(-0.1, 0.1)
        .typical(0.0),
    Parameter::new("size_scale", "size of a step beyond which it gains little", Dimension::Input)
        .between(0.0, UNLIMITED)
        .neutral(UNLIMITED),
    Parameter::new("dwell_scale", "hold beyond which it gains little", Dimension::Seconds)
        .between(0.0, UNLIMITED)
        .neutral(UNLIMITED),
    Parameter::new("drift_scale", "time after which it drifts little", Dimension::Seconds)
        .between(0.0, UNLIMITED)
        .neutral(UNLIMITED),
    Parameter::new(PER_STEP, "1: the delay of each step as it was measured", Dimension::One)
        .between(0.0, 1.0)
        .typical(0.0)
        .not_fitted(),
])
.confused_with(&["actuator_lag", "rate_limit"])
.equations(Equations::new(&["size_s = max(size_scale, 1e-300)
             dwell_s = max(dwell_scale, 1e-300)
             drift_s = max(drift_scale, 1e-300)
             grown = -size * size_s * expm1(-abs(after - before) / size_s)
             rested = -dwell * dwell_s * expm1(-held / dwell_s)
             drifted = -drift * drift_s * expm1(-time / drift_s)
             out = grown + if(after < before, falling, 0) + rested + drifted"]));

impl Effect for VariableDelay {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// Names what its law depends on.
    fn summary(&self, parameters: &[f64]) -> Cow<'static, str> {
        if self.takes_measured_delays(parameters) {
            return "the delay of each step as it was measured".into();
        }
        let names = ["step size", "direction", "dwell", "time"];
        let acting = names.iter().zip(parameters).filter(|(_, value)| **value != 0.0);
        match acting.map(|(name, _)| *name).collect::<Vec<_>>().as_slice() {
            [] => SPEC.summary.into(),
            [before @ .., last] if !before.is_empty() => {
                format!("the delay depends on {} and {last}", before.join(", ")).into()
            }
            one => format!("the delay depends on {}", one.concat()).into(),
        }
    }

    fn depends_on_steps(&self) -> bool {
        true
    }

    /// The signal itself: this effect acts on time only.
    fn step(&self, _parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        at.signal
    }

    fn extra_delay_s(&self, parameters: &[f64], change: &InputChange) -> f64 {
        let &[size, falling, dwell, drift, size_scale, dwell_scale, drift_scale, _] = parameters
        else {
            return 0.0;
        };
        let InputChange { before, after, held_s, time_s } = *change;
        let direction = if after < before { falling } else { 0.0 };
        let grown = size * saturated((after - before).abs(), size_scale);
        let rested = dwell * saturated(held_s, dwell_scale);
        grown + direction + rested + drift * saturated(time_s, drift_scale)
    }

    fn measured_delays(&self) -> Option<Vec<f64>> {
        let parameters = SPEC.parameters.iter();
        Some(parameters.map(|p| if p.name == PER_STEP { 1.0 } else { p.neutral }).collect())
    }

    fn takes_measured_delays(&self, parameters: &[f64]) -> bool {
        parameters.last().is_some_and(|per_step| *per_step >= 0.5)
    }

    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        let mut bounds: Vec<_> = SPEC.parameters.iter().map(|each| each.bounds(record)).collect();
        let scales = typical_scales(record);
        let (low, high) = FITTED_SCALES;
        for (bounds, scale) in bounds[SCALES].iter_mut().zip(scales) {
            *bounds = (low * scale, high * scale);
        }
        bounds
    }

    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let mut start: Vec<_> = SPEC.parameters.iter().map(|each| each.start(record)).collect();
        let scales = typical_scales(record);
        for (start, scale) in start[SCALES].iter_mut().zip(scales) {
            *start = 2.0 * scale;
        }
        vec![start]
    }
}

/// Places of the three scales among the parameters.
const SCALES: std::ops::Range<usize> = 4..7;

/// The last parameter.
const PER_STEP: &str = "per_step";

/// Range of the scales in a fit, in parts of what is typical: from what can still be distinguished
/// from a constant to what is straight to some percent.
const FITTED_SCALES: (f64, f64) = (0.3, 20.0);

/// A hold that is long, in seconds.
const LONG_HOLD_S: f64 = 5.0;

/// The three scales: the largest input, a long hold, the length of the record.
fn typical_scales(record: &RecordRange<'_>) -> [f64; 3] {
    let (_, length_s) = record.extent(Dimension::Seconds);
    [record.size(Dimension::Input), LONG_HOLD_S, length_s]
}

/// The parameters of the law that knows the size of a step and its direction alone.
pub(crate) fn by_step(size: f64, falling_s: f64, size_scale: f64) -> Vec<f64> {
    vec![size, falling_s, 0.0, 0.0, size_scale, UNLIMITED, UNLIMITED, 0.0]
}

/// `scale · (1 − exp(−x / scale))`.
pub(crate) fn saturated(x: f64, scale: f64) -> f64 {
    let scale = scale.max(f64::MIN_POSITIVE);
    -scale * (-x / scale).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_where_bounds_and_guesses_take_them_to_be() {
        assert!(SPEC.parameters[SCALES].iter().all(|p| p.name.ends_with("_scale")));
        let others = SPEC.parameters[..SCALES.start].iter().chain(&SPEC.parameters[SCALES.end..]);
        assert!(others.clone().all(|p| !p.name.ends_with("_scale")));
    }

    #[test]
    fn size_direction_dwell_and_time_each_add_their_part() {
        let parameters = [-0.01, 0.02, 0.005, 0.001, UNLIMITED, UNLIMITED, UNLIMITED, 0.0];
        let extra = |change| VariableDelay.extra_delay_s(&parameters, &change);
        let rising = InputChange { before: -1.0, after: 2.0, held_s: 4.0, time_s: 50.0 };
        assert!((extra(rising) - (-0.03 + 0.02 + 0.05)).abs() < 1e-11);
        let falling = InputChange { before: 2.0, after: -1.0, held_s: 0.0, time_s: 0.0 };
        assert!((extra(falling) - (-0.03 + 0.02)).abs() < 1e-12);
    }

    #[test]
    fn a_fit_of_the_law_takes_no_measured_delays() {
        let levels = [1.0, 2.0];
        let record = RecordRange {
            input_neutral: 0.0,
            input_abs_max: 2.0,
            input_span: 4.0,
            input_levels: &levels,
            output_min: -10.0,
            output_max: 10.0,
            speed_abs_max: 20.0,
            duration_s: 60.0,
            sample_period_s: 0.01,
            radians_per_output_unit: 1.0,
            ripple_period: None,
            signals: &[],
        };
        for start in VariableDelay.starts(&record) {
            assert_eq!(start.last(), Some(&0.0));
            assert_eq!(start[4..7], [4.0, 10.0, 120.0]);
        }
    }

    #[test]
    fn measured_delays_take_the_place_of_the_law() {
        let measured = VariableDelay.measured_delays().unwrap();
        assert!(VariableDelay.takes_measured_delays(&measured));
        let neutral: Vec<f64> = SPEC.parameters.iter().map(|p| p.neutral).collect();
        assert!(!VariableDelay.takes_measured_delays(&neutral));
        let change = InputChange { before: 0.0, after: 3.0, held_s: 6.0, time_s: 200.0 };
        assert!(VariableDelay.extra_delay_s(&measured, &change).abs() < 1e-300);
    }

    #[test]
    fn size_dwell_and_time_gain_little_beyond_their_scales() {
        let parameters = [-0.01, 0.0, 0.02, 0.001, 1.5, 2.0, 50.0, 0.0];
        let change = InputChange { before: 0.0, after: 3.0, held_s: 6.0, time_s: 200.0 };
        let expected = -0.01 * 1.5 * (1.0 - (-2_f64).exp())
            + 0.02 * 2.0 * (1.0 - (-3_f64).exp())
            + 0.001 * 50.0 * (1.0 - (-4_f64).exp());
        assert!((VariableDelay.extra_delay_s(&parameters, &change) - expected).abs() < 1e-15);
    }
}
