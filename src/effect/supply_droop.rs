//! Supply droop: the joint slows down while others draw from the same pump.
//!
//! ```text
//! out = in · (1 − droop · others)
//! ```
//!
//! `others` is the activity of the other joints in the log, from 0 (at rest) to 1 (all at
//! full speed). A joint that is not in the log cannot be seen, and a pressure that
//! recovers slowly, as of an accumulator, is not modelled.
//!
//! # References
//! Merritt, H. E., 1967, Hydraulic Control Systems (hydraulic power supplies).

use super::{Dimension, Effect, Equations, Moment, Parameter, Spec, Stage};

/// See the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct SupplyDroop;

static SPEC: Spec =
    Spec::new("supply_droop", Stage::Load, "shared pump: the gain falls while other joints move")
        .equation("out = in (1 - droop others)")
        .source("Merritt, 1967, Hydraulic Control Systems")
        .parameters(&[Parameter::new(
            "droop",
            "part of the speed that is lost while all others move",
            Dimension::One,
        )
        .between(0.0, 0.95)
        .typical(0.2)])
        .confused_with(&["thermal_drift"])
        .equations(Equations::new(&["out = signal * (1 - droop * others)"]));

impl Effect for SupplyDroop {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn depends_on_others(&self) -> bool {
        true
    }

    fn step(&self, parameters: &[f64], _memory: &mut [f64], at: &Moment) -> f64 {
        let &[droop] = parameters else { return at.signal };
        at.signal * (1.0 - droop * at.others)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_close, moment};
    use super::*;

    #[test]
    fn slows_as_the_others_move() {
        let speed = |others| SupplyDroop.step(&[0.4], &mut [], &Moment { others, ..moment(-10.0) });
        assert_close(&[0.0, 0.5, 1.0].map(speed), &[-10.0, -8.0, -6.0]);
    }
}
