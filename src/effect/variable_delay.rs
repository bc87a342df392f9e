//! A delay that depends on the step of the input and on what came before it.
//!
//! ```text
//! extra = size · |after − before| + falling · [after < before] + dwell · held + drift · t
//! ```
//!
//! with `held` the seconds the level before was held, and `t` the time of the step in
//! the record. It is added to the joint's delay; the whole is kept at zero or above.
//!
//! Each term is the first order of a longer story. A small step opens the valve less, so
//! that pressure builds up later (`size` below 0). The two directions have other loads
//! and volumes. Static friction rises with the time at rest. Oil thins as it warms.
//! `dwell` is linear: for holds much longer than those it was fitted to it overstates.
//!
//! # References
//! Armstrong-Hélouvry, B., Dupont, P., and Canudas de Wit, C., 1994, A survey of models,
//! analysis tools and compensation methods for the control of machines with friction,
//! Automatica 30 (rising static friction); Merritt, H. E., 1967, Hydraulic Control
//! Systems (compressed volumes, viscosity).

use super::{Dimension, Effect, InputChange, Moment, Parameter, Spec, Stage, UNLIMITED};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct VariableDelay;

static SPEC: Spec = Spec {
    id: "variable_delay",
    summary: "the delay depends on step size, direction, dwell and time",
    equation: "extra = size abs(after - before) + falling [after < before] + dwell held + drift t",
    source: "Armstrong-Hélouvry, Dupont and Canudas de Wit, 1994, A survey of models, analysis \
             tools and compensation methods for the control of machines with friction, \
             Automatica 30; Merritt, 1967, Hydraulic Control Systems",
    stage: Stage::Transport,
    drawing: None,
    parameters: &[
        Parameter::new("size", "extra delay per size of the step", Dimension::SecondsPerInput)
            .between(-UNLIMITED, UNLIMITED)
            .typical(-0.05),
        Parameter::new("falling", "extra delay of a step downward", Dimension::Seconds)
            .between(-10.0, 10.0)
            .typical(0.02),
        Parameter::new("dwell", "extra delay per second at the level before", Dimension::One)
            .between(-1.0, 1.0)
            .typical(0.01),
        Parameter::new("drift", "extra delay per second of the record", Dimension::One)
            .between(-0.1, 0.1)
            .typical(0.0),
    ],
    memory: 0,
    confused_with: &["actuator_lag", "rate_limit"],
    absorbs: &[],
    acts_on_state: false,
};

impl Effect for VariableDelay {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The signal itself: this effect acts on time only.
    fn step(&self, _parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        at.signal
    }

    fn extra_delay_s(&self, parameters: &[f64], change: &InputChange) -> f64 {
        let &[size, falling, dwell, drift] = parameters else { return 0.0 };
        let InputChange { before, after, held_s, time_s } = *change;
        let direction = if after < before { falling } else { 0.0 };
        size * (after - before).abs() + direction + dwell * held_s + drift * time_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_direction_dwell_and_time_each_add_their_part() {
        let parameters = [-0.01, 0.02, 0.005, 0.001];
        let extra = |change| VariableDelay.extra_delay_s(&parameters, &change);
        let rising = InputChange { before: -1.0, after: 2.0, held_s: 4.0, time_s: 50.0 };
        assert!((extra(rising) - (-0.03 + 0.02 + 0.05)).abs() < 1e-15);
        let falling = InputChange { before: 2.0, after: -1.0, held_s: 0.0, time_s: 0.0 };
        assert!((extra(falling) - (-0.03 + 0.02)).abs() < 1e-15);
    }
}
