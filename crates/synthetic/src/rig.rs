//! The cylinder of a joint on its way through a record: its time, its state, the level that acts.

use super::clock::Clock;
use super::cylinder::{CylinderSpec, Machine, State};
use super::drive::{Attempt, Drive, Driven, Driver, Predictor, beyond};
use super::error::{Place, PlantError};
use super::spec::JointSpec;

/// Sound of an integration that is still well: no pressure beyond this, in pascal.
const ABSURD_PRESSURE: f64 = 1e10;

/// Time in which a cylinder has settled after a level began to act, in seconds: spool,
/// then a swing of the oil.
const SETTLING_S: f64 = 0.3;

/// Drives `joint`, which has the number `index`, by its `cylinder`.
///
/// # Errors
/// [`PlantError::Range`], [`PlantError::ListedDelays`] and [`PlantError::Runaway`].
pub(super) fn ride(
    joint: &JointSpec,
    cylinder: &CylinderSpec,
    index: usize,
    seed: u64,
    clock: Clock,
) -> Result<Driven, PlantError> {
    let mut driver = Driver::new(joint, index, seed, clock);
    let mut rig = Rig::new(joint, cylinder, clock);
    let mut angles = Vec::new();
    for sample in 1..=clock.samples() {
        rig.run(clock.time_s(sample), driver.drive())?;
        angles.push(joint.outside.shown(rig.angle()));
        if driver.due() == Some(sample) {
            driver.act(sample, &rig)?;
        }
    }
    let speed_changes = rig.speed_changes(driver.drive());
    Ok(Driven { drive: driver.into_drive(), speed_changes, angles })
}

/// A running machine.
#[derive(Clone, Debug)]
struct Rig<'a> {
    joint: &'a JointSpec,
    clock: Clock,
    machine: Machine,
    longest_step_s: f64,
    /// Radians in the unit of the output.
    radians: f64,
    now_s: f64,
    state: State,
    level: f64,
    /// Speed of the joint when each level that acted so far began to, in radians per second.
    speeds: Vec<f64>,
}

impl<'a> Rig<'a> {
    /// The cylinder of `joint` at the first sample, at rest.
    fn new(joint: &'a JointSpec, cylinder: &CylinderSpec, clock: Clock) -> Self {
        let machine = Machine::of(cylinder);
        let radians = joint.radians();
        let level = joint.input.initial();
        Self {
            joint,
            clock,
            machine,
            longest_step_s: cylinder.time_step_s,
            radians,
            now_s: 0.0,
            state: machine.rest(joint.start * radians, level),
            level,
            speeds: Vec::new(),
        }
    }

    /// Angle in output units.
    fn angle(&self) -> f64 {
        self.state.angle / self.radians
    }

    /// Runs until `until_s`, with the levels of `drive`.
    ///
    /// # Errors
    /// [`PlantError::Runaway`].
    fn run(&mut self, until_s: f64, drive: &Drive) -> Result<(), PlantError> {
        while let Some((index, arrival)) = drive.arrivals().later().get(self.speeds.len()) {
            if arrival.time_s >= until_s {
                break;
            }
            self.integrate(arrival.time_s)?;
            self.level = drive.level_of(*index);
            self.speeds.push(self.state.speed);
        }
        self.integrate(until_s)
    }

    /// Change of speed from the moment each step of `drive` acts to the one the next does,
    /// in output units per second; zero for a step on its way, none for one that was
    /// overtaken.
    fn speed_changes(&self, drive: &Drive) -> Vec<Option<f64>> {
        let ends = self.speeds.iter().skip(1).chain([&self.state.speed]);
        let moved = self.speeds.iter().zip(ends).map(|(from, to)| (to - from) / self.radians);
        let indices = drive.arrivals().later().iter().map(|(index, _)| *index);
        drive.by_step(indices.zip(moved.chain(std::iter::repeat(0.0))))
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
        let pressures = self.state.pressures;
        let largest = pressures.piston.abs().max(pressures.rod.abs()).max(pressures.supply.abs());
        if self.state.is_finite() && largest < ABSURD_PRESSURE {
            return Ok(());
        }
        Err(PlantError::Runaway { place: Place::joint(&self.joint.name), time_s: until_s })
    }
}

/// The experimenter tries each level out on a copy of the cylinder, until the next step
/// acts and has settled.
///
/// Where the level before leads out of the range, this one must not lead further.
impl Predictor for Rig<'_> {
    /// That of the first sample outside, which is enough without `max_draws`.
    fn excess(&self, drive: &Drive, attempt: &Attempt) -> Result<f64, PlantError> {
        let Attempt { intent, range, end_s } = *attempt;
        let mut drive = drive.clone();
        drive.push(intent);
        let mut ahead = self.clone();
        let mut now_s = intent.acts_s + SETTLING_S;
        ahead.run(now_s, &drive)?;
        let range = [range[0].min(ahead.angle()), range[1].max(ahead.angle())];
        let end_s = end_s + SETTLING_S;
        while now_s < end_s {
            now_s = (now_s + self.clock.period_s()).min(end_s);
            ahead.run(now_s, &drive)?;
            let excess = beyond(ahead.angle(), range);
            if excess > 0.0 {
                return Ok(excess);
            }
        }
        Ok(0.0)
    }

    /// Never: a range that cannot be kept is an error.
    fn max_draws(&self) -> Option<usize> {
        None
    }
}
