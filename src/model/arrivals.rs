//! When each level of the input begins to act.

use super::JointModel;
use crate::effect::InputChange;
use crate::units::floor_to_index;

/// A level of the input and the time from which it acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Seconds since the first sample.
    pub time_s: f64,
    /// The level, input units.
    pub level: f64,
}

/// What acts on a joint over a trial: a level at the start, and changes in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrivals {
    /// The level before the first change.
    pub initial: f64,
    /// The changes, in ascending time.
    pub changes: Vec<Arrival>,
}

/// The changes of an input, as they are commanded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Commands {
    initial: f64,
    changes: Vec<Command>,
}

/// A change of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Command {
    /// Seconds since the first sample.
    time_s: f64,
    /// The level from then on.
    level: f64,
    /// Whether it is in the log.
    is_logged: bool,
}

impl Commands {
    /// The changes of `input`, sampled every `period_s` seconds.
    pub fn new(input: &[f64], period_s: f64) -> Self {
        let mut levels = input.iter();
        let initial = levels.next().copied().unwrap_or(0.0);
        let (mut before, mut changes) = (initial, Vec::new());
        for (&level, sample) in levels.zip(1..) {
            #[expect(clippy::float_cmp, reason = "a step is any change")]
            if level != before {
                let time_s = f64::from(sample) * period_s;
                changes.push(Command { time_s, level, is_logged: true });
                before = level;
            }
        }
        Self { initial, changes }
    }

    /// These changes of a trial that began with a step from `level`, which nobody logged.
    #[must_use]
    pub(crate) fn begun_at(mut self, level: f64) -> Self {
        let first = Command { time_s: 0.0, level: self.initial, is_logged: false };
        self.changes.insert(0, first);
        Self { initial: level, ..self }
    }

    /// These changes with one to `level` at `time_s`, which nobody logged.
    #[must_use]
    pub(crate) fn with_rest_at(mut self, level: f64, time_s: f64) -> Self {
        let place = self.changes.partition_point(|change| change.time_s <= time_s);
        self.changes.insert(place, Command { time_s, level, is_logged: false });
        self
    }

    /// These changes where no more than one is within `block_s` seconds, counted from the first sample; of
    /// several the mean level over the block acts from its start, and the last one after it.
    #[must_use]
    pub(crate) fn in_blocks(&self, block_s: f64) -> Self {
        /// Part of a block by which times are rounded, at most.
        const ROUNDED: f64 = 1e-9;
        let block_of = |change: &Command| floor_to_index(change.time_s / block_s + ROUNDED);
        let mut changes: Vec<Command> = Vec::with_capacity(self.changes.len());
        let mut before = self.initial;
        for own in self.changes.chunk_by(|one, next| block_of(one) == block_of(next)) {
            let (Some(first), Some(last)) = (own.first(), own.last()) else { continue };
            if own.len() == 1 {
                changes.push(*first);
            } else {
                let block = block_of(first);
                let [start_s, end_s] = [block, block + 1].map(|blocks| blocks as f64 * block_s);
                let level = mean_level(before, own, (start_s, end_s));
                // What follows the last block is overtaken where this one begins.
                changes.pop_if(|change| change.time_s >= start_s);
                changes.push(Command { time_s: start_s, level, ..*first });
                changes.push(Command { time_s: end_s, ..*last });
            }
            before = last.level;
        }
        Self { initial: self.initial, changes }
    }

    /// The changes as they arrive at the joint: change `i` at `t_i + delay + extra_i`.
    ///
    /// `extra` comes from the effects of the transport stage. `per_step` holds delays in
    /// seconds for each change of the input in the log; the model's own delay is taken only for
    /// those that are not known (`None`).
    ///
    /// A change that would act before an earlier one takes its place: an earlier level never
    /// comes back. Delays are not below zero. `start_s` is the time of the record at the
    /// first sample: effects may change with it.
    pub fn arriving(
        &self,
        model: &JointModel,
        start_s: f64,
        per_step: Option<&[Option<f64>]>,
    ) -> Arrivals {
        let changes = Vec::with_capacity(self.changes.len());
        let mut arrivals = Arrivals { initial: self.initial, changes };
        let delay_of = model.delay_of();
        let mut of_steps = per_step.unwrap_or_default().iter();
        for (change, command) in self.changes(start_s).zip(&self.changes) {
            let known = if command.is_logged { of_steps.next().copied().flatten() } else { None };
            let delay_s = known.map_or_else(|| delay_of(&change), |delay_s| delay_s.max(0.0));
            arrivals.insert(Arrival { time_s: command.time_s + delay_s, level: change.after });
        }
        arrivals
    }

    /// The changes as a delay may depend on them, in a record whose first sample is at `start_s`.
    pub(crate) fn changes(&self, start_s: f64) -> impl Iterator<Item = InputChange> + '_ {
        let before = self.changes.iter().map(|change| change.level);
        let before = [self.initial].into_iter().chain(before);
        let since = [0.0].into_iter().chain(self.changes.iter().map(|change| change.time_s));
        self.changes.iter().zip(before).zip(since).map(move |((change, before), since)| {
            InputChange {
                before,
                after: change.level,
                held_s: change.time_s - since,
                time_s: start_s + change.time_s,
            }
        })
    }
}

/// The mean from one time to another of what is `before` the first of `changes` and then as they say.
fn mean_level(before: f64, changes: &[Command], (start_s, end_s): (f64, f64)) -> f64 {
    let levels = std::iter::once(before).chain(changes.iter().map(|change| change.level));
    let times = changes.iter().map(|change| change.time_s);
    let borders: Vec<f64> = [start_s].into_iter().chain(times).chain([end_s]).collect();
    let lasts = borders.windows(2).map(|pair| pair[1] - pair[0]);
    levels.zip(lasts).map(|(level, seconds)| level * seconds).sum::<f64>() / (end_s - start_s)
}

impl Arrivals {
    /// What arrives from `from_s` on, which is then time zero, up to `to_s`.
    pub(crate) fn between(&self, from_s: f64, to_s: f64) -> Self {
        let until = |time_s: f64| self.changes.partition_point(|change| change.time_s <= time_s);
        let (before, after) = self.changes.split_at(until(from_s));
        let within = after.iter().take(until(to_s).saturating_sub(before.len()));
        let shifted = within.map(|a| Arrival { time_s: a.time_s - from_s, ..*a });
        Self {
            initial: before.last().map_or(self.initial, |change| change.level),
            changes: shifted.collect(),
        }
    }

    /// Adds a change that was commanded after all others.
    fn insert(&mut self, arrival: Arrival) {
        while self.changes.last().is_some_and(|last| last.time_s >= arrival.time_s) {
            self.changes.pop();
        }
        self.changes.push(arrival);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nobody_logged_takes_no_measured_delay() {
        let logged = Commands::new(&[1.0, 1.0, 1.0, -1.0, -1.0], 1.0);
        let commands = logged.begun_at(0.0).with_rest_at(0.0, 2.0);
        let model = JointModel::integrator(1.0, 0.25);
        let Arrivals { initial, changes } = commands.arriving(&model, 0.0, Some(&[Some(0.5)]));
        let found: Vec<(f64, f64)> = changes.iter().map(|a| (a.time_s, a.level)).collect();
        assert_eq!((initial, found), (0.0, vec![(0.25, 1.0), (2.25, 0.0), (3.5, -1.0)]));
    }

    #[test]
    fn of_several_changes_in_a_block_the_mean_acts() {
        // Blocks of two seconds; those of the second change in each of them, and then one in a block.
        let commands = Commands::new(&[1.0, 1.0, 3.0, 4.0, 6.0, 8.0, 8.0, 8.0, 8.0, 5.0], 1.0);
        let model = JointModel::integrator(1.0, 0.5);
        let Arrivals { initial, changes } = commands.in_blocks(2.0).arriving(&model, 0.0, None);
        let found: Vec<(f64, f64)> = changes.iter().map(|a| (a.time_s, a.level)).collect();
        assert!((initial - 1.0).abs() < 1e-12);
        assert_eq!(found, [(2.5, 3.5), (4.5, 7.0), (6.5, 8.0), (9.5, 5.0)]);
        // What changes once in a block stays as it is.
        assert_eq!(commands.in_blocks(1.0), commands);
    }

    #[test]
    fn a_stretch_has_the_level_before_it_and_the_changes_within() {
        let changes = [(0.5, 1.0), (1.0, 2.0), (1.5, 3.0), (2.5, 4.0)];
        let changes = changes.map(|(time_s, level)| Arrival { time_s, level }).to_vec();
        let all = Arrivals { initial: -1.0, changes };
        let found = all.between(1.0, 2.0);
        assert!((found.initial - 2.0).abs() < 1e-15);
        assert_eq!(found.changes, [Arrival { time_s: 0.5, level: 3.0 }]);
        assert_eq!(all.between(0.0, 9.0), all);
        assert_eq!(all.between(3.0, 9.0), Arrivals { initial: 4.0, changes: Vec::new() });
    }
}
