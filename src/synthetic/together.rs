//! All joints of a plant side by side: they share a pump, and see one another's demand, but for
//! cylinders, each of which has a pump of its own.

use super::clock::Clock;
use super::drive::{Drive, Driver};
use super::driven::Driven;
use super::dynamics;
use super::error::PlantError;
use super::motion::{self, Motion};
use super::rig;
use super::spec::{JointSpec, PlantSpec};

/// Drives all joints of `spec`, in their order.
///
/// # Errors
/// [`PlantError::Range`], [`PlantError::ListedDelays`] and [`PlantError::Runaway`].
pub(super) fn drive(spec: &PlantSpec, clock: Clock) -> Result<Vec<Driven>, PlantError> {
    let mut actors = Vec::new();
    for (index, joint) in spec.joints.iter().enumerate() {
        actors.push(Actor::new(joint, index, spec.seed, clock)?);
    }
    let sharing = spec.joints.iter().filter(|joint| joint.cylinder.is_none()).count();
    if spec.joints.iter().any(|joint| joint.effect.supply_droop.is_some()) {
        for (actor, joint) in actors.iter_mut().zip(&spec.joints) {
            actor.keep_demands(joint, &clock);
        }
    }
    let mut demands = vec![0.0; actors.len()];
    for sample in 1..=clock.samples() {
        for (actor, demand) in actors.iter_mut().zip(&mut demands) {
            *demand = actor.act(sample)?;
        }
        let sum: f64 = demands.iter().sum();
        let others = (sharing as f64 - 1.0).max(1.0);
        for (actor, demand) in actors.iter_mut().zip(&demands) {
            actor.pass(sample, (sum - demand) / others);
        }
    }
    Ok(actors.into_iter().map(Actor::driven).collect())
}

/// A joint of a plant.
enum Actor<'a> {
    /// It depends on no other one, so that it has run already; its demands are there
    /// where the pump is shared.
    Plain { driven: Driven, demands: Vec<f64> },
    /// It has a pump of its own, so that it has run already.
    Cylinder(Driven),
    /// It runs with the others.
    Hindered(Box<Hindered<'a>>),
}

/// A joint with effects.
struct Hindered<'a> {
    driver: Driver<'a>,
    motion: Motion<'a>,
    angles: Vec<f64>,
}

impl<'a> Actor<'a> {
    fn new(
        joint: &'a JointSpec,
        index: usize,
        seed: u64,
        clock: Clock,
    ) -> Result<Self, PlantError> {
        if let Some(cylinder) = &joint.cylinder {
            return Ok(Self::Cylinder(rig::ride(joint, cylinder, index, seed, clock)?));
        }
        if joint.is_plain() {
            let drive = Drive::of(joint, index, seed, clock)?;
            let angles = dynamics::angles(joint, drive.arrivals(), &clock);
            let driven = Driven::steadily(drive, angles);
            return Ok(Self::Plain { driven, demands: Vec::new() });
        }
        let driver = Driver::new(joint, index, seed, clock);
        let motion = Motion::new(joint, clock);
        Ok(Self::Hindered(Box::new(Hindered { driver, motion, angles: Vec::new() })))
    }

    /// Keeps the demands of a joint that has run already, which only a shared pump needs.
    fn keep_demands(&mut self, joint: &JointSpec, clock: &Clock) {
        if let Self::Plain { driven, demands } = self {
            *demands = motion::demands(joint, &driven.drive, clock);
        }
    }

    /// Sets the step that is due at `sample`; its demand for oil there.
    fn act(&mut self, sample: usize) -> Result<f64, PlantError> {
        match self {
            Self::Cylinder(_) => Ok(0.0),
            Self::Plain { demands, .. } => Ok(demands.get(sample - 1).copied().unwrap_or(0.0)),
            Self::Hindered(hindered) => {
                let Hindered { driver, motion, .. } = hindered.as_mut();
                if driver.due() == Some(sample) {
                    driver.act(sample, motion)?;
                }
                Ok(motion.demand())
            }
        }
    }

    /// Lets the time from `sample` to the next pass.
    fn pass(&mut self, sample: usize, others: f64) {
        if let Self::Hindered(hindered) = self {
            let Hindered { driver, motion, angles } = hindered.as_mut();
            angles.push(motion.shown());
            motion.pass(sample, driver.drive(), others);
        }
    }

    fn driven(self) -> Driven {
        match self {
            Self::Plain { driven, .. } | Self::Cylinder(driven) => driven,
            Self::Hindered(hindered) => {
                Driven::steadily(hindered.driver.into_drive(), hindered.angles)
            }
        }
    }
}
