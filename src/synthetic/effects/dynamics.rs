//! Effects on how the speed follows the opening of the valve.

use std::f64::consts::TAU;

use super::super::clock::{Clock, MIN_STEPS_PER_LAG};
use super::super::error::{
    BELOW_ONE, FINITE, LASTS_A_LAG, LASTS_A_PERIOD, NOT_NEGATIVE, POSITIVE, SHARE,
};
use super::twin::{At, LARGEST_LEVEL, Stage, Twin, followed};

/// The spool approaches what is commanded, before the overlap and all that the valve does to its
/// opening: `time_constant x' = command - x`.
pub(super) static SPOOL_LAG: Twin = Twin {
    states: 1,
    settle: followed,
    act: lagging,
    drawn: |draw| vec![SHORTEST_LAG_S + draw.strength],
    ..Twin::new("spool_lag", Stage::Spool, &["time_constant"], &[LASTS_A_LAG])
};

/// The joint starts above one level of the input and stops below a lower one, each within two time
/// steps.
pub(super) static STICTION: Twin = Twin {
    related: |numbers, _| match numbers {
        [start, stop] if stop > start => Some((1, "not above `effect.stiction.start`")),
        _ => None,
    },
    states: 1,
    settle: |_, opening, at, states| {
        states.fill(at.moves);
        at.moves * opening
    },
    // The state is how far the joint has come loose, from 0 at rest to 1.
    act: |_, opening, at, states, rates| match (states, rates) {
        ([loose], [rate]) => {
            *rate = (at.moves - loose) / (STEPS_TO_LOOSEN * at.substep_s);
            loose * opening
        }
        _ => opening,
    },
    drawn: |draw| {
        let start = LARGEST_LEVEL * draw.strength;
        vec![start, start * draw.between(0, 0.3, 0.6)]
    },
    ..Twin::new("stiction", Stage::Dynamics, &["start", "stop"], &[NOT_NEGATIVE, NOT_NEGATIVE])
};

/// The spool has a largest speed.
///
/// ```text
/// x' = tanh((in - x) / w) / seconds_per_input,   w: the way in two time steps
/// ```
pub(super) static RATE_LIMIT: Twin = Twin {
    states: 1,
    settle: followed,
    act: |numbers, input, at, states, rates| match (numbers, states, rates) {
        ([seconds_per_input], &[spool], [rate]) => {
            let speed = seconds_per_input.recip();
            *rate = speed * ((input - spool) / (2.0 * speed * at.substep_s)).tanh();
            spool
        }
        _ => input,
    },
    drawn: |draw| vec![draw.strength],
    ..Twin::new("rate_limit", Stage::Dynamics, &["seconds_per_input"], &[POSITIVE])
};

/// The speed approaches what is commanded: `time_constant x' = in - x`.
pub(super) static ACTUATOR_LAG: Twin = Twin {
    states: 1,
    settle: followed,
    act: lagging,
    drawn: |draw| vec![SHORTEST_LAG_S + draw.strength],
    ..Twin::new("actuator_lag", Stage::Dynamics, &["time_constant"], &[LASTS_A_LAG])
};

/// Oil as a spring, with the pressure as a state of its own.
///
/// ```text
/// p' = ω (in - x),   x' = ω p - 2 damping ω x,   ω = 2π / period
/// ```
///
/// taken about the steady state, so that x = in in the end.
pub(super) static RESONANCE: Twin = Twin {
    states: 2,
    settle: swung,
    act: |numbers, input, _, states, rates| match (numbers, states, rates) {
        ([period, damping], &[pressure, flow], rates) => {
            let omega = TAU / period;
            rates.copy_from_slice(&[
                omega * (input - flow),
                omega * (pressure - 2.0 * damping * flow),
            ]);
            flow
        }
        _ => input,
    },
    drawn: |draw| vec![0.08 + 1.5 * draw.strength, draw.between(0, 0.08, 0.25)],
    ..Twin::new("resonance", Stage::Dynamics, &["period", "damping"], &[LASTS_A_PERIOD, BELOW_ONE])
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
    states: 2,
    settle: swung,
    act: oil_column,
    // With the valve wide open as much damping again, and a period that differs by a third
    // between the angles at which the joint is.
    drawn: |draw| {
        let (damping, by_valve) = (draw.between(0, 0.05, 0.12), draw.between(1, 0.05, 0.15));
        vec![0.1 + 1.5 * draw.strength, damping, by_valve, draw.sign(2) * 0.005, draw.start]
    },
    ..Twin::new(
        "oil_column",
        Stage::Dynamics,
        &["period", "damping", "valve_damping", "slope", "reference"],
        &[LASTS_A_PERIOD, BELOW_ONE, NOT_NEGATIVE, FINITE, FINITE],
    )
};

fn oil_column(numbers: &[f64], input: f64, at: &At, states: &[f64], rates: &mut [f64]) -> f64 {
    /// Opening below which the valve is rather closed, in input units.
    const EDGE: f64 = 0.1;
    let (&[period, damping, valve_damping, slope, reference], &[pressure, flow]) =
        (numbers, states)
    else {
        return input;
    };
    let opening = input.hypot(EDGE) - EDGE;
    let omega = TAU / (period * (slope * (at.angle - reference)).exp());
    let load = pressure - 2.0 * damping * flow;
    rates.copy_from_slice(&[
        omega * (input - flow - 2.0 * valve_damping * opening * load),
        omega * load,
    ]);
    flow
}

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
    states: 2,
    settle: slid,
    act: sliding,
    drawn: |draw| {
        let level = |index| 1.5 * draw.strength * draw.between(index, 0.6, 1.0);
        vec![level(0), level(1), 0.02 + 0.3 * draw.strength * draw.between(2, 0.5, 1.0)]
    },
    ..Twin::new(
        "coulomb_friction",
        Stage::Dynamics,
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
    related: |numbers, clock: &Clock| match numbers {
        [_, _, time_constant, viscous]
            if *time_constant < MIN_STEPS_PER_LAG * clock.substep_s() * viscous.max(1.0) =>
        {
            Some((2, LASTS_A_LAG.words))
        }
        _ => None,
    },
    states: 2,
    settle: slid,
    act: sliding,
    // Some part more or less both of the constant and of the viscous friction.
    drawn: |draw| {
        let positive = 1.2 * draw.strength * draw.between(0, 0.6, 1.0);
        let more = 1.0 + draw.strength;
        let viscous = if draw.sign(2) > 0.0 { more } else { 1.0 / more };
        vec![positive, positive * draw.between(1, 0.7, 1.4), 0.05 + 0.2 * draw.strength, viscous]
    },
    ..Twin::new(
        "asymmetric_friction",
        Stage::Dynamics,
        &["positive", "negative", "time_constant", "negative_viscous"],
        &[NOT_NEGATIVE, NOT_NEGATIVE, LASTS_A_LAG, POSITIVE],
    )
};

/// Levels in both directions, inertia, and the viscous friction of negative motion.
fn friction(numbers: &[f64]) -> Option<[f64; 4]> {
    match *numbers {
        [positive, negative, time_constant] => Some([positive, negative, time_constant, 1.0]),
        [positive, negative, time_constant, viscous] => {
            Some([positive, negative, time_constant, viscous])
        }
        _ => None,
    }
}

/// The states are speed and friction.
fn sliding(numbers: &[f64], input: f64, at: &At, states: &[f64], rates: &mut [f64]) -> f64 {
    /// Way in which a bristle bends, in input units times seconds: at a gain of 10 deg/s/V a
    /// fiftieth of a degree.
    const BRISTLE: f64 = 0.002;
    let (Some([positive, negative, time_constant, negative_viscous]), &[speed, friction]) =
        (friction(numbers), states)
    else {
        return input;
    };
    let level = if speed > 0.0 { positive } else { negative };
    // A bristle bends no faster than the time steps can follow.
    let bending = speed / (BRISTLE + speed.abs() * at.substep_s);
    let bends = bending * (level - speed.signum() * friction);
    let viscous = if speed < 0.0 { negative_viscous * speed } else { speed };
    rates.copy_from_slice(&[(input - viscous - friction) / time_constant, bends]);
    speed
}

fn slid(numbers: &[f64], input: f64, _: &At, states: &mut [f64]) -> f64 {
    let Some([positive, negative, _, viscous]) = friction(numbers) else { return input };
    let friction = input.max(-negative).min(positive);
    let force = input - friction;
    let speed = if force < 0.0 { force / viscous } else { force };
    states.copy_from_slice(&[speed, friction]);
    speed
}

/// Not in the catalogue: the speed creeps on for long after each step, as of seals and hoses. A few
/// lags from fast to slow, as a power of time has.
///
/// ```text
/// out = (1 - share) in + share mean(x_k),   τ_k x_k' = in - x_k
/// ```
pub(super) static CREEP_MEMORY: Twin = Twin {
    states: MEMORY_S.len(),
    settle: followed,
    act: |numbers, input, _, states, rates| {
        for ((rate, state), tau) in rates.iter_mut().zip(states).zip(MEMORY_S) {
            *rate = (input - state) / tau;
        }
        let mean = states.iter().sum::<f64>() / MEMORY_S.len() as f64;
        match *numbers {
            [share] => input + share * (mean - input),
            _ => input,
        }
    },
    drawn: |draw| vec![draw.strength],
    ..Twin::new("creep_memory", Stage::Dynamics, &["share"], &[SHARE])
};

/// The plain lag of a joint, on its speed.
pub(in super::super) static LAG: Twin = Twin {
    states: 1,
    settle: followed,
    act: lagging,
    ..Twin::new("lag_s", Stage::Speed, &[], &[])
};

/// The plain ringing of a joint, with its period and damping: `s'' = ω² (in - s) - 2 damping ω s'`.
pub(in super::super) static RINGING: Twin = Twin {
    states: 2,
    settle: |_, speed, _, states| {
        states.copy_from_slice(&[speed, 0.0]);
        speed
    },
    act: |numbers, speed, _, states, rates| match (numbers, states, rates) {
        ([period_s, damping], &[ringing, surge], rates) => {
            let omega = TAU / period_s;
            let pull = omega * (speed - ringing) - 2.0 * damping * surge;
            rates.copy_from_slice(&[surge, omega * pull]);
            ringing
        }
        _ => speed,
    },
    ..Twin::new("ringing", Stage::Speed, &[], &[])
};

/// The shortest lag that is drawn, in seconds: one that the time steps can follow, and more.
const SHORTEST_LAG_S: f64 = 0.01;

/// Time steps in which a joint that sticks comes loose.
const STEPS_TO_LOOSEN: f64 = 2.0;

/// Time constants of a creep in seconds: each four times the one before.
const MEMORY_S: [f64; 4] = [0.5, 2.0, 8.0, 32.0];

fn lagging(numbers: &[f64], input: f64, _: &At, states: &[f64], rates: &mut [f64]) -> f64 {
    match (numbers, states, rates) {
        ([time_constant], &[state], [rate]) => {
            *rate = (input - state) / time_constant;
            state
        }
        _ => input,
    }
}

/// Pressure and flow after `input` has long been held.
fn swung(numbers: &[f64], input: f64, _: &At, states: &mut [f64]) -> f64 {
    let damping = numbers.get(1).copied().unwrap_or_default();
    states.copy_from_slice(&[2.0 * damping * input, input]);
    input
}
