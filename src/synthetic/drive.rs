//! The experimenter: which level is set at which sample, and when it acts.

use rand::RngExt as _;
use rand::seq::IndexedRandom as _;
use rand_chacha::ChaCha8Rng;

use super::arrivals::Arrivals;
use super::clock::Clock;
use super::delay_law::Occasion;
use super::error::{Place, PlantError};
use super::input::{InputSpec, differ};
use super::random::{Purpose, stream};
use super::spec::JointSpec;
use super::statics::StaticChain;

/// Draws of level and hold before a range is given up. With one draw in a hundred
/// acceptable, a thousand fail once in 20 000 steps.
pub(super) const MAX_DRAWS: usize = 1000;

/// One step of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// 1-based number of the sample that first shows the new level.
    pub(super) sample: usize,
    /// Level before.
    pub(super) before: f64,
    /// Level after.
    pub(super) after: f64,
    /// Seconds until it acts.
    pub(super) delay_s: f64,
}

/// All steps of one joint, and when they act.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    steps: Vec<Step>,
    arrivals: Arrivals,
    initial: f64,
}

impl Drive {
    /// Drives `joint`, which has the number `index`, from 0.
    ///
    /// # Errors
    /// [`PlantError::Range`] and [`PlantError::ListedDelays`].
    pub(super) fn of(
        joint: &JointSpec,
        index: usize,
        seed: u64,
        clock: Clock,
    ) -> Result<Self, PlantError> {
        let mut driver = Driver::new(joint, clock, stream(seed, index, Purpose::Delay));
        match &joint.input {
            InputSpec::Steps { steps, .. } => {
                for &(sample, level) in steps {
                    let chance = driver.delays.random();
                    driver.set(sample, level, chance)?;
                }
            }
            InputSpec::Levels { levels, hold_s } => {
                let mut input = stream(seed, index, Purpose::Input);
                driver.wander(levels, *hold_s, &mut input)?;
            }
        }
        Ok(driver.drive)
    }

    /// The steps, in the order of time.
    pub(super) fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// When they act.
    pub(super) fn arrivals(&self) -> &Arrivals {
        &self.arrivals
    }

    /// The input at each of `samples` samples, in input units.
    pub(super) fn input(&self, samples: usize) -> Vec<f64> {
        held(&self.steps, self.initial, samples)
    }

    /// The level after the last step so far.
    fn level(&self) -> f64 {
        self.steps.last().map_or(self.initial, |step| step.after)
    }
}

/// The level at each of `samples` samples: `initial`, then what `steps` set.
pub(super) fn held(steps: &[Step], initial: f64, samples: usize) -> Vec<f64> {
    let mut steps = steps.iter().peekable();
    let mut level = initial;
    let levels = (1..=samples).map(|sample| {
        if let Some(step) = steps.next_if(|step| step.sample == sample) {
            level = step.after;
        }
        level
    });
    levels.collect()
}

/// Makes a [`Drive`], step by step.
struct Driver<'a> {
    joint: &'a JointSpec,
    clock: Clock,
    chain: StaticChain,
    delays: ChaCha8Rng,
    drive: Drive,
}

impl<'a> Driver<'a> {
    fn new(joint: &'a JointSpec, clock: Clock, delays: ChaCha8Rng) -> Self {
        let chain = StaticChain::of(joint);
        let initial = joint.input.initial();
        let arrivals = Arrivals::new(joint.start, chain.speed(initial));
        let drive = Drive { steps: Vec::new(), arrivals, initial };
        Self { joint, clock, chain, delays, drive }
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
            // Drawn before the level, so that draws refused cost no chance.
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
        let now = self.drive.level();
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
        Err(PlantError::Range { place: Place::joint(&self.joint.name), sample })
    }

    /// A hold in samples, at least one.
    fn draw_hold(&self, [shortest, longest]: [f64; 2], rng: &mut ChaCha8Rng) -> usize {
        let seconds = shortest + (longest - shortest) * rng.random::<f64>();
        self.clock.samples_in(seconds).max(1)
    }

    /// Whether the joint stays in its range at `level` until the next step acts, even
    /// if that one takes as long as any can.
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
        let begin = self.clock.time_s(sample) + self.delay_s(sample, level, chance)?;
        let next = self.clock.time_s(sample.saturating_add(hold)) + self.joint.delay.longest_s();
        let moving_s = (next.min(self.clock.time_s(self.clock.samples())) - begin).max(0.0);
        let from = self.drive.arrivals.angle_at(begin);
        let to = from + self.chain.speed(level) * moving_s;
        Ok([from, to].iter().all(|angle| (lowest..=highest).contains(angle)))
    }

    /// Sets `level` at `sample`.
    fn set(&mut self, sample: usize, level: f64, chance: f64) -> Result<(), PlantError> {
        let delay_s = self.delay_s(sample, level, chance)?;
        let step = Step { sample, before: self.drive.level(), after: level, delay_s };
        let acts_s = self.clock.time_s(sample) + delay_s;
        self.drive.arrivals.push(self.drive.steps.len(), acts_s, self.chain.speed(level));
        self.drive.steps.push(step);
        Ok(())
    }

    /// Delay of a step to `level` at `sample`, in seconds.
    fn delay_s(&self, sample: usize, level: f64, chance: f64) -> Result<f64, PlantError> {
        let (index, before) = (self.drive.steps.len(), self.drive.level());
        let progress = self.clock.progress(sample);
        let at = Occasion { index, before, after: level, progress, chance };
        self.joint.delay.delay_s(&at).ok_or_else(|| PlantError::ListedDelays {
            place: Place::joint(&self.joint.name),
            given: index,
            needed: index + 1,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::DelayLaw;
    use super::*;
    use crate::units::SamplePeriod;

    fn clock(samples: usize) -> Clock {
        Clock::new(SamplePeriod::from_seconds(0.01).unwrap(), samples, 20)
    }

    fn wandering(hold_s: [f64; 2]) -> JointSpec {
        let levels = vec![-2.0, -1.0, 0.0, 1.0, 2.0];
        let law = DelayLaw::Uniform { min: 0.01, max: 0.8 };
        JointSpec::new("a", InputSpec::Levels { levels, hold_s }, law)
    }

    #[test]
    fn drawn_steps_change_the_level_and_hold_it_as_long_as_allowed() {
        let drive = Drive::of(&wandering([0.9, 2.0]), 0, 3, clock(20_000)).unwrap();
        let samples = std::iter::once(1).chain(drive.steps().iter().map(|step| step.sample));
        let samples: Vec<usize> = samples.collect();
        assert!(samples.windows(2).all(|w| (90..=200).contains(&(w[1] - w[0]))));
        assert!(drive.steps().iter().all(|step| differ(step.before, step.after)));
        assert!(!differ(drive.steps()[0].before, 0.0));
        assert!(drive.steps().iter().all(|step| (0.01..0.8).contains(&step.delay_s)));
    }

    #[test]
    fn drawn_holds_and_levels_spread_over_all_that_is_allowed() {
        let drive = Drive::of(&wandering([0.9, 2.0]), 0, 3, clock(200_000)).unwrap();
        let mut holds = drive.steps().windows(2).map(|w| w[1].sample - w[0].sample);
        let mean = holds.by_ref().sum::<usize>() as f64 / (drive.steps().len() - 1) as f64;
        // Some 1400 holds of deviation 32 samples: a standard error of 0.9.
        assert!((mean - 145.0).abs() < 4.0, "mean hold {mean}");
        let twos = drive.steps().iter().filter(|step| step.after > 1.5).count();
        let share = twos as f64 / drive.steps().len() as f64;
        assert!((share - 0.2).abs() < 0.04, "{share} at the highest level");
    }

    #[test]
    fn the_range_is_kept_at_all_times() {
        let joint = JointSpec { range: Some([-60.0, 70.0]), ..wandering([0.9, 2.0]) };
        for seed in 0..20 {
            let drive = Drive::of(&joint, 0, seed, clock(12_000)).unwrap();
            let angles = (0..12_000).map(|k| drive.arrivals().angle_at(f64::from(k) * 0.01));
            assert!({ angles }.all(|angle| (-60.0..=70.0).contains(&angle)), "seed {seed}");
        }
    }

    #[test]
    fn a_range_that_no_level_keeps_is_an_error() {
        let levels = vec![-1.0, 1.0];
        let input = InputSpec::Levels { levels, hold_s: [5.0, 5.0] };
        let law = DelayLaw::Constant { seconds: 0.0 };
        let joint = JointSpec { range: Some([-1.0, 1.0]), ..JointSpec::new("a", input, law) };
        let found = Drive::of(&joint, 0, 0, clock(2000));
        assert!(matches!(found, Err(PlantError::Range { sample: 501, .. })));
    }

    #[test]
    fn given_steps_stand_where_they_are_given() {
        let input = InputSpec::Steps { steps: vec![(3, 1.0), (5, -1.0)], initial: 0.5 };
        let joint = JointSpec::new("a", input, DelayLaw::Constant { seconds: 0.15 });
        let drive = Drive::of(&joint, 0, 0, clock(6)).unwrap();
        assert_eq!(drive.input(6), [0.5, 0.5, 1.0, 1.0, -1.0, -1.0]);
        let first = Step { sample: 3, before: 0.5, after: 1.0, delay_s: 0.15 };
        assert_eq!(drive.steps()[0], first);
    }

    #[test]
    fn drawn_steps_beyond_the_list_of_delays_are_an_error() {
        let joint = JointSpec {
            delay: DelayLaw::Listed { seconds: vec![0.1; 2] },
            ..wandering([0.9, 2.0])
        };
        let found = Drive::of(&joint, 0, 0, clock(2000));
        assert!(matches!(found, Err(PlantError::ListedDelays { given: 2, needed: 3, .. })));
    }
}
