//! The effect on the time at which a step of the input acts.

use super::twin::Stage::Delay;
use super::twin::Twin;
use crate::error::{NOT_NEGATIVE, POSITIVE};

/// What is added to the delay of each step. What is left out is zero.
///
/// ```text
/// small_s exp(-abs(after - before) / scale)
///   + falling_s where after < before
///   + rested_s (1 - exp(-held / rest_s))
///   + cold_s exp(-t / warming_s)
/// ```
pub(super) static VARIABLE_DELAY: Twin = Twin {
    optional: &NONE,
    delay_s: |&[small_s, scale, falling_s, rested_s, rest_s, cold_s, warming_s], at| {
        let rise = at.after - at.before;
        let small = small_s * (-rise.abs() / scale).exp();
        let falling = if rise < 0.0 { falling_s } else { 0.0 };
        let rested = -rested_s * (-at.held_s / rest_s).exp_m1();
        small + falling + rested + cold_s * (-at.time_s / warming_s).exp()
    },
    longest_delay_s: |&[small_s, _, falling_s, rested_s, _, cold_s, _]| {
        small_s + falling_s + rested_s + cold_s
    },
    // Two of the four terms: nearby steps differ, and so do those far apart.
    drawn: |draw| {
        let (first, second) = (draw.strength * draw.between(0, 0.6, 1.0), draw.strength);
        let [_, scale, _, _, rest_s, _, warming_s] = NONE;
        let [small, falling, rested, cold] = match (draw.sign(1) > 0.0, draw.sign(2) > 0.0) {
            (true, true) => [first, second, 0.0, 0.0],
            (true, false) => [first, 0.0, 0.0, second],
            (false, true) => [0.0, second, first, 0.0],
            (false, false) => [second, 0.0, first, 0.0],
        };
        vec![small, scale, falling, rested, rest_s, cold, warming_s]
    },
    ..Twin::new(
        "variable_delay",
        Delay,
        &["small_s", "scale", "falling_s", "rested_s", "rest_s", "cold_s", "warming_s"],
        &[NOT_NEGATIVE, POSITIVE, NOT_NEGATIVE, NOT_NEGATIVE, POSITIVE, NOT_NEGATIVE, POSITIVE],
    )
};

/// No extra delay: scales in input units and seconds, and terms of zero.
const NONE: [f64; 7] = [0.0, 4.0, 0.0, 0.0, 4.0, 0.0, 120.0];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay_law::Occasion;

    #[test]
    fn each_term_is_there_when_it_should_be() {
        let numbers = [0.1, 4.0, 0.2, 0.4, 4.0, 0.8, 120.0];
        let at = Occasion {
            index: 0,
            before: 4.0,
            after: 0.0,
            progress: 0.5,
            chance: 0.5,
            held_s: 4.0,
            time_s: 120.0,
        };
        let left = (-1.0_f64).exp();
        let expected = 0.1 * left + 0.2 + 0.4 * (1.0 - left) + 0.8 * left;
        let delay_s = |at: &Occasion| (VARIABLE_DELAY.delay_s)(&numbers, at);
        assert!((delay_s(&at) - expected).abs() < 1e-12);
        assert!(delay_s(&Occasion { after: 8.0, ..at }) < expected - 0.19);
        assert!((VARIABLE_DELAY.longest_delay_s)(&numbers) >= expected);
    }
}
