//! Effects on how the speed follows the opening of the valve.

use std::f64::consts::TAU;

use super::twin::Stage::{Dynamics, Speed, Spool};
use super::twin::{At, LARGEST_LEVEL, Numbers, States, Twin, followed};
use crate::clock::MIN_STEPS_PER_LAG;
use crate::error::{BELOW_ONE, FINITE, LASTS_A_LAG, LASTS_A_PERIOD, NOT_NEGATIVE, POSITIVE, SHARE};

/// The spool approaches what is commanded, before the overlap and all that the valve does to its
/// opening: `time_constant x' = command - x`.
pub(super) static SPOOL_LAG: Twin = Twin {
    settle: followed,
    act: lagging,
    drawn: |draw| vec![SHORTEST_LAG_S + draw.strength],
    ..Twin::new("spool_lag", Spool, &["time_constant"], &[LASTS_A_LAG])
};

/// The joint starts above one level of the input and stops below a lower one, each within two time
/// steps.
pub(super) static STICTION: Twin = Twin {
    related: |&[start, stop, ..], _| {
        (stop > start).then_some((1, "not above `effect.stiction.start`"))
    },
    direction: Some(|&[start, stop, ..], level, before| {
        let needed = if level * before > 0.0 { stop } else { start };
        if level.abs() > needed { level.signum() } else { 0.0 }
    }),
    settle: |_, opening, at, states| {
        states[0] = at.direction.abs();
        states[0] * opening
    },
    // The state is how far the joint has come loose, from 0 at rest to 1.
    act: |_, opening, at, &[loose, ..], rates| {
        rates[0] = (at.direction.abs() - loose) / (STEPS_TO_LOOSEN * at.substep_s);
        loose * opening
    },
    drawn: |draw| {
        let start = LARGEST_LEVEL * draw.strength;
        vec![start, start * draw.between(0, 0.3, 0.6)]
    },
    ..Twin::new("stiction", Dynamics, &["start", "stop"], &[NOT_NEGATIVE, NOT_NEGATIVE])
};

/// The spool has a largest speed.
///
/// ```text
/// x' = tanh((in - x) / w) / seconds_per_input,   w: the way in two time steps
/// ```
pub(super) static RATE_LIMIT: Twin = Twin {
    settle: followed,
    act: |&[seconds_per_input, ..], input, at, &[spool, ..], rates| {
        let speed = seconds_per_input.recip();
        rates[0] = speed * ((input - spool) / (2.0 * speed * at.substep_s)).tanh();
        spool
    },
    drawn: |draw| vec![draw.strength],
    ..Twin::new("rate_limit", Dynamics, &["seconds_per_input"], &[POSITIVE])
};

/// The speed approaches what is commanded: `time_constant x' = in - x`.
pub(super) static ACTUATOR_LAG: Twin = Twin {
    settle: followed,
    act: lagging,
    drawn: |draw| vec![SHORTEST_LAG_S + draw.strength],
    ..Twin::new("actuator_lag", Dynamics, &["time_constant"], &[LASTS_A_LAG])
};

/// Oil as a spring, with the pressure as a state of its own.
///
/// ```text
/// p' = ω (in - x),   x' = ω p - 2 damping ω x,   ω = 2π / period
/// ```
///
/// taken about the steady state, so that x = in in the end.
pub(super) static RESONANCE: Twin = Twin {
    settle: swung,
    act: |&[period, damping, ..], input, _, &[pressure, flow, ..], rates| {
        let omega = TAU / period;
        rates[0] = omega * (input - flow);
        rates[1] = omega * (pressure - 2.0 * damping * flow);
        flow
    },
    drawn: |draw| vec![0.08 + 1.5 * draw.strength, draw.between(0, 0.08, 0.25)],
    ..Twin::new("resonance", Dynamics, &["period", "damping"], &[LASTS_A_PERIOD, BELOW_ONE])
};

/// Oil as a spring that is stiffer at other angles, and that the open valve lets escape.
///
/// ```text
/// p' = ω (in - x - 2 valve_damping o a),   x' = ω a,   a = p - 2 damping x
/// ω = 2π / (period exp(slope (angle - reference))),   o = √(in² + 0.1²) - 0.1
/// ```
///
/// with the pressure `a` that is left for the load; taken about the steady state, as in a
/// [`RESONANCE`].
pub(super) static OIL_COLUMN: Twin = Twin {
    settle: swung,
    act: |&[period, damping, valve_damping, slope, reference, ..],
          input,
          at,
          &[pressure, flow, ..],
          rates| {
        let opening = input.hypot(CLOSED) - CLOSED;
        let omega = TAU / (period * (slope * (at.angle - reference)).exp());
        let load = pressure - 2.0 * damping * flow;
        rates[0] = omega * (input - flow - 2.0 * valve_damping * opening * load);
        rates[1] = omega * load;
        flow
    },
    // With the valve wide open as much damping again, and a period that differs by a third
    // between the angles at which the joint is.
    drawn: |draw| {
        let (damping, by_valve) = (draw.between(0, 0.05, 0.12), draw.between(1, 0.05, 0.15));
        vec![0.1 + 1.5 * draw.strength, damping, by_valve, draw.sign(2) * 0.005, draw.start]
    },
    ..Twin::new(
        "oil_column",
        Dynamics,
        &["period", "damping", "valve_damping", "slope", "reference"],
        &[LASTS_A_PERIOD, BELOW_ONE, NOT_NEGATIVE, FINITE, FINITE],
    )
};

/// Opening below which the valve is rather closed, in input units.
const CLOSED: f64 = 0.1;

/// A mass that slides on bristles, which bend before they slip (Dahl).
///
/// ```text
/// time_constant x' = in - x - f
/// f' = (level / BRISTLE) x (1 - sign(x) f / level)
/// ```
///
/// with the level of the direction of motion, in input units: at rest any force up to it is met, in
/// motion it is reached after some lengths of a bristle. `time_constant` is the inertia.
pub(super) static COULOMB_FRICTION: Twin = Twin {
    settle: |numbers, input, _, states| slid(numbers, 1.0, input, states),
    act: |numbers, input, at, states, rates| sliding(numbers, 1.0, input, at, states, rates),
    drawn: |draw| {
        let level = |index| 1.5 * draw.strength * draw.between(index, 0.6, 1.0);
        vec![level(0), level(1), 0.02 + 0.3 * draw.strength * draw.between(2, 0.5, 1.0)]
    },
    ..Twin::new(
        "coulomb_friction",
        Dynamics,
        &["positive", "negative", "time_constant"],
        &[NOT_NEGATIVE, NOT_NEGATIVE, LASTS_A_LAG],
    )
};

/// As [`COULOMB_FRICTION`], and negative motion has another viscous friction, too:
///
/// ```text
/// time_constant x' = in - c x - f,   c: 1 where x > 0, negative_viscous where x < 0
/// ```
pub(super) static ASYMMETRIC_FRICTION: Twin = Twin {
    instead_of: Some("coulomb_friction"),
    // Of the direction that is braked more.
    related: |&[_, _, time_constant, viscous, ..], clock| {
        let shortest_s = MIN_STEPS_PER_LAG * clock.substep_s() * viscous.max(1.0);
        (time_constant < shortest_s).then_some((2, LASTS_A_LAG.0))
    },
    settle: |numbers, input, _, states| slid(numbers, numbers[3], input, states),
    act: |numbers, input, at, states, rates| sliding(numbers, numbers[3], input, at, states, rates),
    // Some part more or less both of the constant and of the viscous friction.
    drawn: |draw| {
        let positive = 1.2 * draw.strength * draw.between(0, 0.6, 1.0);
        let more = 1.0 + draw.strength;
        let viscous = if draw.sign(2) > 0.0 { more } else { 1.0 / more };
        vec![positive, positive * draw.between(1, 0.7, 1.4), 0.05 + 0.2 * draw.strength, viscous]
    },
    ..Twin::new(
        "asymmetric_friction",
        Dynamics,
        &["positive", "negative", "time_constant", "negative_viscous"],
        &[NOT_NEGATIVE, NOT_NEGATIVE, LASTS_A_LAG, POSITIVE],
    )
};

/// The states are speed and friction.
fn sliding(
    &[positive, negative, time_constant, ..]: &Numbers,
    negative_viscous: f64,
    input: f64,
    at: &At,
    &[speed, friction, ..]: &States,
    rates: &mut States,
) -> f64 {
    /// Way in which a bristle bends, in input units times seconds: at a gain of 10 deg/s/V a
    /// fiftieth of a degree.
    const BRISTLE: f64 = 0.002;
    let level = if speed > 0.0 { positive } else { negative };
    // A bristle bends no faster than the time steps can follow.
    let bending = speed / (BRISTLE + speed.abs() * at.substep_s);
    let viscous = if speed < 0.0 { negative_viscous * speed } else { speed };
    rates[0] = (input - viscous - friction) / time_constant;
    rates[1] = bending * (level - speed.signum() * friction);
    speed
}

/// Both after `input` has long been held.
fn slid(
    &[positive, negative, ..]: &Numbers,
    negative_viscous: f64,
    input: f64,
    states: &mut States,
) -> f64 {
    let friction = input.max(-negative).min(positive);
    let force = input - friction;
    states[0] = if force < 0.0 { force / negative_viscous } else { force };
    states[1] = friction;
    states[0]
}

/// Not in the catalogue: the speed creeps on for long after each step, as of seals and hoses. A few
/// lags from fast to slow, as a power of time has.
///
/// ```text
/// out = (1 - share) in + share mean(x_k),   τ_k x_k' = in - x_k
/// ```
pub(super) static CREEP_MEMORY: Twin = Twin {
    settle: followed,
    act: |&[share, ..], input, _, states, rates| {
        for ((rate, state), tau) in rates.iter_mut().zip(states).zip(MEMORY_S) {
            *rate = (input - state) / tau;
        }
        let mean = states.iter().sum::<f64>() / MEMORY_S.len() as f64;
        input + share * (mean - input)
    },
    drawn: |draw| vec![draw.strength],
    ..Twin::new("creep_memory", Dynamics, &["share"], &[SHARE])
};

/// The plain lag of a joint, on its speed.
pub(crate) static LAG: Twin =
    Twin { settle: followed, act: lagging, ..Twin::new("lag_s", Speed, &[], &[]) };

/// The plain ringing of a joint, with its period and damping: `s'' = ω² (in - s) - 2 damping ω s'`.
pub(crate) static RINGING: Twin = Twin {
    settle: |_, speed, _, states| {
        states[0] = speed;
        speed
    },
    act: |&[period_s, damping, ..], speed, _, &[ringing, surge, ..], rates| {
        let omega = TAU / period_s;
        rates[0] = surge;
        rates[1] = omega * (omega * (speed - ringing) - 2.0 * damping * surge);
        ringing
    },
    ..Twin::new("ringing", Speed, &[], &[])
};

/// The shortest lag that is drawn, in seconds: one that the time steps can follow, and more.
const SHORTEST_LAG_S: f64 = 0.01;

/// Time steps in which a joint that sticks comes loose.
const STEPS_TO_LOOSEN: f64 = 2.0;

/// Time constants of a creep in seconds: each four times the one before.
const MEMORY_S: States = [0.5, 2.0, 8.0, 32.0];

fn lagging(
    &[time_constant, ..]: &Numbers,
    input: f64,
    _: &At,
    &[state, ..]: &States,
    rates: &mut States,
) -> f64 {
    rates[0] = (input - state) / time_constant;
    state
}

/// Pressure and flow after `input` has long been held.
fn swung(&[_, damping, ..]: &Numbers, input: f64, _: &At, states: &mut States) -> f64 {
    states[0] = 2.0 * damping * input;
    states[1] = input;
    input
}
