//! The experimenter at the lever of a cylinder: steps, and the log of them.

use rand::RngExt as _;
use rand::seq::IndexedRandom as _;
use rand_chacha::ChaCha8Rng;

use super::super::clock::Clock;
use super::super::delay_law::Occasion;
use super::super::drive::{MAX_DRAWS, Step};
use super::super::error::{Place, PlantError};
use super::super::input::{InputSpec, differ};
use super::super::random::{Purpose, stream};
use super::super::spec::JointSpec;
use super::rig::Rig;
use super::{CylinderSpec, Machine, Ride};

/// Time in which a cylinder has settled after a level began to act, in seconds: spool,
/// then a swing of the oil.
const SETTLING_S: f64 = 0.3;

/// Drives one cylinder, step by step.
pub(super) struct Operator<'a> {
    joint: &'a JointSpec,
    cylinder: &'a CylinderSpec,
    clock: Clock,
    radians: f64,
    rig: Rig,
    delays: ChaCha8Rng,
    steps: Vec<Step>,
    angles: Vec<f64>,
}

impl<'a> Operator<'a> {
    /// At the lever of `joint`, which has the number `index`, from 0.
    pub(super) fn new(
        joint: &'a JointSpec,
        cylinder: &'a CylinderSpec,
        index: usize,
        seed: u64,
        clock: Clock,
    ) -> Self {
        let radians = radians_per_output_unit(joint);
        let machine = Machine::of(cylinder);
        let level = joint.input.initial();
        let rest = machine.rest(joint.start * radians, level);
        let rig = Rig::new(&machine, cylinder.time_step_s, rest, level);
        let delays = stream(seed, index, Purpose::Delay);
        Self {
            joint,
            cylinder,
            clock,
            radians,
            rig,
            delays,
            steps: Vec::new(),
            angles: vec![joint.start],
        }
    }

    /// Works through the record.
    pub(super) fn ride(mut self, input: &mut ChaCha8Rng) -> Result<Ride, PlantError> {
        match &self.joint.input {
            InputSpec::Steps { steps, .. } => {
                for &(sample, level) in steps {
                    self.watch(sample)?;
                    let chance = self.delays.random();
                    self.set(sample, level, chance)?;
                }
            }
            InputSpec::Levels { levels, hold_s } => self.wander(levels, *hold_s, input)?,
        }
        self.watch(self.clock.samples())?;
        let speed_changes = self.speed_changes();
        let (steps, angles) = (self.steps, self.angles);
        Ok(Ride { steps, angles, speed_changes })
    }

    /// Draws steps until the record ends.
    fn wander(
        &mut self,
        levels: &[f64],
        hold_s: [f64; 2],
        rng: &mut ChaCha8Rng,
    ) -> Result<(), PlantError> {
        let mut sample = self.draw_hold(hold_s, rng).saturating_add(1);
        while sample <= self.clock.samples() {
            self.watch(sample)?;
            let chance = self.delays.random();
            let (level, hold) = self.draw(sample, levels, hold_s, chance, rng)?;
            self.set(sample, level, chance)?;
            sample = sample.saturating_add(hold);
        }
        Ok(())
    }

    /// A level for `sample` and its hold in samples, that keep the range.
    fn draw(
        &self,
        sample: usize,
        levels: &[f64],
        hold_s: [f64; 2],
        chance: f64,
        rng: &mut ChaCha8Rng,
    ) -> Result<(f64, usize), PlantError> {
        let now = self.level();
        let others: Vec<f64> = levels.iter().copied().filter(|level| differ(*level, now)).collect();
        for _ in 0..MAX_DRAWS {
            let hold = self.draw_hold(hold_s, rng);
            let drawn = others.choose(rng).copied();
            for level in drawn.into_iter().flat_map(|level| [level, -level]) {
                if differ(level, now) && self.stays(sample, level, hold, chance)? {
                    return Ok((level, hold));
                }
            }
        }
        Err(PlantError::Range { place: self.place(), sample })
    }

    /// A hold in samples, at least one.
    fn draw_hold(&self, [shortest, longest]: [f64; 2], rng: &mut ChaCha8Rng) -> usize {
        let seconds = shortest + (longest - shortest) * rng.random::<f64>();
        self.clock.samples_in(seconds).max(1)
    }

    /// Whether the joint stays in its range at `level` until the next step acts and has
    /// settled: tried out on a copy of the cylinder.
    ///
    /// Where the level before leads out of the range, this one must not lead further.
    fn stays(
        &self,
        sample: usize,
        level: f64,
        hold: usize,
        chance: f64,
    ) -> Result<bool, PlantError> {
        let Some([lowest, highest]) = self.joint.range else {
            return Ok(true);
        };
        let mut trial = self.rig.clone();
        let acts_s = self.clock.time_s(sample) + self.delay_s(sample, level, chance)?;
        trial.send(self.steps.len(), acts_s, level);
        let mut now_s = acts_s + SETTLING_S;
        trial.run(now_s).map_err(|time_s| self.runaway(time_s))?;
        let begin = trial.state().angle / self.radians;
        let range = lowest.min(begin)..=highest.max(begin);
        let next_s = self.clock.time_s(sample.saturating_add(hold)) + self.longest_delay_s();
        let end_s = next_s.min(self.clock.time_s(self.clock.samples())) + SETTLING_S;
        while now_s < end_s {
            now_s = (now_s + self.clock.period().seconds()).min(end_s);
            trial.run(now_s).map_err(|time_s| self.runaway(time_s))?;
            if !range.contains(&(trial.state().angle / self.radians)) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Sets `level` at `sample`.
    fn set(&mut self, sample: usize, level: f64, chance: f64) -> Result<(), PlantError> {
        let delay_s = self.delay_s(sample, level, chance)?;
        let acts_s = self.clock.time_s(sample) + delay_s;
        self.rig.send(self.steps.len(), acts_s, level);
        self.steps.push(Step { sample, before: self.level(), after: level, delay_s });
        Ok(())
    }

    /// Delay of a step to `level` at `sample`, in seconds.
    fn delay_s(&self, sample: usize, level: f64, chance: f64) -> Result<f64, PlantError> {
        let (index, before) = (self.steps.len(), self.level());
        let progress = self.clock.progress(sample);
        let at = Occasion { index, before, after: level, progress, chance };
        let delay_s = self.joint.delay.delay_s(&at);
        let delay_s = delay_s.map(|seconds| seconds + self.cylinder.pilot_s(before, level));
        let (place, given, needed) = (self.place(), index, index + 1);
        delay_s.ok_or(PlantError::ListedDelays { place, given, needed })
    }

    /// A delay in seconds that no step exceeds.
    fn longest_delay_s(&self) -> f64 {
        self.joint.delay.longest_s() + self.cylinder.longest_pilot_s()
    }

    /// Lets time pass up to `sample`, with the angles on the way in the log.
    fn watch(&mut self, sample: usize) -> Result<(), PlantError> {
        for next in self.angles.len() + 1..=sample {
            self.rig.run(self.clock.time_s(next)).map_err(|time_s| self.runaway(time_s))?;
            self.angles.push(self.rig.state().angle / self.radians);
        }
        Ok(())
    }

    /// The level after the last step so far.
    fn level(&self) -> f64 {
        self.steps.last().map_or(self.joint.input.initial(), |step| step.after)
    }

    /// Change of speed from the moment each step acts to the one the next does, in output
    /// units per second; zero for a step on its way, none for one that was overtaken.
    fn speed_changes(&self) -> Vec<Option<f64>> {
        let mut changes = vec![None; self.steps.len()];
        let arrived = self.rig.arrived();
        let ends = arrived.iter().skip(1).map(|next| next.speed);
        let ends = ends.chain([self.rig.state().speed]);
        let moved =
            arrived.iter().zip(ends).map(|(a, end)| (a.index, (end - a.speed) / self.radians));
        for (index, change) in moved.chain(self.rig.on_their_way().map(|index| (index, 0.0))) {
            if let Some(slot) = changes.get_mut(index) {
                *slot = Some(change);
            }
        }
        changes
    }

    fn runaway(&self, time_s: f64) -> PlantError {
        PlantError::Runaway { place: self.place(), time_s }
    }

    fn place(&self) -> Place {
        Place::joint(&self.joint.name)
    }
}

/// Radians in the output's unit, which is `deg` or `rad`.
fn radians_per_output_unit(joint: &JointSpec) -> f64 {
    if joint.output_unit == "rad" { 1.0 } else { 1.0_f64.to_radians() }
}
