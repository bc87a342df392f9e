//! All parts together: the differential equations, and their integration.

use super::linkage::Linkage;
use super::load::Load;
use super::oil::{Flows, Oil, Pressures};
use super::spec::CylinderSpec;
use super::valve::Valve;

/// What changes by itself, in SI units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    /// Place of the spool as a fraction of its stroke.
    pub(crate) spool: f64,
    /// Its speed.
    pub(crate) spool_speed: f64,
    /// Pressures of the oil.
    pub(crate) pressures: Pressures,
    /// Angle of the joint, in radians.
    pub(crate) angle: f64,
    /// Its speed.
    pub(crate) speed: f64,
}

/// The parts of one cylinder.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Machine {
    pub(super) valve: Valve,
    pub(super) oil: Oil,
    pub(super) load: Load,
    pub(super) linkage: Linkage,
    ends: [f64; 2],
}

impl Machine {
    pub(crate) fn of(spec: &CylinderSpec) -> Self {
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
    pub(crate) fn rest(&self, angle: f64, input: f64) -> State {
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
    pub(crate) fn step(&self, state: &State, input: f64, dt: f64) -> State {
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
    pub(crate) fn is_finite(&self) -> bool {
        let Pressures { supply, piston, rod } = self.pressures;
        let numbers = [self.spool, self.spool_speed, supply, piston, rod, self.angle, self.speed];
        numbers.iter().all(|number| number.is_finite())
    }
}

#[cfg(test)]
mod tests {
    //! The machine against physics worked out by hand, and against what must be conserved.

    use std::f64::consts::PI;

    use super::*;
    use crate::Part;

    const STEP_S: f64 = 5e-5;

    /// Viscous friction of the default cylinder.
    const VISCOUS: f64 = 40e3;

    /// A cylinder with only `parts`.
    fn with(parts: &[Part]) -> CylinderSpec {
        CylinderSpec { only: Some(parts.to_vec()), ..CylinderSpec::default() }
    }

    /// A cylinder so viscous that the oil does not swing.
    fn damped(parts: &[Part]) -> CylinderSpec {
        CylinderSpec { viscous_n_s_m: 4e5, ..with(parts) }
    }

    /// Calls `see` at the start of each time step of `seconds` with `input` held.
    fn watch(
        machine: &Machine,
        mut state: State,
        input: f64,
        seconds: f64,
        mut see: impl FnMut(&State),
    ) -> State {
        for _ in 0..steps(seconds) {
            see(&state);
            state = machine.step(&state, input, STEP_S);
        }
        state
    }

    /// Time steps in `seconds`.
    fn steps(seconds: f64) -> usize {
        crate::clock::whole(seconds / STEP_S)
    }

    /// The state after `seconds` at rest at `degrees`, then at `input`.
    fn after(spec: &CylinderSpec, degrees: f64, input: f64, seconds: f64) -> State {
        let machine = Machine::of(spec);
        watch(&machine, machine.rest(degrees.to_radians(), 0.0), input, seconds, |_| ())
    }

    /// Means over a second in which the joint is driven steadily: the oil keeps swinging for
    /// a while.
    #[derive(Clone, Copy, Debug)]
    struct Cruise {
        angle: f64,
        speed: f64,
        piston_speed: f64,
        force: f64,
    }

    /// The second second at `input`, from rest at `degrees`.
    fn cruise(spec: &CylinderSpec, degrees: f64, input: f64) -> Cruise {
        let machine = Machine::of(spec);
        let start = after(spec, degrees, input, 1.0);
        let mut mean = Cruise { angle: 0.0, speed: 0.0, piston_speed: 0.0, force: 0.0 };
        let share = 1.0 / steps(1.0) as f64;
        watch(&machine, start, input, 1.0, |state| {
            mean.angle += share * state.angle;
            mean.speed += share * state.speed;
            mean.piston_speed += share * machine.linkage.lever(state.angle) * state.speed;
            mean.force += share * machine.oil.force(&state.pressures);
        });
        mean
    }

    #[track_caller]
    fn assert_near(found: f64, expected: f64, relative: f64) {
        let error = (found / expected - 1.0).abs();
        assert!(error < relative, "{found} is not {expected}, by {error:e}");
    }

    /// Numbers of the default cylinder, worked out apart from the code.
    mod hand {
        use super::PI;

        pub(super) const PISTON: f64 = PI * 0.1 * 0.1 / 4.0;
        pub(super) const ALPHA: f64 = 1.0 - 0.63 * 0.63;
        /// 30 l/min at 5 bar.
        pub(super) const CONDUCTANCE: f64 = 30e-3 / 60.0 / 707.106_781_2;
        pub(super) const SUPPLY: f64 = 200e5;
        pub(super) const TANK: f64 = 3e5;

        /// Speed out against `force`, the ports open by `opening`:
        /// `p_s - w - α (p_t + α² w) = F / A` with `w = (A v / K x)²`.
        pub(super) fn extend(opening: f64, force: f64) -> f64 {
            let w = (SUPPLY - ALPHA * TANK - force / PISTON) / (1.0 + ALPHA.powi(3));
            CONDUCTANCE * opening * w.sqrt() / PISTON
        }

        /// Speed in, helped by `force`: `α (p_s - α² w) - p_t - w = -F / A`.
        pub(super) fn retract(opening: f64, force: f64) -> f64 {
            let w = (ALPHA * SUPPLY - TANK + force / PISTON) / (1.0 + ALPHA.powi(3));
            CONDUCTANCE * opening * w.sqrt() / PISTON
        }
    }

    #[test]
    fn steady_speeds_are_those_of_orifices_and_areas() {
        let spec = with(&[Part::Asymmetry]);
        for opening in [0.1, 0.3, 0.5] {
            let out = cruise(&spec, -10.0, 10.0 * opening).piston_speed;
            assert_near(out, hand::extend(opening, VISCOUS * out), 2e-3);
            let inward = -cruise(&spec, 50.0, -10.0 * opening).piston_speed;
            assert_near(inward, hand::retract(opening, -VISCOUS * inward), 2e-3);
        }
    }

    #[test]
    fn the_rod_makes_it_faster_out_than_in_by_the_root_of_the_areas() {
        let spec = CylinderSpec { viscous_n_s_m: 1e4, ..with(&[Part::Asymmetry]) };
        let speed = |input: f64| cruise(&spec, 20.0, input).piston_speed.abs();
        // √(1 / α) but for tank pressure and viscous friction.
        assert_near(speed(3.0) / speed(-3.0), (1.0 / hand::ALPHA).sqrt(), 0.02);
        let alike = with(&[]);
        let speed = |input: f64| cruise(&alike, 20.0, input).piston_speed.abs();
        assert_near(speed(3.0) / speed(-3.0), 1.0, 1e-3);
    }

    #[test]
    fn gravity_slows_the_way_up_and_speeds_the_way_down_as_orifices_tell() {
        let spec = with(&[Part::Asymmetry, Part::Gravity]);
        let lever = Machine::of(&spec).linkage.lever(0.0);
        for (start, input) in [(-12.0, 3.0), (12.0, -3.0)] {
            let mean = cruise(&spec, start, input);
            let weight = 1000.0 * 9.80665 * 2.2 * mean.angle.cos() / lever;
            let force = weight + VISCOUS * mean.piston_speed;
            let expected =
                if input > 0.0 { hand::extend(0.3, force) } else { -hand::retract(0.3, force) };
            assert_near(mean.piston_speed, expected, 5e-3);
        }
    }

    #[test]
    fn a_closed_valve_holds_the_weight() {
        let all_but_leakage = [Part::Overlap, Part::Asymmetry, Part::Friction, Part::Gravity];
        let spec = with(&[&all_but_leakage[..], &[Part::Linkage]].concat());
        let state = after(&spec, 20.0, 0.0, 5.0);
        assert!((state.angle.to_degrees() - 20.0).abs() < 1e-6);
        // The triangle of 0.6 m and 1.5 m at 60° + 20°.
        let (sine, cosine) = 80_f64.to_radians().sin_cos();
        let side = (0.36 + 2.25 - 1.8 * cosine).sqrt();
        let force = 1000.0 * 9.80665 * 2.2 * 20_f64.to_radians().cos() / (0.9 * sine / side);
        let pressures = state.pressures;
        let held = hand::PISTON * (pressures.piston - hand::ALPHA * pressures.rod);
        assert_near(held, force, 1e-6);
    }

    #[test]
    fn leakage_lets_the_weight_sink_until_the_oil_is_pressed_equal() {
        let parts = [Part::Overlap, Part::Asymmetry, Part::Gravity];
        let tight = after(&with(&parts), 20.0, 0.0, 3.0).angle;
        let leaky = with(&[&parts[..], &[Part::Leakage]].concat());
        let sunk = (tight - after(&leaky, 20.0, 0.0, 3.0).angle).to_degrees();
        // The leakage tends to equal pressures: the rod's side gains what the piston's loses.
        assert!((0.001..1.0).contains(&sunk), "sunk by {sunk} degrees");
    }

    #[test]
    fn oil_that_flows_in_is_swept_or_compressed() {
        // Mass of a chamber: V exp(p / E), whose rate is the inflow times exp(p / E).
        let machine = Machine::of(&CylinderSpec::default());
        let modulus = 900e6;
        let mass = |state: &State| {
            let [out, left] = machine.ways(state.angle);
            let [piston, rod] =
                [0.8e-3 + hand::PISTON * out, 0.8e-3 + hand::PISTON * hand::ALPHA * left];
            let pressures = state.pressures;
            [piston * (pressures.piston / modulus).exp(), rod * (pressures.rod / modulus).exp()]
        };
        let mut state = machine.rest(0.2, 0.0);
        for input in [6.0, -4.0, 0.0, 2.0, -7.0] {
            let before = mass(&state);
            let (mut gained, mut last) = ([0.0; 2], None::<[f64; 2]>);
            let end = watch(&machine, state, input, 0.7, |at| {
                let flows = machine.flows(at, input);
                let now = [
                    flows.piston * (at.pressures.piston / modulus).exp(),
                    flows.rod * (at.pressures.rod / modulus).exp(),
                ];
                let from = last.unwrap_or(now);
                for side in 0..2 {
                    gained[side] += 0.5 * (from[side] + now[side]) * STEP_S;
                }
                last = Some(now);
            });
            let rest = machine.flows(&end, input);
            let rest =
                [rest.piston, rest.rod].into_iter().zip([end.pressures.piston, end.pressures.rod]);
            for (side, (flow, pressure)) in rest.enumerate() {
                let now = flow * (pressure / modulus).exp();
                gained[side] += 0.5 * (last.map_or(now, |last| last[side]) + now) * STEP_S;
            }
            for (side, change) in mass(&end).into_iter().zip(before).map(|(a, b)| a - b).enumerate()
            {
                // A fifth of a millilitre, of some hundred that flow.
                let error = (change - gained[side]).abs();
                assert!(error < 2e-7, "side {side} at {input} V: {change} and {}", gained[side]);
            }
            state = end;
        }
    }

    #[test]
    fn the_work_of_the_piston_is_in_the_speed_and_height_of_the_mass() {
        let spec = CylinderSpec { viscous_n_s_m: 0.0, ..CylinderSpec::default() };
        let spec = CylinderSpec { coulomb_n: 0.0, static_n: 0.0, ..spec };
        let machine = Machine::of(&spec);
        let energy = |state: &State| {
            let height = 2.2 * state.angle.sin();
            0.5 * 7000.0 * state.speed.powi(2) + 1000.0 * 9.80665 * height
        };
        let start = machine.rest(0.2, 0.0);
        let (mut work, mut last) = (0.0, None);
        let end = watch(&machine, start, 6.0, 1.0, |state| {
            // Force times the way that the triangle's third side grew.
            let force = machine.oil.force(&state.pressures);
            let length = machine.linkage.length(state.angle);
            if let Some((force_before, length_before)) = last {
                work += 0.5 * (force + force_before) * (length - length_before);
            }
            last = Some((force, length));
        });
        let gained = energy(&end) - energy(&start);
        assert!(gained > 1000.0);
        assert_near(work, gained, 1e-3);
    }

    #[test]
    fn the_pump_limits_the_speed() {
        let spec = with(&[Part::SupplyDroop]);
        let limited = cruise(&spec, 0.0, 10.0).piston_speed;
        // 100 l/min on the piston's area.
        assert_near(limited, 0.1 / 60.0 / hand::PISTON, 2e-3);
        assert!(cruise(&with(&[]), 0.0, 10.0).piston_speed > 1.15 * limited);
    }

    #[test]
    fn the_overlap_is_a_dead_zone() {
        let spec = with(&[Part::Overlap]);
        for (input, moves) in [(0.45, false), (-0.65, false), (0.7, true), (-0.9, true)] {
            let moved = after(&spec, 20.0, input, 2.0).angle.to_degrees() - 20.0;
            assert_eq!(moved.abs() > 0.1, moves, "{moved} degrees at {input} V");
        }
    }

    #[test]
    fn the_spool_makes_the_joint_late() {
        let way = |parts: &[Part]| cruise(&damped(parts), 0.0, 2.0);
        let (at_once, late) = (way(&[]), way(&[Part::SpoolLag]));
        let behind_s = (at_once.angle - late.angle) / at_once.speed;
        // A second-order lag trails a ramp by 2 damping / ω; the flow is not quite in proportion
        // to the opening while pressures build up.
        assert_near(behind_s, 2.0 * 0.8 / (2.0 * PI * 12.0), 0.03);
    }

    #[test]
    fn friction_costs_its_force() {
        let load = |parts: &[Part]| {
            let mean = cruise(&with(parts), 20.0, 3.0);
            mean.force - VISCOUS * mean.piston_speed
        };
        assert!(load(&[]).abs() < 50.0);
        assert_near(load(&[Part::Friction]), 2500.0, 0.02);
    }

    #[test]
    fn the_linkage_turns_the_joint_faster_on_a_short_lever() {
        let spec = damped(&[Part::Linkage]);
        let speed = |degrees: f64| cruise(&spec, degrees, 3.0);
        let (low, high) = (speed(-10.0), speed(40.0));
        let linkage = Machine::of(&spec).linkage;
        let expected = linkage.lever(low.angle) / linkage.lever(high.angle);
        assert!(expected > 1.15);
        assert_near(high.speed / low.speed, expected, 0.01);
    }

    #[test]
    fn the_ends_stop_it_softly() {
        let machine = Machine::of(&CylinderSpec::default());
        let mut furthest = 0.0_f64;
        let start = machine.rest(1.1, 0.0);
        let end = watch(&machine, start, 10.0, 3.0, |state| furthest = furthest.max(state.angle));
        assert!(end.speed.abs() < 1e-3);
        // At rest 160 kN on 1e8 N/m and a lever of 0.35 m: a quarter of a degree. It comes fast.
        let beyond = furthest.to_degrees() - 70.0;
        assert!((0.0..1.0).contains(&beyond), "{beyond} degrees beyond");
        assert!(end.pressures.piston < 201e5);
    }

    #[test]
    fn it_swings_at_the_frequency_of_its_oil() {
        // A closed valve: both chambers are springs. Pushed off, it swings about its rest.
        let spec = CylinderSpec { viscous_n_s_m: 0.0, ..with(&[Part::Overlap, Part::Asymmetry]) };
        let machine = Machine::of(&spec);
        let rest = machine.rest(0.4, 0.0);
        let pushed = State { speed: 0.01, ..rest };
        let (mut crossings, mut last, mut step) = (Vec::new(), pushed.angle, 0);
        watch(&machine, pushed, 0.0, 2.0, |state| {
            if (last < 0.4) != (state.angle < 0.4) {
                crossings.push(step);
            }
            last = state.angle;
            step += 1;
        });
        let swings = (crossings.len() - 1) as f64 / 2.0;
        let found = swings / (f64::from(crossings[crossings.len() - 1] - crossings[0]) * STEP_S);
        let [out, left] = machine.ways(0.4);
        let spring = |area: f64, way: f64| 900e6 * area * area / (0.8e-3 + area * way);
        let springs = spring(hand::PISTON, out) + spring(hand::PISTON * hand::ALPHA, left);
        let expected = (springs / 7000.0).sqrt() * machine.linkage.lever(0.4) / (2.0 * PI);
        assert_near(found, expected, 0.01);
    }
}
