//! Effects on the speed of the joint: where it is, how warm, what pulls at it.

use super::shapes::window;
use super::twin::Stage::Load;
use super::twin::{Twin, rises};
use crate::error::{
    ABOVE_MINUS_ONE, BELOW_ONE, BETWEEN_ONES, BOUND, DRAINS, FINITE, LASTS_A_SAMPLE, MOUNT,
    OPEN_SHARE, SHARE,
};

/// A cylinder that turns the joint by a lever.
///
/// Pivot, foot of the cylinder and its head make a triangle; `ratio` is the lever's side
/// over the side to the foot. With `φ` the angle between both sides, `mount` degrees at the angle
/// `reference`:
///
/// ```text
/// length² = 1 + ratio² - 2 ratio cos φ        (law of cosines)
/// arm     = d length / d φ = ratio sin φ / length
/// speed   = in arm(mount) / arm(φ),           φ = mount + leverage (y - reference)
/// ```
pub(super) static POSITION_GAIN: Twin = Twin {
    optional: &[0.0],
    act: |&[ratio, mount, leverage, reference, ..], speed, at, _, _| {
        let mount = mount.to_radians();
        let turned = mount + leverage * (at.angle - reference) * at.radians;
        let dead_point = std::f64::consts::PI - NEAREST_DEAD_POINT;
        let turned = turned.max(NEAREST_DEAD_POINT).min(dead_point);
        speed * (arm(ratio, mount) / arm(ratio, turned))
    },
    // Between square to the cylinder and the dead points.
    drawn: |draw| {
        let mount = 90.0 + draw.sign(2) * draw.between(1, 25.0, 40.0);
        vec![draw.between(0, 0.2, 0.4), mount, 0.9 * draw.strength, 0.0]
    },
    ..Twin::new(
        "position_gain",
        Load,
        &["ratio", "mount", "leverage", "reference"],
        &[OPEN_SHARE, MOUNT, FINITE, FINITE],
    )
};

/// The lever never comes nearer to a dead point than this, in radians.
const NEAREST_DEAD_POINT: f64 = 0.15;

fn arm(ratio: f64, phi: f64) -> f64 {
    let length = (1.0 + ratio * (ratio - 2.0 * phi.cos())).sqrt();
    ratio * phi.sin() / length
}

/// The gain goes with the temperature θ of the oil, from 0 at the first sample to 1, where it has
/// changed by the part `change`: `time_constant θ' = 1 - θ`.
pub(super) static THERMAL_DRIFT: Twin = Twin {
    act: |&[change, time_constant, ..], speed, _, &[warmth, ..], rates| {
        rates[0] = (1.0 - warmth) / time_constant;
        speed * (1.0 + change * warmth)
    },
    drawn: |draw| {
        let change = if draw.sign(0) > 0.0 { 2.0 } else { -0.9 };
        vec![change * draw.strength, draw.between(1, 30.0, 70.0)]
    },
    ..Twin::new(
        "thermal_drift",
        Load,
        &["change", "time_constant"],
        &[ABOVE_MINUS_ONE, LASTS_A_SAMPLE],
    )
};

/// A pump that is shared: the part of the gain that is lost while all other joints' valves are as
/// far open as they ever are. The state is the demand that the pressure has followed.
pub(super) static SUPPLY_DROOP: Twin = Twin {
    act: |&[droop, ..], speed, at, &[demand, ..], rates| {
        rates[0] = (at.others - demand) / PUMP_S.max(2.0 * at.substep_s);
        speed * (1.0 - droop * demand)
    },
    drawn: |draw| vec![0.95 * draw.strength],
    ..Twin::new("supply_droop", Load, &["droop"], &[BELOW_ONE])
};

/// Time constant of the pump's pressure, in seconds.
const PUMP_S: f64 = 0.02;

/// The weight of the arm: less pressure is left for the valve upward, more downward, and
/// the arm creeps down. `kappa` is the largest load pressure over the supply pressure, `y0` the
/// angle at which the arm lies level.
///
/// ```text
/// out = in sqrt(1 - tanh(in / e) kappa cos(y - y0)) - creep cos(y - y0)
/// ```
pub(super) static GRAVITY_LOAD: Twin = Twin {
    optional: &[0.0, 0.0],
    act: |&[kappa, y0, creep, ..], speed, at, _, _| {
        let lies = ((at.angle - y0) * at.radians).cos();
        let left = 1.0 - (speed / at.speed_edge).tanh() * kappa * lies;
        speed * left.sqrt() - creep * lies
    },
    drawn: |draw| {
        let creep = 3.0 * draw.strength * draw.between(1, 0.0, 1.0);
        vec![0.9 * draw.strength, draw.between(0, -40.0, 40.0), creep]
    },
    ..Twin::new("gravity_load", Load, &["kappa", "y0", "creep"], &[BETWEEN_ONES, FINITE, FINITE])
};

/// Oil that passes the piston: the joint drifts toward an angle, `rate` per second of the distance.
pub(super) static LEAKAGE: Twin = Twin {
    optional: &[0.0],
    act: |&[rate, y0, ..], speed, at, _, _| speed + rate * (y0 - at.angle),
    drawn: |draw| vec![0.6 * draw.strength, draw.between(0, -20.0, 20.0)],
    ..Twin::new("leakage", Load, &["rate", "y0"], &[DRAINS, FINITE])
};

/// Not in the catalogue: a bearing that binds in a range of angles, whose ends are rounded over a
/// twentieth of it, and leaves the part `share` of the speed.
pub(super) static STICKY_SPOT: Twin = Twin {
    related: rises,
    act: |&[from, to, share, ..], speed, at, _, _| {
        let inside = window(at.angle, from, to, SPOT_EDGE * (to - from));
        speed * (1.0 - (1.0 - share) * inside)
    },
    drawn: |draw| {
        let (middle, half) = (draw.between(0, -20.0, 20.0), draw.between(1, 6.0, 9.0));
        vec![middle - half, middle + half, 1.0 - 0.95 * draw.strength]
    },
    ..Twin::new("sticky_spot", Load, &["from", "to", "share"], &[FINITE, FINITE, SHARE])
};

/// Width of the ends of a sticky spot, as a part of it.
const SPOT_EDGE: f64 = 0.05;

/// Not in the catalogue: something pushes for a while, as a load that the arm carries, and adds to
/// the speed. It comes and goes within some 0.2 s.
pub(super) static DISTURBANCE: Twin = Twin {
    related: rises,
    act: |&[from_s, to_s, push, ..], speed, at, _, _| {
        speed + push * window(at.time_s, from_s, to_s, DISTURBANCE_EDGE_S)
    },
    drawn: |draw| {
        let from_s = draw.between(0, 20.0, 80.0);
        let to_s = from_s + draw.between(1, 5.0, 12.0);
        vec![from_s, to_s, 20.0 * draw.strength * draw.sign(2)]
    },
    ..Twin::new("disturbance", Load, &["from_s", "to_s", "speed"], &[FINITE, FINITE, FINITE])
};

/// Width of the rise of a disturbance, in seconds.
const DISTURBANCE_EDGE_S: f64 = 0.05;

/// Stops that the joint runs into, as stiff springs: it gives by its speed times one
/// time step. One of the two may be left out.
pub(super) static END_STOP: Twin = Twin {
    optional: &[f64::NEG_INFINITY, f64::INFINITY],
    related: rises,
    act: |&[low, high, ..], speed, at, _, _| speed - beyond(at.angle, low, high) / at.substep_s,
    drawn: |draw| {
        let way = 65.0 * draw.strength;
        vec![-70.0 + way, 70.0 - way * draw.between(0, 0.7, 1.0)]
    },
    ..Twin::new("end_stop", Load, &["low", "high"], &[BOUND, BOUND])
};

/// How far `x` is beyond `low` or `high`.
pub(super) fn beyond(x: f64, low: f64, high: f64) -> f64 {
    (x - high).max(0.0) + (x - low).min(0.0)
}
