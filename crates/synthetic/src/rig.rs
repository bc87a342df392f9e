//! The cylinder of a joint on its way through a record: its time, its state, the level that acts.

use crate::clock::Clock;
use crate::cylinder::{CylinderSpec, Machine, Pressures, State};
use crate::drive::Drive;
use crate::driver::{Attempt, Moving, beyond};
use crate::error::{Place, PlantError};
use crate::spec::JointSpec;

/// Sound of an integration that is still well: no pressure beyond this, in pascal.
const ABSURD_PRESSURE: f64 = 1e10;

/// Time in which a cylinder has settled after a level began to act, in seconds: spool,
/// then a swing of the oil.
const SETTLING_S: f64 = 0.3;

/// A running machine.
#[derive(Clone, Debug)]
pub(crate) struct Rig<'a> {
    joint: &'a JointSpec,
    clock: Clock,
    machine: Machine,
    longest_step_s: f64,
    now_s: f64,
    state: State,
    level: f64,
    /// Speed of the joint when each level that acted so far began to, in radians per second.
    speeds: Vec<f64>,
}

impl<'a> Rig<'a> {
    /// The cylinder of `joint` at the first sample, at rest.
    pub(crate) fn new(joint: &'a JointSpec, cylinder: &CylinderSpec, clock: Clock) -> Self {
        let (machine, level) = (Machine::of(cylinder), joint.input.initial());
        Self {
            joint,
            clock,
            machine,
            longest_step_s: cylinder.time_step_s,
            now_s: 0.0,
            state: machine.rest(joint.start * joint.radians(), level),
            level,
            speeds: Vec::new(),
        }
    }

    /// Angle in output units.
    fn angle(&self) -> f64 {
        self.state.angle / self.joint.radians()
    }

    /// Runs until `until_s`, with the levels of `drive`.
    ///
    /// # Errors
    /// [`PlantError::Runaway`].
    fn run(&mut self, until_s: f64, drive: &Drive) -> Result<(), PlantError> {
        while let Some(arrival) = drive.later().get(self.speeds.len()) {
            if arrival.time_s >= until_s {
                break;
            }
            self.integrate(arrival.time_s)?;
            self.level = arrival.level;
            self.speeds.push(self.state.speed);
        }
        self.integrate(until_s)
    }

    /// Time steps of equal length until `until_s`, with the level held.
    fn integrate(&mut self, until_s: f64) -> Result<(), PlantError> {
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
        let Pressures { supply, piston, rod } = self.state.pressures;
        let largest = piston.abs().max(rod.abs()).max(supply.abs());
        if self.state.is_finite() && largest < ABSURD_PRESSURE {
            return Ok(());
        }
        Err(PlantError::Runaway { place: Place::joint(&self.joint.name), time_s: until_s })
    }
}

impl Moving for Rig<'_> {
    fn run_to(&mut self, sample: usize, drive: &Drive, _: f64) -> Result<(), PlantError> {
        self.run(self.clock.time_s(sample), drive)
    }

    fn shown(&self) -> f64 {
        self.joint.outside.shown(self.angle())
    }

    /// From the moment each step acts to the one the next does; zero for a step on its way.
    fn speed_changes(&self, drive: &Drive) -> Vec<Option<f64>> {
        let ends = self.speeds.iter().skip(1).chain([&self.state.speed]);
        let radians = self.joint.radians();
        let moved = self.speeds.iter().zip(ends).map(|(from, to)| (to - from) / radians);
        drive.by_step(moved.chain(std::iter::repeat(0.0)))
    }

    /// The experimenter tries each level out on a copy of the cylinder, until the next step
    /// acts and has settled; that of the first sample outside.
    ///
    /// Where the level before leads out of the range, this one must not lead further.
    fn excess(&self, drive: &Drive, attempt: &Attempt) -> Result<f64, PlantError> {
        let Attempt { step, range: [lowest, highest], end_s } = *attempt;
        let (mut drive, mut ahead) = (drive.clone(), self.clone());
        drive.push(step);
        let mut now_s = step.acts_s + SETTLING_S;
        ahead.run(now_s, &drive)?;
        let range = [lowest.min(ahead.angle()), highest.max(ahead.angle())];
        let end_s = end_s + SETTLING_S;
        while now_s < end_s {
            now_s = (now_s + self.clock.period_s).min(end_s);
            ahead.run(now_s, &drive)?;
            let excess = beyond(ahead.angle(), range);
            if excess > 0.0 {
                return Ok(excess);
            }
        }
        Ok(0.0)
    }
}
