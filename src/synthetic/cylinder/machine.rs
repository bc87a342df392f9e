//! All parts together: the differential equations, and their integration.

use super::CylinderSpec;
use super::linkage::Linkage;
use super::load::Load;
use super::oil::{Flows, Oil, Pressures};
use super::valve::Valve;

/// What changes by itself, in SI units.
#[derive(Clone, Copy, Debug)]
pub(in crate::synthetic) struct State {
    /// Place of the spool as a fraction of its stroke.
    pub(in crate::synthetic) spool: f64,
    /// Its speed.
    pub(in crate::synthetic) spool_speed: f64,
    /// Pressures of the oil.
    pub(in crate::synthetic) pressures: Pressures,
    /// Angle of the joint, in radians.
    pub(in crate::synthetic) angle: f64,
    /// Its speed.
    pub(in crate::synthetic) speed: f64,
}

/// The parts of one cylinder.
#[derive(Clone, Copy, Debug)]
pub(in crate::synthetic) struct Machine {
    pub(super) valve: Valve,
    pub(super) oil: Oil,
    pub(super) load: Load,
    pub(super) linkage: Linkage,
    ends: [f64; 2],
}

impl Machine {
    pub(in crate::synthetic) fn of(spec: &CylinderSpec) -> Self {
        let linkage = Linkage::of(spec);
        Self {
            valve: Valve::of(spec),
            oil: Oil::of(spec),
            load: Load::of(spec),
            linkage,
            ends: linkage.ends(),
        }
    }

    /// At rest at `angle`, held by the oil, with the spool where `input` sends it.
    pub(in crate::synthetic) fn rest(&self, angle: f64, input: f64) -> State {
        let force = self.load.weight(angle) / self.linkage.lever(angle);
        State {
            spool: self.valve.target(input),
            spool_speed: 0.0,
            pressures: self.oil.holding(force),
            angle,
            speed: 0.0,
        }
    }

    /// `state` after `dt` seconds with `input` held: Runge and Kutta's method of order four.
    pub(in crate::synthetic) fn step(&self, state: &State, input: f64, dt: f64) -> State {
        let k1 = self.rates(state, input);
        let k2 = self.rates(&state.moved(&k1, dt / 2.0), input);
        let k3 = self.rates(&state.moved(&k2, dt / 2.0), input);
        let k4 = self.rates(&state.moved(&k3, dt), input);
        let ends = state.moved(&k1, dt / 6.0).moved(&k4, dt / 6.0);
        ends.moved(&k2, dt / 3.0).moved(&k3, dt / 3.0)
    }

    /// Derivative of `state` by time.
    ///
    /// ```text
    /// J θ'' = lever × (p_A A - p_B α A - friction + ends) - m g l cos θ
    /// ```
    fn rates(&self, state: &State, input: f64) -> State {
        let lever = self.linkage.lever(state.angle);
        let speed = lever * state.speed;
        let [out, left] = self.ways(state.angle);
        let held = self.load.ends(out, left, speed) - self.load.friction(speed);
        let moment = lever * (self.oil.force(&state.pressures) + held);
        let flows = self.flows(state, input);
        let target = self.valve.target(input);
        let [spool, spool_speed] = self.valve.rates(state.spool, state.spool_speed, target);
        State {
            spool,
            spool_speed,
            pressures: self.oil.rates(&flows, self.oil.volumes(out, left), speed),
            angle: state.speed,
            speed: (moment - self.load.weight(state.angle)) / self.load.inertia,
        }
    }

    /// All flows in `state`.
    pub(super) fn flows(&self, state: &State, input: f64) -> Flows {
        let ports = self.valve.ports(state.spool, self.valve.target(input));
        self.oil.flows(&self.valve, ports, &state.pressures)
    }

    /// Ways of the piston from its inner end and to its outer one.
    pub(super) fn ways(&self, angle: f64) -> [f64; 2] {
        let length = self.linkage.length(angle);
        [length - self.ends[0], self.ends[1] - length]
    }

    /// A rate that none of the machine's exceeds, per second.
    pub(super) fn fastest_rate(&self) -> f64 {
        let mass = self.load.inertia / self.linkage.longest_lever().powi(2);
        let swing = (self.oil.stiffness() / mass).sqrt();
        self.oil.rate(&self.valve) + self.load.rate(mass) + self.valve.rate() + swing
    }
}

impl State {
    /// This state after `dt` seconds of change at `rate`.
    fn moved(&self, rate: &Self, dt: f64) -> Self {
        let (now, change) = (&self.pressures, &rate.pressures);
        Self {
            spool: self.spool + rate.spool * dt,
            spool_speed: self.spool_speed + rate.spool_speed * dt,
            pressures: Pressures {
                supply: now.supply + change.supply * dt,
                piston: now.piston + change.piston * dt,
                rod: now.rod + change.rod * dt,
            },
            angle: self.angle + rate.angle * dt,
            speed: self.speed + rate.speed * dt,
        }
    }

    /// Whether all numbers are finite.
    pub(in crate::synthetic) fn is_finite(&self) -> bool {
        let Pressures { supply, piston, rod } = self.pressures;
        let numbers = [self.spool, self.spool_speed, supply, piston, rod, self.angle, self.speed];
        numbers.iter().all(|number| number.is_finite())
    }
}
