//! A machine that runs: its time, its state, and the levels on their way to it.

use super::machine::{Machine, State};

/// Sound of an integration that is still well: no pressure beyond this, in pascal.
const ABSURD_PRESSURE: f64 = 1e10;

/// A level on its way to the spool.
#[derive(Clone, Copy, Debug)]
struct Coming {
    index: usize,
    time_s: f64,
    level: f64,
}

/// Speed of the joint when the level of a step began to act.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrived {
    /// Number of the step, from 0.
    pub(super) index: usize,
    /// Radians per second.
    pub(super) speed: f64,
}

/// A running machine.
#[derive(Clone, Debug)]
pub(super) struct Rig {
    machine: Machine,
    longest_step_s: f64,
    now_s: f64,
    state: State,
    level: f64,
    coming: Vec<Coming>,
    arrived: Vec<Arrived>,
}

impl Rig {
    /// `machine` at time 0 in `state`, at `level`.
    pub(super) fn new(machine: &Machine, longest_step_s: f64, state: State, level: f64) -> Self {
        let (coming, arrived) = (Vec::new(), Vec::new());
        Self { machine: *machine, longest_step_s, now_s: 0.0, state, level, coming, arrived }
    }

    /// Lets step `index` to `level` act from `time_s` on; it must be the latest step.
    ///
    /// A later step that acts before an earlier one wins: the earlier level never comes
    /// back.
    pub(super) fn send(&mut self, index: usize, time_s: f64, level: f64) {
        while self.coming.pop_if(|earlier| earlier.time_s >= time_s).is_some() {}
        self.coming.push(Coming { index, time_s, level });
    }

    /// Runs until `until_s`; gives that time back, or the one at which the numbers ran away.
    pub(super) fn run(&mut self, until_s: f64) -> Result<(), f64> {
        while let Some(next) = self.coming.first().copied().filter(|next| next.time_s < until_s) {
            self.integrate(next.time_s)?;
            self.coming.remove(0);
            self.level = next.level;
            self.arrived.push(Arrived { index: next.index, speed: self.state.speed });
        }
        self.integrate(until_s)
    }

    /// What the machine is like now.
    pub(super) fn state(&self) -> &State {
        &self.state
    }

    /// The steps that acted so far.
    pub(super) fn arrived(&self) -> &[Arrived] {
        &self.arrived
    }

    /// The steps that are still on their way.
    pub(super) fn on_their_way(&self) -> impl Iterator<Item = usize> {
        self.coming.iter().map(|coming| coming.index)
    }

    /// Time steps of equal length until `until_s`, with the level held.
    fn integrate(&mut self, until_s: f64) -> Result<(), f64> {
        let left_s = until_s - self.now_s;
        // A hair less, so that rounding does not add a step.
        let steps = (left_s / self.longest_step_s - 1e-6).ceil().max(1.0);
        let dt = left_s / steps;
        let mut done = 0.0;
        while done < steps {
            self.state = self.machine.step(&self.state, self.level, dt);
            done += 1.0;
        }
        self.now_s = until_s;
        let pressures = self.state.pressures;
        let largest = pressures.piston.abs().max(pressures.rod.abs()).max(pressures.supply.abs());
        if self.state.is_finite() && largest < ABSURD_PRESSURE { Ok(()) } else { Err(until_s) }
    }
}
