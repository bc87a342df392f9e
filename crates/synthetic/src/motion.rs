//! A joint with its effects, in time steps finer than a sample.
//!
//! Everything that moves or remembers is one state of a single system of differential equations,
//! integrated by Runge and Kutta's method of order four over the pieces in which the command is
//! constant: a time step is split where a level begins to act. No fitted model uses this code, so
//! that data and model cannot share a mistake.

use crate::clock::Clock;
use crate::drive::Drive;
use crate::driver::{Attempt, Moving, beyond};
use crate::effects::{At, Instance, Stage, States};
use crate::error::PlantError;
use crate::spec::JointSpec;
use crate::statics::Valve;

/// All that moves or remembers.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Angle of the joint.
    angle: f64,
    /// The states of its effects.
    of_effects: [States; MOST_EFFECTS],
}

/// As many effects as can act beside one another, but for those of delay and valve.
const MOST_EFFECTS: usize = 20;

/// Draws of a level before the one that goes least beyond the range is taken: a joint that
/// coasts or creeps may have to leave it.
const PATIENCE: usize = 20;

/// A joint on its way through a record.
#[derive(Clone, Debug)]
pub(crate) struct Motion<'a> {
    joint: &'a JointSpec,
    clock: Clock,
    valve: Valve,
    effects: Vec<Instance>,
    /// What the effects see of it.
    at: At,
    /// Whether the spool follows its command with time.
    has_spool: bool,
    /// Arrivals that act already.
    arrived: usize,
    /// The sample that it has come to.
    sample: usize,
    now_s: f64,
    /// What is commanded, in input units.
    command: f64,
    /// Opening of the valve, in input units.
    opening: f64,
    state: State,
}

impl<'a> Motion<'a> {
    /// The joint at the first sample; its first level has long been held.
    pub(crate) fn new(joint: &'a JointSpec, clock: Clock) -> Self {
        let valve = Valve::of(joint);
        let moving = |one: &Instance| !matches!(one.twin.stage, Stage::Delay | Stage::Valve);
        let effects: Vec<_> = joint.effects().filter(moving).collect();
        let mut motion = Self {
            joint,
            clock,
            at: At { radians: joint.radians(), substep_s: clock.substep_s(), ..valve.edges() },
            has_spool: effects.iter().any(|effect| effect.twin.stage == Stage::Spool),
            valve,
            effects,
            arrived: 0,
            sample: 1,
            now_s: 0.0,
            command: joint.input.initial(),
            opening: 0.0,
            state: State { angle: joint.start, ..State::default() },
        };
        motion.settle();
        motion
    }

    /// Lets the time until the next sample pass.
    fn pass(&mut self, drive: &Drive) {
        for end_s in self.clock.substep_ends(self.sample) {
            self.arrive(end_s, drive);
            self.integrate_to(end_s);
        }
        self.sample += 1;
    }

    /// Lets the levels of `drive` act that begin to before `end_s`.
    fn arrive(&mut self, end_s: f64, drive: &Drive) {
        while let Some(arrival) = drive.later().get(self.arrived) {
            if arrival.time_s >= end_s {
                break;
            }
            self.integrate_to(arrival.time_s);
            self.command = arrival.level;
            self.open();
            self.arrived += 1;
        }
    }

    /// Opens the valve as far as its spool has come.
    fn open(&mut self) {
        let at = self.at_angle(&self.state, self.now_s);
        let level =
            self.behind(Stage::Spool, self.command, &at, &self.state, &mut State::default());
        self.at.direction = self.valve.direction(level, self.at.direction);
        self.opening = self.valve.opening(level);
    }

    /// Puts what moves into the state that a level long held has brought about.
    fn settle(&mut self) {
        self.settle_behind(Stage::Spool, self.command);
        self.open();
        let signal = self.settle_behind(Stage::Dynamics, self.opening);
        self.settle_behind(Stage::Speed, self.joint.gain * signal);
        self.settle_behind(Stage::Sensor, self.joint.start);
    }

    /// Settles the effects of a stage; the signal after them where `signal` has long been held.
    fn settle_behind(&mut self, stage: Stage, signal: f64) -> f64 {
        let at = self.at_angle(&self.state, self.now_s);
        let effects = self.effects.iter().zip(&mut self.state.of_effects);
        let effects = effects.filter(|(effect, _)| effect.twin.stage == stage);
        effects.fold(signal, |signal, (effect, own)| effect.settle(signal, &at, own))
    }

    fn integrate_to(&mut self, end_s: f64) {
        let dt = end_s - self.now_s;
        if dt <= 0.0 {
            return;
        }
        let (start, half_s) = (self.state, self.now_s + dt / 2.0);
        let k1 = self.rate(&start, self.now_s);
        let k2 = self.rate(&self.moved(&start, &k1, dt / 2.0), half_s);
        let k3 = self.rate(&self.moved(&start, &k2, dt / 2.0), half_s);
        let k4 = self.rate(&self.moved(&start, &k3, dt), end_s);
        let mean = |k1, k2, k3, k4| dt / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        self.state.angle += mean(k1.angle, k2.angle, k3.angle, k4.angle);
        for (effect, own) in self.state.of_effects.iter_mut().enumerate().take(self.effects.len()) {
            let [k1, k2, k3, k4] = [&k1, &k2, &k3, &k4].map(|rate| &rate.of_effects[effect]);
            for (i, state) in own.iter_mut().enumerate() {
                *state += mean(k1[i], k2[i], k3[i], k4[i]);
            }
        }
        self.now_s = end_s;
        if self.has_spool {
            self.open();
        }
    }

    /// `state` after `dt` seconds of change at `rate`.
    fn moved(&self, state: &State, rate: &State, dt: f64) -> State {
        let mut moved = *state;
        moved.angle += rate.angle * dt;
        let own = moved.of_effects.iter_mut().zip(&rate.of_effects).take(self.effects.len());
        for (state, rate) in own.flat_map(|(state, rate)| state.iter_mut().zip(rate)) {
            *state += rate * dt;
        }
        moved
    }

    /// Derivative of `state` by time.
    fn rate(&self, state: &State, time_s: f64) -> State {
        let mut rate = State::default();
        let at = self.at_angle(state, time_s);
        let mut behind = |stage, signal| self.behind(stage, signal, &at, state, &mut rate);
        let opening = if self.has_spool {
            self.valve.opening(behind(Stage::Spool, self.command))
        } else {
            self.opening
        };
        let speed = self.joint.gain * behind(Stage::Dynamics, opening);
        let driven = behind(Stage::Speed, speed);
        let moves = behind(Stage::Load, driven);
        behind(Stage::Sensor, state.angle);
        rate.angle = moves;
        rate
    }

    /// What the effects of a stage make of `signal`, and the derivatives of their states.
    fn behind(&self, stage: Stage, signal: f64, at: &At, state: &State, rate: &mut State) -> f64 {
        let own = state.of_effects.iter().zip(&mut rate.of_effects);
        let effects = self.effects.iter().zip(own);
        let effects = effects.filter(|(effect, _)| effect.twin.stage == stage);
        effects.fold(signal, |signal, (effect, (own, rate))| effect.act(signal, at, own, rate))
    }

    /// What the effects see of the joint in this state.
    fn at_angle(&self, state: &State, time_s: f64) -> At {
        At { time_s, angle: state.angle, ..self.at }
    }
}

impl Moving for Motion<'_> {
    fn run_to(&mut self, sample: usize, drive: &Drive, others: f64) -> Result<(), PlantError> {
        self.at.others = others;
        while self.sample < sample {
            self.pass(drive);
        }
        Ok(())
    }

    fn shown(&self) -> f64 {
        let at = self.at_angle(&self.state, self.now_s);
        self.behind(Stage::Sensor, self.state.angle, &at, &self.state, &mut State::default())
    }

    /// A level that begins to act now counts.
    fn demand(&mut self, drive: &Drive) -> f64 {
        self.arrive(self.now_s.next_up(), drive);
        self.valve.share(self.opening)
    }

    /// The experimenter tries each level out in advance, other joints staying as they are.
    ///
    /// What no level can help does not count: only how far it goes beyond where it is when
    /// the level begins to act.
    fn excess(&self, drive: &Drive, attempt: &Attempt) -> Result<f64, PlantError> {
        let Attempt { step, range, end_s } = *attempt;
        if self.joint.is_plain() {
            // Without inertia and load: known beforehand.
            let from = drive.angle_at(step.acts_s);
            let to = from + step.speed * (end_s - step.acts_s).max(0.0);
            return Ok(beyond(from, range).max(beyond(to, range)));
        }
        let (mut drive, mut ahead) = (drive.clone(), self.clone());
        drive.push(step);
        let (mut allowed, mut excess) = (f64::INFINITY, 0.0_f64);
        while ahead.now_s < end_s {
            ahead.pass(&drive);
            let outside = beyond(ahead.state.angle, range);
            if ahead.now_s + self.clock.period_s > step.acts_s {
                allowed = allowed.min(outside);
                excess = excess.max(outside - allowed);
            }
        }
        Ok(excess)
    }

    fn max_draws(&self) -> Option<usize> {
        (!self.joint.is_plain()).then_some(PATIENCE)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::{DelayLaw, InputSpec, Ringing};

    /// Angles at 1 kHz for 4 s with the input stepping from 0 to 1 at 0.5 s, at a gain of 10.
    fn step_response(lag_s: Option<f64>, ringing: Option<Ringing>) -> (Clock, Vec<f64>) {
        let input = InputSpec::Steps { steps: vec![(501, 1.0)], initial: 0.0 };
        let law = DelayLaw::Constant { seconds: 0.0 };
        let joint = JointSpec { lag_s, ringing, ..JointSpec::new("a", input, law) };
        let clock = Clock { period_s: 1e-3, samples: 4000, substeps: 20 };
        (clock, angles(&joint, clock))
    }

    fn angles(joint: &JointSpec, clock: Clock) -> Vec<f64> {
        let drive = crate::driver::tests::driven(joint, clock).unwrap();
        let mut motion = Motion::new(joint, clock);
        let angle = |sample| {
            motion.run_to(sample, &drive, 0.0).unwrap();
            motion.shown()
        };
        (1..=clock.samples).map(angle).collect()
    }

    #[test]
    fn all_effects_together_find_their_place() {
        let moving = crate::effects::REGISTRY
            .iter()
            .filter(|row| !matches!(row.twin.stage, Stage::Delay | Stage::Valve));
        // With a plain lag and ringing, and one of two frictions.
        assert!(moving.count() + 2 - 1 <= MOST_EFFECTS);
    }

    #[test]
    fn a_lag_follows_its_closed_form() {
        let (clock, angles) = step_response(Some(0.1), None);
        for sample in [501, 520, 600, 900, 4000] {
            let t = clock.time_s(sample) - 0.5;
            let expected = 10.0 * (t - 0.1 * (1.0 - (-t / 0.1).exp()));
            assert!((angles[sample - 1] - expected).abs() < 1e-9, "sample {sample}");
        }
    }

    /// 1-based samples and heights of the peaks of the speed above the steady one.
    fn peaks(angles: &[f64]) -> Vec<(usize, f64)> {
        let speeds: Vec<f64> = angles.windows(2).map(|w| (w[1] - w[0]) * 1e3 - 10.0).collect();
        let tops = (1..speeds.len() - 1).filter(|k| {
            speeds[*k] > 1e-3 && speeds[*k] > speeds[k - 1] && speeds[*k] >= speeds[k + 1]
        });
        tops.map(|k| (k + 1, speeds[k])).collect()
    }

    #[test]
    fn ringing_has_its_period_and_decay() {
        let (period_s, damping) = (0.4, 0.1);
        let (_, angles) = step_response(None, Some(Ringing { period_s, damping }));
        let peaks = peaks(&angles);
        let root = (1.0_f64 - damping * damping).sqrt();
        // Peaks are found to a sample, here 1 ms.
        let spacing = (peaks[3].0 - peaks[0].0) as f64 * 1e-3 / 3.0;
        assert!((spacing - period_s / root).abs() < 1e-3, "peaks {spacing} s apart");
        // A mean over 1 ms near a peak differs from its top by some 1e-5 of it.
        let decay = (peaks[0].1 / peaks[1].1).ln();
        assert!((decay - TAU * damping / root).abs() < 1e-3, "decays by {decay}");
    }

    #[test]
    fn a_joint_that_already_moves_starts_steady() {
        let input = InputSpec::Steps { steps: Vec::new(), initial: 0.5 };
        let law = DelayLaw::Constant { seconds: 0.0 };
        let joint = JointSpec { lag_s: Some(0.1), start: 3.0, ..JointSpec::new("a", input, law) };
        let clock = Clock { period_s: 0.01, samples: 11, substeps: 20 };
        assert!((angles(&joint, clock)[10] - 3.5).abs() < 1e-12);
    }
}
