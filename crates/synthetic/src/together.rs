//! All joints of a plant side by side: they share a pump, and see one another's demand, but for
//! cylinders, each of which has a pump of its own.

use super::clock::Clock;
use super::drive::{Driven, Driver};
use super::error::PlantError;
use super::motion::Motion;
use super::rig;
use super::spec::PlantSpec;

/// Drives all joints of `spec`, in their order.
///
/// # Errors
/// [`PlantError::Range`], [`PlantError::ListedDelays`] and [`PlantError::Runaway`].
pub(super) fn drive(spec: &PlantSpec, clock: Clock) -> Result<Vec<Driven>, PlantError> {
    let mut actors = Vec::new();
    for (index, joint) in spec.joints.iter().enumerate() {
        actors.push(match &joint.cylinder {
            Some(cylinder) => Actor::Cylinder(rig::ride(joint, cylinder, index, spec.seed, clock)?),
            None => Actor::Moving(Box::new(Moving {
                driver: Driver::new(joint, index, spec.seed, clock),
                motion: Motion::new(joint, clock),
                angles: Vec::new(),
            })),
        });
    }
    let sharing = spec.joints.iter().filter(|joint| joint.cylinder.is_none()).count();
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
    /// It has a pump of its own, so that it has run already.
    Cylinder(Driven),
    /// It runs with the others.
    Moving(Box<Moving<'a>>),
}

/// A joint without a cylinder.
struct Moving<'a> {
    driver: Driver<'a>,
    motion: Motion<'a>,
    angles: Vec<f64>,
}

impl Actor<'_> {
    /// Sets the step that is due at `sample`; its demand for oil there.
    fn act(&mut self, sample: usize) -> Result<f64, PlantError> {
        let Self::Moving(moving) = self else { return Ok(0.0) };
        let Moving { driver, motion, .. } = moving.as_mut();
        if driver.due() == Some(sample) {
            driver.act(sample, motion)?;
        }
        Ok(motion.demand(driver.drive()))
    }

    /// Lets the time from `sample` to the next pass.
    fn pass(&mut self, sample: usize, others: f64) {
        if let Self::Moving(moving) = self {
            let Moving { driver, motion, angles } = moving.as_mut();
            angles.push(motion.shown());
            motion.pass(sample, driver.drive(), others);
        }
    }

    fn driven(self) -> Driven {
        match self {
            Self::Cylinder(driven) => driven,
            // Each step gives it another steady speed.
            Self::Moving(moving) => {
                let drive = moving.driver.into_drive();
                Driven { speed_changes: drive.speed_changes(), drive, angles: moving.angles }
            }
        }
    }
}
