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
use super::statics::Valve;

/// Draws of level and hold before a range is given up. With one draw in a hundred
/// acceptable, a thousand fail once in 20 000 steps.
const MAX_DRAWS: usize = 1000;

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
        let mut steps = self.steps.iter().peekable();
        let mut level = self.initial;
        let levels = (1..=samples).map(|sample| {
            if let Some(step) = steps.next_if(|step| step.sample == sample) {
                level = step.after;
            }
            level
        });
        levels.collect()
    }

    /// The level that acts once step `index` does; that before the first for none.
    pub(super) fn level_of(&self, index: usize) -> f64 {
        self.steps.get(index).map_or(self.initial, |step| step.after)
    }

    /// Change of the steady speed that each step causes, in output units per second; none
    /// for one that was overtaken.
    pub(super) fn speed_changes(&self) -> Vec<Option<f64>> {
        self.by_step(self.arrivals.speed_changes())
    }

    /// `changes`, each with the number of its step, in the order of the steps; none for the
    /// others.
    pub(super) fn by_step(&self, changes: impl Iterator<Item = (usize, f64)>) -> Vec<Option<f64>> {
        let mut by_step = vec![None; self.steps.len()];
        for (index, change) in changes {
            if let Some(slot) = by_step.get_mut(index) {
                *slot = Some(change);
            }
        }
        by_step
    }

    /// The level after the last step so far.
    fn level(&self) -> f64 {
        self.steps.last().map_or(self.initial, |step| step.after)
    }

    /// Adds a step.
    pub(super) fn push(&mut self, intent: Intent) {
        self.arrivals.push(self.steps.len(), intent.acts_s, intent.speed);
        self.steps.push(intent.step);
    }
}

/// What became of one joint that was driven.
#[derive(Clone, Debug)]
pub(super) struct Driven {
    pub(super) drive: Drive,
    /// Change of speed that each step caused, in output units per second; none for one
    /// that was overtaken.
    pub(super) speed_changes: Vec<Option<f64>>,
    /// What an ideal sensor shows at each sample.
    pub(super) angles: Vec<f64>,
}

/// A step that is to be made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Intent {
    step: Step,
    /// When it acts, in seconds.
    pub(super) acts_s: f64,
    /// Speed that it commands.
    pub(super) speed: f64,
}

/// A step to be tried out in advance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attempt {
    pub(super) intent: Intent,
    /// Lowest and highest angle allowed from when it acts, in output units.
    pub(super) range: [f64; 2],
    /// Until when, in seconds.
    pub(super) end_s: f64,
}

/// How an experimenter knows where a joint will be.
pub(super) trait Predictor {
    /// How far the joint, driven by `drive` and then by `attempt`, goes beyond its range, in
    /// output units.
    ///
    /// # Errors
    /// [`PlantError::Runaway`].
    fn excess(&self, drive: &Drive, attempt: &Attempt) -> Result<f64, PlantError>;

    /// Draws after which the level with the least excess is taken, if there is one.
    fn max_draws(&self) -> Option<usize>;
}

/// How far `angle` is outside `range`.
pub(super) fn beyond(angle: f64, [lowest, highest]: [f64; 2]) -> f64 {
    (lowest - angle).max(angle - highest).max(0.0)
}

/// Makes a [`Drive`], step by step.
#[derive(Debug)]
pub(super) struct Driver<'a> {
    joint: &'a JointSpec,
    clock: Clock,
    valve: Valve,
    delays: ChaCha8Rng,
    input: ChaCha8Rng,
    /// Sample of the next step, where it is drawn.
    next: usize,
    drive: Drive,
}

impl<'a> Driver<'a> {
    /// The driver of `joint`, which has the number `index`, from 0.
    pub(super) fn new(joint: &'a JointSpec, index: usize, seed: u64, clock: Clock) -> Self {
        let valve = Valve::of(joint);
        let initial = joint.input.initial();
        let arrivals = Arrivals::new(joint.start, valve.speed(initial));
        let drive = Drive { steps: Vec::new(), arrivals, initial };
        let delays = stream(seed, index, Purpose::Delay);
        let input = stream(seed, index, Purpose::Input);
        let mut driver = Self { joint, clock, valve, delays, input, next: 0, drive };
        if let InputSpec::Levels { hold_s, .. } = &joint.input {
            driver.next = driver.draw_hold(*hold_s).saturating_add(1);
        }
        driver
    }

    /// Sample of the next step, if there is one in the record.
    pub(super) fn due(&self) -> Option<usize> {
        match &self.joint.input {
            InputSpec::Steps { steps, .. } => {
                steps.get(self.drive.steps.len()).map(|(sample, _)| *sample)
            }
            InputSpec::Levels { .. } => Some(self.next).filter(|at| *at <= self.clock.samples()),
        }
    }

    /// Sets the step that is due at `sample`.
    ///
    /// # Errors
    /// [`PlantError::Range`], [`PlantError::ListedDelays`] and [`PlantError::Runaway`].
    pub(super) fn act(
        &mut self,
        sample: usize,
        predictor: &impl Predictor,
    ) -> Result<(), PlantError> {
        // Drawn before the level, so that draws refused cost no chance.
        let chance = self.delays.random();
        let joint = self.joint;
        let level = match &joint.input {
            InputSpec::Steps { steps, .. } => {
                steps.get(self.drive.steps.len()).map_or(0.0, |(_, level)| *level)
            }
            InputSpec::Levels { levels, hold_s } => {
                let (level, hold) = self.draw(sample, levels, *hold_s, chance, predictor)?;
                self.next = sample.saturating_add(hold);
                level
            }
        };
        let intent = self.intent(sample, level, chance)?;
        self.drive.push(intent);
        Ok(())
    }

    /// What it has made so far.
    pub(super) fn drive(&self) -> &Drive {
        &self.drive
    }

    /// All that it has made.
    pub(super) fn into_drive(self) -> Drive {
        self.drive
    }

    /// A level for `sample` and its hold in samples, that keep the range.
    fn draw(
        &mut self,
        sample: usize,
        levels: &[f64],
        hold_s: [f64; 2],
        chance: f64,
        predictor: &impl Predictor,
    ) -> Result<(f64, usize), PlantError> {
        let now = self.drive.level();
        let others: Vec<f64> = levels.iter().copied().filter(|level| differ(*level, now)).collect();
        let mut best = None;
        for _ in 0..predictor.max_draws().unwrap_or(MAX_DRAWS) {
            let hold = self.draw_hold(hold_s);
            let drawn = others.choose(&mut self.input).copied();
            for level in drawn.into_iter().flat_map(|level| [level, -level]) {
                if !differ(level, now) {
                    continue;
                }
                let excess = self.excess(sample, level, hold, chance, predictor)?;
                if excess <= 0.0 {
                    return Ok((level, hold));
                }
                if best.is_none_or(|(least, _)| excess < least) {
                    best = Some((excess, (level, hold)));
                }
            }
        }
        let least = best.filter(|_| predictor.max_draws().is_some()).map(|(_, drawn)| drawn);
        least.ok_or_else(|| PlantError::Range { place: Place::joint(&self.joint.name), sample })
    }

    /// A hold in samples, at least one.
    fn draw_hold(&mut self, [shortest, longest]: [f64; 2]) -> usize {
        let seconds = shortest + (longest - shortest) * self.input.random::<f64>();
        self.clock.samples_in(seconds).max(1)
    }

    /// How far the joint leaves its range at `level` until the next step acts, even if
    /// that one takes as long as any can.
    fn excess(
        &self,
        sample: usize,
        level: f64,
        hold: usize,
        chance: f64,
        predictor: &impl Predictor,
    ) -> Result<f64, PlantError> {
        let Some(range) = self.joint.range else {
            return Ok(0.0);
        };
        let intent = self.intent(sample, level, chance)?;
        let next = self.clock.time_s(sample.saturating_add(hold)) + self.joint.longest_delay_s();
        let end_s = next.min(self.clock.time_s(self.clock.samples()));
        predictor.excess(&self.drive, &Attempt { intent, range, end_s })
    }

    /// The step to `level` at `sample`.
    fn intent(&self, sample: usize, level: f64, chance: f64) -> Result<Intent, PlantError> {
        let (index, before) = (self.drive.steps.len(), self.drive.level());
        let progress = self.clock.progress(sample);
        let time_s = self.clock.time_s(sample);
        let held = sample - self.drive.steps.last().map_or(1, |step| step.sample);
        let held_s = held as f64 * self.clock.period_s();
        let at = Occasion { index, before, after: level, progress, chance, held_s, time_s };
        let delay_s = self.joint.delay_s(&at).ok_or_else(|| PlantError::ListedDelays {
            place: Place::joint(&self.joint.name),
            given: index,
            needed: index + 1,
        })?;
        let step = Step { sample, before, after: level, delay_s };
        Ok(Intent { step, acts_s: time_s + delay_s, speed: self.valve.speed(level) })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::DelayLaw;
    use super::super::motion::Motion;
    use super::*;

    fn clock(samples: usize) -> Clock {
        Clock::new(0.01, samples, 20)
    }

    /// All steps of a plain `joint`.
    pub(crate) fn driven(joint: &JointSpec, clock: Clock) -> Result<Drive, PlantError> {
        let mut driver = Driver::new(joint, 0, 3, clock);
        let motion = Motion::new(joint, clock);
        while let Some(sample) = driver.due() {
            driver.act(sample, &motion)?;
        }
        Ok(driver.into_drive())
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
        let found = driven(&joint, clock(2000));
        assert!(matches!(found, Err(PlantError::ListedDelays { given: 2, needed: 3, .. })));
    }
}
