//! Effects on how the speed follows the opening of the valve.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::super::clock::{Clock, MIN_STEPS_PER_LAG, MIN_STEPS_PER_PERIOD};
use super::super::error::{Allowed, Place, PlantError};
use super::part::Part;

/// The spool has a largest speed.
///
/// ```text
/// x' = tanh((in - x) / w) / seconds_per_input,   w: the way in two time steps
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RateLimit {
    /// Time for a change by one input unit, in seconds.
    pub seconds_per_input: f64,
}

/// The speed approaches what is commanded: `time_constant x' = in - x`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ActuatorLag {
    /// Time to 63 % of a change, in seconds.
    pub time_constant: f64,
}

/// The spool approaches what is commanded, before the overlap and all that the valve does to its
/// opening: `time_constant x' = command - x`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpoolLag {
    /// Time to 63 % of a change, in seconds.
    pub time_constant: f64,
}

/// Oil as a spring, with the pressure as a state of its own.
///
/// ```text
/// p' = ω (in - x),   x' = ω p - 2 damping ω x,   ω = 2π / period
/// ```
///
/// taken about the steady state, so that x = in in the end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Resonance {
    /// Period without damping, in seconds.
    pub period: f64,
    /// Damping ratio, below 1.
    pub damping: f64,
}

/// Oil as a spring that is stiffer at other angles, and that the open valve lets escape.
///
/// ```text
/// p' = ω (in - x - 2 valve_damping o a),   x' = ω a,   a = p - 2 damping x
/// ω = 2π / (period exp(slope (angle - reference))),   o = √(in² + 0.1²) - 0.1
/// ```
///
/// with the pressure `a` that is left for the load; taken about the steady state, as in a
/// [`Resonance`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OilColumn {
    /// Period without damping at `reference`, in seconds.
    pub period: f64,
    /// Damping ratio with the valve closed, below 1.
    pub damping: f64,
    /// What one input unit of opening adds to it.
    pub valve_damping: f64,
    /// Relative change of the period per output unit.
    pub slope: f64,
    /// Angle at which the period is `period`, in output units.
    pub reference: f64,
}

/// A mass that slides on bristles, which bend before they slip (Dahl).
///
/// ```text
/// time_constant x' = in - x - f
/// f' = (level / BRISTLE) x (1 - sign(x) f / level)
/// ```
///
/// with the level of the direction of motion: at rest any force up to it is met, in
/// motion it is reached after some lengths of a bristle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoulombFriction {
    /// Friction against positive motion, in input units.
    pub positive: f64,
    /// Friction against negative motion, in input units.
    pub negative: f64,
    /// Inertia: time to 63 % of a change, in seconds.
    pub time_constant: f64,
}

/// As [`CoulombFriction`], and negative motion has another viscous friction, too:
///
/// ```text
/// time_constant x' = in - c x - f,   c: 1 where x > 0, negative_viscous where x < 0
/// ```
///
/// It takes the place of a [`CoulombFriction`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AsymmetricFriction {
    /// Friction against positive motion, in input units.
    pub positive: f64,
    /// Friction against negative motion, in input units.
    pub negative: f64,
    /// Inertia: time to 63 % of a change of positive motion, in seconds.
    pub time_constant: f64,
    /// Viscous friction of negative motion over that of positive motion.
    pub negative_viscous: f64,
}

/// Not in the catalogue: the speed creeps on for long after each step, as of seals and
/// hoses. A few lags from fast to slow, as a power of time has.
///
/// ```text
/// out = (1 - share) in + share mean(x_k),   τ_k x_k' = in - x_k
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CreepMemory {
    /// Part of a change that comes late.
    pub share: f64,
}

/// Slow states of a [`CreepMemory`].
pub(in super::super) const MEMORIES: usize = 4;

/// Their time constants in seconds: each four times the one before.
const MEMORY_S: [f64; MEMORIES] = [0.5, 2.0, 8.0, 32.0];

/// Way in which a bristle bends, in input units times seconds: at a gain of 10 deg/s/V a
/// fiftieth of a degree.
const BRISTLE: f64 = 0.002;

impl RateLimit {
    pub(in super::super) fn rate(self, input: f64, spool: f64, substep_s: f64) -> f64 {
        let speed = self.seconds_per_input.recip();
        speed * ((input - spool) / (2.0 * speed * substep_s)).tanh()
    }
}

impl ActuatorLag {
    pub(in super::super) fn rate(self, input: f64, state: f64) -> f64 {
        (input - state) / self.time_constant
    }
}

impl SpoolLag {
    pub(in super::super) fn rate(self, command: f64, spool: f64) -> f64 {
        (command - spool) / self.time_constant
    }
}

impl Resonance {
    /// Of pressure and flow.
    pub(in super::super) fn rate(&self, input: f64, [pressure, flow]: [f64; 2]) -> [f64; 2] {
        let omega = TAU / self.period;
        [omega * (input - flow), omega * (pressure - 2.0 * self.damping * flow)]
    }

    /// Pressure and flow after `input` has long been held.
    pub(in super::super) fn steady(&self, input: f64) -> [f64; 2] {
        [2.0 * self.damping * input, input]
    }
}

impl OilColumn {
    /// Of pressure and flow, with the joint at `angle`.
    pub(in super::super) fn rate(
        &self,
        input: f64,
        [pressure, flow]: [f64; 2],
        angle: f64,
    ) -> [f64; 2] {
        /// Opening below which the valve is rather closed, in input units.
        const EDGE: f64 = 0.1;
        let opening = input.hypot(EDGE) - EDGE;
        let omega = TAU / (self.period * (self.slope * (angle - self.reference)).exp());
        let load = pressure - 2.0 * self.damping * flow;
        [omega * (input - flow - 2.0 * self.valve_damping * opening * load), omega * load]
    }

    /// Pressure and flow after `input` has long been held.
    pub(in super::super) fn steady(&self, input: f64) -> [f64; 2] {
        [2.0 * self.damping * input, input]
    }
}

impl From<CoulombFriction> for AsymmetricFriction {
    fn from(CoulombFriction { positive, negative, time_constant }: CoulombFriction) -> Self {
        Self { positive, negative, time_constant, negative_viscous: 1.0 }
    }
}

impl AsymmetricFriction {
    /// Of speed and friction.
    pub(in super::super) fn rate(
        &self,
        input: f64,
        [speed, friction]: [f64; 2],
        substep_s: f64,
    ) -> [f64; 2] {
        let level = if speed > 0.0 { self.positive } else { self.negative };
        // A bristle bends no faster than the time steps can follow.
        let bending = speed / (BRISTLE + speed.abs() * substep_s);
        let bends = bending * (level - speed.signum() * friction);
        let viscous = if speed < 0.0 { self.negative_viscous * speed } else { speed };
        [(input - viscous - friction) / self.time_constant, bends]
    }

    /// Speed and friction after `input` has long been held.
    pub(in super::super) fn steady(&self, input: f64) -> [f64; 2] {
        let friction = input.max(-self.negative).min(self.positive);
        let force = input - friction;
        [if force < 0.0 { force / self.negative_viscous } else { force }, friction]
    }
}

impl CreepMemory {
    pub(in super::super) fn out(self, input: f64, states: &[f64]) -> f64 {
        let mean = states.iter().sum::<f64>() / MEMORIES as f64;
        input + self.share * (mean - input)
    }

    pub(in super::super) fn rates(input: f64, states: &[f64], rates: &mut [f64]) {
        for ((rate, state), tau) in rates.iter_mut().zip(states).zip(MEMORY_S) {
            *rate = (input - state) / tau;
        }
    }
}

/// Refuses a time that the time steps cannot follow.
fn lasts(
    place: &Place,
    key: &'static str,
    seconds: f64,
    shortest_s: f64,
) -> Result<(), PlantError> {
    let allowed = "finite seconds, long enough for the time steps (sample_period_s / substeps): \
                   4 or more in a time constant, 40 in a period";
    place.require(key, seconds, allowed, |seconds| seconds.is_finite() && *seconds >= shortest_s)
}

impl Part for RateLimit {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        let key = "effect.rate_limit.seconds_per_input";
        place.number(key, self.seconds_per_input, Allowed::Positive)
    }
}

impl Part for ActuatorLag {
    fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        let shortest_s = MIN_STEPS_PER_LAG * clock.substep_s();
        lasts(place, "effect.actuator_lag.time_constant", self.time_constant, shortest_s)
    }
}

impl Part for SpoolLag {
    fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        let shortest_s = MIN_STEPS_PER_LAG * clock.substep_s();
        lasts(place, "effect.spool_lag.time_constant", self.time_constant, shortest_s)
    }
}

impl Part for Resonance {
    fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        let shortest_s = MIN_STEPS_PER_PERIOD * clock.substep_s();
        lasts(place, "effect.resonance.period", self.period, shortest_s)?;
        place.number("effect.resonance.damping", self.damping, Allowed::BelowOne)
    }
}

impl Part for OilColumn {
    fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        let shortest_s = MIN_STEPS_PER_PERIOD * clock.substep_s();
        lasts(place, "effect.oil_column.period", self.period, shortest_s)?;
        place.number("effect.oil_column.damping", self.damping, Allowed::BelowOne)?;
        let key = "effect.oil_column.valve_damping";
        place.number(key, self.valve_damping, Allowed::NotNegative)?;
        place.number("effect.oil_column.slope", self.slope, Allowed::Finite)?;
        place.number("effect.oil_column.reference", self.reference, Allowed::Finite)
    }
}

impl Part for CoulombFriction {
    fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        place.number("effect.coulomb_friction.positive", self.positive, Allowed::NotNegative)?;
        place.number("effect.coulomb_friction.negative", self.negative, Allowed::NotNegative)?;
        let shortest_s = MIN_STEPS_PER_LAG * clock.substep_s();
        lasts(place, "effect.coulomb_friction.time_constant", self.time_constant, shortest_s)
    }
}

impl Part for AsymmetricFriction {
    fn check(&self, place: &Place, clock: &Clock) -> Result<(), PlantError> {
        place.number("effect.asymmetric_friction.positive", self.positive, Allowed::NotNegative)?;
        place.number("effect.asymmetric_friction.negative", self.negative, Allowed::NotNegative)?;
        let key = "effect.asymmetric_friction.negative_viscous";
        place.number(key, self.negative_viscous, Allowed::Positive)?;
        // Of the direction that is braked more.
        let shortest_s = MIN_STEPS_PER_LAG * clock.substep_s() * self.negative_viscous.max(1.0);
        lasts(place, "effect.asymmetric_friction.time_constant", self.time_constant, shortest_s)
    }
}

impl Part for CreepMemory {
    fn check(&self, place: &Place, _clock: &Clock) -> Result<(), PlantError> {
        place.number("outside.creep_memory.share", self.share, Allowed::Share)
    }
}
