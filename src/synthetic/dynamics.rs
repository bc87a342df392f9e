//! From steady speed to angle, in time steps finer than a sample.
//!
//! Runge and Kutta's method of order four over the pieces in which the command
//! is constant: a time step is split where a level begins to act. No fitted model
//! uses this code, so that data and model cannot share a mistake.

use std::f64::consts::TAU;

use super::arrivals::{Arrival, Arrivals};
use super::clock::Clock;
use super::spec::{JointSpec, Ringing};

/// Lag and ringing of a joint, with the equations
///
/// ```text
/// lag_s × w' = v - w                             v: commanded speed, w: after the lag
/// s'' = ω² (w - s) - 2 damping ω s'              ω = 2π / period_s, s: speed
/// angle' = s
/// ```
///
/// Without a lag w = v, without ringing s = w.
#[derive(Clone, Copy, Debug)]
struct Dynamics {
    lag_s: Option<f64>,
    ringing: Option<Ringing>,
}

#[derive(Clone, Copy, Debug)]
struct State {
    lagged: f64,
    speed: f64,
    acceleration: f64,
    angle: f64,
}

/// Angle of `joint` at each sample of `clock`, driven by `arrivals`.
///
/// The joint has long been at its first level: its speed is steady.
pub(super) fn angles(joint: &JointSpec, arrivals: &Arrivals, clock: &Clock) -> Vec<f64> {
    let dynamics = Dynamics { lag_s: joint.lag_s, ringing: joint.ringing };
    let mut pending = arrivals.later().iter().map(|(_, arrival)| arrival).peekable();
    let Arrival { speed: mut command, angle: start, .. } = arrivals.first();
    let mut state = State::steady(start, command);
    let mut angles = Vec::with_capacity(clock.samples());
    let mut now = 0.0;
    for sample in 1..=clock.samples() {
        angles.push(state.angle);
        for end in clock.substep_ends(sample) {
            while let Some(Arrival { time_s, speed, .. }) = pending.next_if(|a| a.time_s < end) {
                state = dynamics.step(state, command, time_s - now);
                (now, command) = (*time_s, *speed);
            }
            state = dynamics.step(state, command, end - now);
            now = end;
        }
    }
    angles
}

impl Dynamics {
    /// `state` after `dt` seconds with `command` held.
    fn step(&self, state: State, command: f64, dt: f64) -> State {
        let k1 = self.rate(state, command);
        let k2 = self.rate(state.moved(k1, dt / 2.0), command);
        let k3 = self.rate(state.moved(k2, dt / 2.0), command);
        let k4 = self.rate(state.moved(k3, dt), command);
        let ends = state.moved(k1, dt / 6.0).moved(k4, dt / 6.0);
        ends.moved(k2, dt / 3.0).moved(k3, dt / 3.0)
    }

    /// Derivative of `state` by time.
    fn rate(&self, state: State, command: f64) -> State {
        let lagged = self.lag_s.map_or(0.0, |lag_s| (command - state.lagged) / lag_s);
        let drive = if self.lag_s.is_some() { state.lagged } else { command };
        let Some(Ringing { period_s, damping }) = self.ringing else {
            return State { lagged, speed: 0.0, acceleration: 0.0, angle: drive };
        };
        let omega = TAU / period_s;
        let pull = omega * omega * (drive - state.speed);
        let acceleration = pull - 2.0 * damping * omega * state.acceleration;
        State { lagged, speed: state.acceleration, acceleration, angle: state.speed }
    }
}

impl State {
    /// At `angle`, moving steadily at `speed`.
    fn steady(angle: f64, speed: f64) -> Self {
        Self { lagged: speed, speed, acceleration: 0.0, angle }
    }

    /// This state after `dt` seconds of change at `rate`.
    fn moved(self, rate: Self, dt: f64) -> Self {
        Self {
            lagged: self.lagged + rate.lagged * dt,
            speed: self.speed + rate.speed * dt,
            acceleration: self.acceleration + rate.acceleration * dt,
            angle: self.angle + rate.angle * dt,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{DelayLaw, InputSpec};
    use super::*;
    use crate::units::SamplePeriod;

    /// Angles at 1 kHz for 4 s with the speed stepping from 0 to 10 at 0.5 s.
    fn step_response(lag_s: Option<f64>, ringing: Option<Ringing>) -> (Clock, Vec<f64>) {
        let input = InputSpec::Steps { steps: Vec::new(), initial: 0.0 };
        let law = DelayLaw::Constant { seconds: 0.0 };
        let joint = JointSpec { lag_s, ringing, ..JointSpec::new("a", input, law) };
        let clock = Clock::new(SamplePeriod::from_seconds(1e-3).unwrap(), 4000, 20);
        let mut arrivals = Arrivals::new(0.0, 0.0);
        arrivals.push(0, 0.5, 10.0);
        (clock, angles(&joint, &arrivals, &clock))
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
        let input = InputSpec::Steps { steps: Vec::new(), initial: 0.0 };
        let law = DelayLaw::Constant { seconds: 0.0 };
        let joint = JointSpec { lag_s: Some(0.1), ..JointSpec::new("a", input, law) };
        let clock = Clock::new(SamplePeriod::from_seconds(0.01).unwrap(), 11, 20);
        let angles = angles(&joint, &Arrivals::new(3.0, 5.0), &clock);
        assert!((angles[10] - 3.5).abs() < 1e-12);
    }
}
