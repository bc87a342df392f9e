//! A joint with effects, in time steps finer than a sample.
//!
//! Everything that moves or remembers is one state of a single system of differential
//! equations, integrated by Runge and Kutta's method of order four, as in `dynamics`.

use std::f64::consts::TAU;

use super::clock::Clock;
use super::drive::{Attempt, Drive, Predictor, beyond};
use super::effects::{CreepMemory, MEMORIES, SupplyDroop, Valve};
use super::error::PlantError;
use super::spec::{JointSpec, Ringing};
use super::statics::StaticChain;

/// All that moves or remembers.
type State = [f64; STATES];

/// How far the joint has come loose, from 0 at rest to 1.
const CONTACT: usize = 0;
/// Opening of the spool.
const SPOOL: usize = 1;
/// After the lag of the actuator.
const LAG: usize = 2;
/// Pressure in the oil.
const PRESSURE: usize = 3;
/// Flow of the oil.
const FLOW: usize = 4;
/// Speed of the mass with friction.
const MASS: usize = 5;
/// The friction on it.
const FRICTION: usize = 6;
/// Slow states of the creep.
const MEMORY: std::ops::Range<usize> = 7..7 + MEMORIES;
/// Speed after the plain lag.
const LAGGED: usize = 11;
/// Speed that rings.
const RINGING: usize = 12;
/// Its derivative.
const SURGE: usize = 13;
/// Temperature of the oil, 0 to 1.
const WARMTH: usize = 14;
/// Demand that the pump has followed.
const DEMAND: usize = 15;
/// Angle of the joint.
const ANGLE: usize = 16;
/// Angle on the other side of the play.
const MEASURED: usize = 17;
/// Pressure in an oil column.
const COLUMN_PRESSURE: usize = 18;
/// Flow out of it.
const COLUMN_FLOW: usize = 19;
/// The command that the spool has followed, in input units.
const FOLLOWED: usize = 20;
/// Number of states.
const STATES: usize = 21;

/// Time steps in which a joint that sticks comes loose.
const STEPS_TO_LOOSEN: f64 = 2.0;

/// Draws of a level before the one that goes least beyond the range is taken.
const PATIENCE: usize = 20;

/// A joint on its way through a record.
#[derive(Clone, Debug)]
pub(super) struct Motion<'a> {
    joint: &'a JointSpec,
    clock: Clock,
    chain: StaticChain<'a>,
    valve: Valve<'a>,
    radians: f64,
    /// Arrivals that act already.
    arrived: usize,
    now_s: f64,
    /// What is commanded, in input units.
    command: f64,
    /// Opening of the valve, in input units.
    opening: f64,
    /// Direction of motion, 0 where it sticks.
    direction: f64,
    /// Demand of the other joints, 0 to 1.
    others: f64,
    state: State,
}

impl<'a> Motion<'a> {
    /// The joint at the first sample; its first level has long been held.
    pub(super) fn new(joint: &'a JointSpec, clock: Clock) -> Self {
        let (chain, valve) = (StaticChain::of(joint), joint.valve());
        let radians = radians(&joint.output_unit);
        let mut motion = Self {
            joint,
            clock,
            chain,
            valve,
            radians,
            arrived: 0,
            now_s: 0.0,
            command: 0.0,
            opening: 0.0,
            direction: 0.0,
            others: 0.0,
            state: [0.0; STATES],
        };
        motion.state[FOLLOWED] = joint.input.initial();
        motion.set(joint.input.initial());
        motion.settle();
        motion
    }

    /// Angle as it would be measured without noise.
    pub(super) fn shown(&self) -> f64 {
        let behind = self.joint.effect.backlash.map_or(self.state[ANGLE], |_| self.state[MEASURED]);
        self.joint.outside.shown(behind)
    }

    /// How far the valve is open, as a part of what the largest level opens it.
    pub(super) fn demand(&self) -> f64 {
        share(self.opening, &self.chain, self.joint)
    }

    /// Lets the time from `sample` to the next pass.
    pub(super) fn pass(&mut self, sample: usize, drive: &Drive, others: f64) {
        self.others = others;
        for end_s in self.clock.substep_ends(sample) {
            while let Some((index, arrival)) = drive.arrivals().later().get(self.arrived) {
                if arrival.time_s >= end_s {
                    break;
                }
                self.integrate_to(arrival.time_s);
                self.set(drive.level_of(*index));
                self.arrived += 1;
            }
            self.integrate_to(end_s);
        }
    }

    /// Lets `level` act.
    fn set(&mut self, level: f64) {
        self.command = level;
        if self.joint.effect.spool_lag.is_none() {
            self.open(level);
        } else {
            self.open(self.state[FOLLOWED]);
        }
    }

    /// Opens the valve as far as a spool at `level` does.
    fn open(&mut self, level: f64) {
        self.direction = self.valve.direction(level, self.direction);
        self.opening = self.chain.opening(level);
    }

    /// Puts what moves into the state that a level long held has brought about.
    fn settle(&mut self) {
        let effect = &self.joint.effect;
        let loose = f64::from(u8::from(self.direction.abs() > 0.0 || effect.stiction.is_none()));
        let mut signal = loose * self.opening;
        self.state[CONTACT] = loose;
        [self.state[SPOOL], self.state[LAG]] = [signal; 2];
        if let Some(resonance) = effect.resonance {
            [self.state[PRESSURE], self.state[FLOW]] = resonance.steady(signal);
        }
        if let Some(column) = effect.oil_column {
            let steady = column.steady(signal);
            [self.state[COLUMN_PRESSURE], self.state[COLUMN_FLOW]] = steady;
        }
        if let Some(friction) = effect.friction() {
            [self.state[MASS], self.state[FRICTION]] = friction.steady(signal);
            signal = self.state[MASS];
        }
        self.state[MEMORY].fill(signal);
        [self.state[LAGGED], self.state[RINGING]] = [self.joint.gain * signal; 2];
        [self.state[ANGLE], self.state[MEASURED]] = [self.joint.start; 2];
    }

    fn integrate_to(&mut self, end_s: f64) {
        let dt = end_s - self.now_s;
        if dt <= 0.0 {
            return;
        }
        let (start, half) = (self.state, self.now_s + dt / 2.0);
        let k1 = self.rate(&start, self.now_s);
        let k2 = self.rate(&moved(&start, &k1, dt / 2.0), half);
        let k3 = self.rate(&moved(&start, &k2, dt / 2.0), half);
        let k4 = self.rate(&moved(&start, &k3, dt), end_s);
        for (i, state) in self.state.iter_mut().enumerate() {
            *state += dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
        self.now_s = end_s;
        if self.joint.effect.spool_lag.is_some() {
            self.open(self.state[FOLLOWED]);
        }
    }

    /// Derivative of `state` by time.
    fn rate(&self, state: &State, time_s: f64) -> State {
        let mut rate = [0.0; STATES];
        let opening = self.opened(state, &mut rate);
        let signal = self.loosened(opening, state, &mut rate);
        let signal = self.followed(signal, state, &mut rate);
        let speed = self.rung(self.joint.gain * signal, state, &mut rate);
        rate[ANGLE] = self.loaded(speed, state, time_s, &mut rate);
        if let Some(backlash) = self.joint.effect.backlash {
            rate[MEASURED] = backlash.rate(state[ANGLE], state[MEASURED], self.clock.substep_s());
        }
        rate
    }

    /// The opening of the valve, as far as its spool has come.
    fn opened(&self, state: &State, rate: &mut State) -> f64 {
        let Some(lag) = self.joint.effect.spool_lag else { return self.opening };
        rate[FOLLOWED] = lag.rate(self.command, state[FOLLOWED]);
        self.chain.opening(state[FOLLOWED])
    }

    /// The opening of the valve, nothing where the joint sticks.
    fn loosened(&self, opening: f64, state: &State, rate: &mut State) -> f64 {
        if self.joint.effect.stiction.is_none() {
            return opening;
        }
        let wanted = f64::from(u8::from(self.direction.abs() > 0.0));
        rate[CONTACT] = (wanted - state[CONTACT]) / (STEPS_TO_LOOSEN * self.clock.substep_s());
        state[CONTACT] * opening
    }

    /// The effects on how the speed follows, in input units.
    fn followed(&self, opening: f64, state: &State, rate: &mut State) -> f64 {
        let (effect, mut signal) = (&self.joint.effect, opening);
        let substep_s = self.clock.substep_s();
        if let Some(limit) = effect.rate_limit {
            rate[SPOOL] = limit.rate(signal, state[SPOOL], substep_s);
            signal = state[SPOOL];
        }
        if let Some(lag) = effect.actuator_lag {
            rate[LAG] = lag.rate(signal, state[LAG]);
            signal = state[LAG];
        }
        if let Some(resonance) = effect.resonance {
            let now = [state[PRESSURE], state[FLOW]];
            [rate[PRESSURE], rate[FLOW]] = resonance.rate(signal, now);
            signal = state[FLOW];
        }
        if let Some(column) = effect.oil_column {
            let now = [state[COLUMN_PRESSURE], state[COLUMN_FLOW]];
            let moved = column.rate(signal, now, state[ANGLE]);
            [rate[COLUMN_PRESSURE], rate[COLUMN_FLOW]] = moved;
            signal = state[COLUMN_FLOW];
        }
        if let Some(friction) = effect.friction() {
            let now = [state[MASS], state[FRICTION]];
            [rate[MASS], rate[FRICTION]] = friction.rate(signal, now, substep_s);
            signal = state[MASS];
        }
        if let Some(creep) = self.joint.outside.creep_memory {
            CreepMemory::rates(signal, &state[MEMORY], &mut rate[MEMORY]);
            signal = creep.out(signal, &state[MEMORY]);
        }
        signal
    }

    /// The plain lag and ringing, in output units per second.
    fn rung(&self, mut speed: f64, state: &State, rate: &mut State) -> f64 {
        if let Some(lag_s) = self.joint.lag_s {
            rate[LAGGED] = (speed - state[LAGGED]) / lag_s;
            speed = state[LAGGED];
        }
        let Some(Ringing { period_s, damping }) = self.joint.ringing else {
            return speed;
        };
        let omega = TAU / period_s;
        rate[RINGING] = state[SURGE];
        rate[SURGE] = omega * (omega * (speed - state[RINGING]) - 2.0 * damping * state[SURGE]);
        state[RINGING]
    }

    /// What the load leaves of a speed, and what it adds.
    fn loaded(&self, mut speed: f64, state: &State, time_s: f64, rate: &mut State) -> f64 {
        let (effect, outside) = (&self.joint.effect, &self.joint.outside);
        let (angle, substep_s) = (state[ANGLE], self.clock.substep_s());
        if let Some(drift) = effect.thermal_drift {
            rate[WARMTH] = drift.rate(state[WARMTH]);
            speed *= drift.factor(state[WARMTH]);
        }
        if let Some(droop) = effect.supply_droop {
            rate[DEMAND] = SupplyDroop::rate(self.others, state[DEMAND], substep_s);
            speed *= droop.factor(state[DEMAND]);
        }
        speed *= effect.position_gain.map_or(1.0, |linkage| linkage.factor(angle, self.radians));
        speed *= outside.sticky_spot.map_or(1.0, |spot| spot.factor(angle));
        if let Some(gravity) = effect.gravity_load {
            let edge = self.joint.gain.abs() * self.valve.edge();
            speed = gravity.speed(speed, angle, self.radians, edge);
        }
        speed += effect.leakage.map_or(0.0, |leakage| leakage.drift(angle));
        speed += outside.disturbance.map_or(0.0, |push| push.push(time_s));
        speed + effect.end_stop.map_or(0.0, |stop| stop.push(angle, substep_s))
    }
}

/// The experimenter tries each level out in advance, other joints staying as they are.
///
/// What no level can help does not count: only how far it goes beyond where it is when
/// the level begins to act.
impl Predictor for Motion<'_> {
    fn excess(&self, drive: &Drive, attempt: &Attempt) -> Result<f64, PlantError> {
        let Attempt { intent, range, end_s } = *attempt;
        let mut drive = drive.clone();
        drive.push(intent);
        let mut ahead = self.clone();
        let period_s = self.clock.period().seconds();
        let (mut allowed, mut excess) = (f64::INFINITY, 0.0_f64);
        let mut sample = self.clock.sample_at(self.now_s);
        while ahead.now_s < end_s {
            ahead.pass(sample, &drive, self.others);
            sample += 1;
            let outside = beyond(ahead.state[ANGLE], range);
            if ahead.now_s + period_s > intent.acts_s {
                allowed = allowed.min(outside);
                excess = excess.max(outside - allowed);
            }
        }
        Ok(excess)
    }

    /// A joint that coasts or creeps may have to leave its range.
    fn max_draws(&self) -> Option<usize> {
        Some(PATIENCE)
    }
}

/// How far `opening` is of what the largest level of `joint` opens.
fn share(opening: f64, chain: &StaticChain<'_>, joint: &JointSpec) -> f64 {
    let largest = joint.input.largest();
    let full = chain.opening(largest).abs().max(chain.opening(-largest).abs());
    if full > 0.0 { (opening.abs() / full).min(1.0) } else { 0.0 }
}

/// The demand of a joint without effects, at each sample.
pub(super) fn demands(joint: &JointSpec, drive: &Drive, clock: &Clock) -> Vec<f64> {
    let chain = StaticChain::of(joint);
    let mut pending = drive.arrivals().later().iter().peekable();
    let mut level = joint.input.initial();
    let demand = |sample| {
        let now_s = clock.time_s(sample);
        while let Some((index, _)) = pending.next_if(|(_, arrival)| arrival.time_s <= now_s) {
            level = drive.level_of(*index);
        }
        share(chain.opening(level), &chain, joint)
    };
    (1..=clock.samples()).map(demand).collect()
}

/// `state` after `dt` seconds of change at `rate`.
fn moved(state: &State, rate: &State, dt: f64) -> State {
    let mut moved = *state;
    for (state, rate) in moved.iter_mut().zip(rate) {
        *state += rate * dt;
    }
    moved
}

/// Radians in an angle of one `unit`; degrees where the unit is no angle.
fn radians(unit: &str) -> f64 {
    match unit {
        "rad" => 1.0,
        "mrad" => 1e-3,
        "turn" | "rev" => TAU,
        _ => 1_f64.to_radians(),
    }
}
