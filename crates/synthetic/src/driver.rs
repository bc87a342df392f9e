//! The experimenter: which level is set at which sample.

use rand::RngExt as _;
use rand::seq::IndexedRandom as _;
use rand_chacha::ChaCha8Rng;

use crate::clock::Clock;
use crate::delay_law::Occasion;
use crate::drive::{Drive, Step};
use crate::error::{Place, PlantError};
use crate::input::{InputSpec, differ};
use crate::random::{Purpose, stream};
use crate::spec::JointSpec;
use crate::statics::Valve;

/// Draws of level and hold before a range is given up. With one draw in a hundred
/// acceptable, a thousand fail once in 20 000 steps.
const MAX_DRAWS: usize = 1000;

/// A step to be tried out in advance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    pub(crate) step: Step,
    /// Lowest and highest angle allowed from when it acts, in output units.
    pub(crate) range: [f64; 2],
    /// Until when, in seconds.
    pub(crate) end_s: f64,
}

/// How far `angle` is outside `range`.
pub(crate) fn beyond(angle: f64, [lowest, highest]: [f64; 2]) -> f64 {
    (lowest - angle).max(angle - highest).max(0.0)
}

/// A joint on its way through a record.
pub(crate) trait Moving {
    /// Lets the time until `sample` pass, with the levels of `drive`, while the other joints
    /// have their valves open by the part `others`.
    ///
    /// # Errors
    /// [`PlantError::Runaway`].
    fn run_to(&mut self, sample: usize, drive: &Drive, others: f64) -> Result<(), PlantError>;

    /// Angle as an ideal sensor shows it, in output units.
    fn shown(&self) -> f64;

    /// How far the valve is open now, as a part of what the largest level opens it; none of a
    /// joint with a pump of its own.
    fn demand(&mut self, _: &Drive) -> f64 {
        0.0
    }

    /// Change of speed that each step caused, in output units per second; none for one that
    /// was overtaken.
    fn speed_changes(&self, drive: &Drive) -> Vec<Option<f64>> {
        drive.speed_changes()
    }

    /// How far the joint, driven by `drive` and then by `attempt`, goes beyond its range, in
    /// output units.
    ///
    /// # Errors
    /// [`PlantError::Runaway`].
    fn excess(&self, drive: &Drive, attempt: &Attempt) -> Result<f64, PlantError>;

    /// Draws after which the level with the least excess is taken; none where a range that
    /// cannot be kept is an error.
    fn max_draws(&self) -> Option<usize> {
        None
    }
}

/// Makes a [`Drive`], step by step.
#[derive(Debug)]
pub(crate) struct Driver<'a> {
    joint: &'a JointSpec,
    clock: Clock,
    valve: Valve,
    delays: ChaCha8Rng,
    input: ChaCha8Rng,
    /// Sample of the next step; beyond the record where there is none.
    next: usize,
    drive: Drive,
}

impl<'a> Driver<'a> {
    /// The driver of `joint`, which has the number `index`, from 0.
    pub(crate) fn new(joint: &'a JointSpec, index: usize, seed: u64, clock: Clock) -> Self {
        let valve = Valve::of(joint);
        let initial = joint.input.initial();
        let drive = Drive::new(initial, valve.speed(initial), joint.start);
        let delays = stream(seed, index, Purpose::Delay);
        let input = stream(seed, index, Purpose::Input);
        let mut driver = Self { joint, clock, valve, delays, input, next: 0, drive };
        driver.next = match &joint.input {
            InputSpec::Steps { steps, .. } => next_of(steps, 0),
            InputSpec::Levels { hold_s, .. } => driver.draw_hold(*hold_s).saturating_add(1),
        };
        driver
    }

    /// Sets the step that is due at `sample`, if there is one.
    ///
    /// # Errors
    /// [`PlantError::Range`], [`PlantError::ListedDelays`] and [`PlantError::Runaway`].
    pub(crate) fn act(&mut self, sample: usize, moving: &dyn Moving) -> Result<(), PlantError> {
        if self.next != sample {
            return Ok(());
        }
        // Drawn before the level, so that draws refused cost no chance.
        let chance = self.delays.random();
        let joint = self.joint;
        let step = match &joint.input {
            InputSpec::Steps { steps, .. } => {
                let index = self.drive.steps().len();
                self.next = next_of(steps, index + 1);
                self.step(sample, steps[index].1, chance)?
            }
            InputSpec::Levels { levels, hold_s } => {
                let (step, hold) = self.draw(sample, levels, *hold_s, chance, moving)?;
                self.next = sample.saturating_add(hold);
                step
            }
        };
        self.drive.push(step);
        Ok(())
    }

    /// What it has made so far.
    pub(crate) fn drive(&self) -> &Drive {
        &self.drive
    }

    /// A step at `sample` and its hold in samples, that keep the range.
    fn draw(
        &mut self,
        sample: usize,
        levels: &[f64],
        hold_s: [f64; 2],
        chance: f64,
        moving: &dyn Moving,
    ) -> Result<(Step, usize), PlantError> {
        let now = self.drive.level();
        let others: Vec<f64> = levels.iter().copied().filter(|level| differ(*level, now)).collect();
        let mut best = None;
        for _ in 0..moving.max_draws().unwrap_or(MAX_DRAWS) {
            let hold = self.draw_hold(hold_s);
            let drawn = others.choose(&mut self.input).copied();
            let drawn = drawn.into_iter().flat_map(|level| [level, -level]);
            for level in drawn.filter(|level| differ(*level, now)) {
                let step = self.step(sample, level, chance)?;
                let excess = self.excess(step, hold, moving)?;
                if excess <= 0.0 {
                    return Ok((step, hold));
                }
                if best.is_none_or(|(least, _)| excess < least) {
                    best = Some((excess, (step, hold)));
                }
            }
        }
        let least = best.filter(|_| moving.max_draws().is_some()).map(|(_, drawn)| drawn);
        least.ok_or_else(|| PlantError::Range { place: Place::joint(&self.joint.name), sample })
    }

    /// A hold in samples, at least one.
    fn draw_hold(&mut self, [shortest, longest]: [f64; 2]) -> usize {
        let seconds = shortest + (longest - shortest) * self.input.random::<f64>();
        self.clock.samples_in(seconds).max(1)
    }

    /// How far the joint leaves its range with `step` until the next one acts, even if
    /// that one takes as long as any can.
    fn excess(&self, step: Step, hold: usize, moving: &dyn Moving) -> Result<f64, PlantError> {
        let Some(range) = self.joint.range else { return Ok(0.0) };
        let next_s = self.clock.time_s(step.sample.saturating_add(hold));
        let acts_s = next_s + self.joint.longest_delay_s();
        let end_s = acts_s.min(self.clock.time_s(self.clock.samples));
        moving.excess(&self.drive, &Attempt { step, range, end_s })
    }

    /// The step to `level` at `sample`.
    fn step(&self, sample: usize, after: f64, chance: f64) -> Result<Step, PlantError> {
        let (index, before) = (self.drive.steps().len(), self.drive.level());
        let (progress, time_s) = (self.clock.progress(sample), self.clock.time_s(sample));
        let held = sample - self.drive.steps().last().map_or(1, |step| step.sample);
        let held_s = held as f64 * self.clock.period_s;
        let at = Occasion { index, before, after, progress, chance, held_s, time_s };
        let delay_s = self.joint.delay_s(&at).ok_or_else(|| PlantError::ListedDelays {
            place: Place::joint(&self.joint.name),
            given: index,
            needed: index + 1,
        })?;
        let (acts_s, speed) = (time_s + delay_s, self.valve.speed(after));
        Ok(Step { sample, before, after, delay_s, acts_s, speed })
    }
}

/// Sample of the step with the number `index`, from 0.
fn next_of(steps: &[(usize, f64)], index: usize) -> usize {
    steps.get(index).map_or(usize::MAX, |(sample, _)| *sample)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::DelayLaw;
    use crate::motion::Motion;

    fn clock(samples: usize) -> Clock {
        Clock { period_s: 0.01, samples, substeps: 20 }
    }

    /// All steps of a plain `joint`.
    pub(crate) fn driven(joint: &JointSpec, clock: Clock) -> Result<Drive, PlantError> {
        let mut driver = Driver::new(joint, 0, 3, clock);
        let motion = Motion::new(joint, clock);
        for sample in 1..=clock.samples {
            driver.act(sample, &motion)?;
        }
        Ok(driver.drive)
    }

    fn wandering(hold_s: [f64; 2]) -> JointSpec {
        let levels = vec![-2.0, -1.0, 0.0, 1.0, 2.0];
        let law = DelayLaw::Uniform { min: 0.01, max: 0.8 };
        JointSpec::new("a", InputSpec::Levels { levels, hold_s }, law)
    }

    #[test]
    fn drawn_steps_change_the_level_and_hold_it_as_long_as_allowed() {
        let drive = driven(&wandering([0.9, 2.0]), clock(20_000)).unwrap();
        let samples = std::iter::once(1).chain(drive.steps().iter().map(|step| step.sample));
        let samples: Vec<usize> = samples.collect();
        assert!(samples.windows(2).all(|w| (90..=200).contains(&(w[1] - w[0]))));
        assert!(drive.steps().iter().all(|step| differ(step.before, step.after)));
        assert!(!differ(drive.steps()[0].before, 0.0));
        assert!(drive.steps().iter().all(|step| (0.01..0.8).contains(&step.delay_s)));
    }

    #[test]
    fn drawn_holds_and_levels_spread_over_all_that_is_allowed() {
        let drive = driven(&wandering([0.9, 2.0]), clock(200_000)).unwrap();
        let mut holds = drive.steps().windows(2).map(|w| w[1].sample - w[0].sample);
        let mean = holds.by_ref().sum::<usize>() as f64 / (drive.steps().len() - 1) as f64;
        // Some 1400 holds of deviation 32 samples: a standard error of 0.9.
        assert!((mean - 145.0).abs() < 4.0, "mean hold {mean}");
        let twos = drive.steps().iter().filter(|step| step.after > 1.5).count();
        let share = twos as f64 / drive.steps().len() as f64;
        assert!((share - 0.2).abs() < 0.04, "{share} at the highest level");
    }

    #[test]
    fn a_range_that_no_level_keeps_is_an_error() {
        let levels = vec![-1.0, 1.0];
        let input = InputSpec::Levels { levels, hold_s: [5.0, 5.0] };
        let law = DelayLaw::Constant { seconds: 0.0 };
        let joint = JointSpec { range: Some([-1.0, 1.0]), ..JointSpec::new("a", input, law) };
        let found = driven(&joint, clock(2000));
        assert!(matches!(found, Err(PlantError::Range { sample: 501, .. })));
    }

    #[test]
    fn given_steps_are_where_they_are_given() {
        let input = InputSpec::Steps { steps: vec![(3, 1.0), (5, -1.0)], initial: 0.5 };
        let joint = JointSpec::new("a", input, DelayLaw::Constant { seconds: 0.15 });
        let drive = driven(&joint, clock(6)).unwrap();
        let [first, second] = drive.steps() else { panic!("{drive:?}") };
        assert_eq!((second.sample, second.before, second.after), (5, 1.0, -1.0));
        assert_eq!((first.sample, first.before, first.after), (3, 0.5, 1.0));
        assert!((first.acts_s - 0.17).abs() < 1e-12 && (first.delay_s - 0.15).abs() < 1e-12);
    }

    #[test]
    fn drawn_steps_beyond_the_list_of_delays_are_an_error() {
        let joint = JointSpec {
            delay: DelayLaw::Listed { seconds: vec![0.1; 2] },
            ..wandering([0.9, 2.0])
        };
        let found = driven(&joint, clock(2000));
        assert!(matches!(found, Err(PlantError::ListedDelays { given: 2, needed: 3, .. })));
    }
}
