//! Random steps: a finite set of levels, repeated, each held for a random time.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::predict::{TestRig, Uncertain};
use super::response::response_s;
use super::schedule::{Hold, Schedule, samples_in};

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomSteps {
    /// The levels, different ones, input units.
    pub levels: Vec<f64>,
    /// Shortest and longest hold, seconds; all between are alike.
    pub hold_s: (f64, f64),
    /// Length of the input, seconds.
    pub duration_s: f64,
    /// Where random numbers come from: the same seed, the same input.
    pub seed: u64,
}

/// Draws an input for the joint number `index`, from 0, of an experiment.
///
/// It begins at rest. Each next level is one of those to which the input has gone least often
/// from the level at hand, so that all transitions between two levels are about as frequent;
/// of several the least frequent level, of those again any. With a `model` and a range, levels
/// after which the joint may leave the range, with the margin of the model, are left out; where
/// all of them are, the shortest hold at the level that leaves it least is taken.
pub fn random_steps(
    steps: &RandomSteps,
    rig: &TestRig,
    model: Option<&Uncertain>,
    index: usize,
) -> Schedule {
    let mut drawing = Drawing::new(steps, rig, model, index);
    let (shortest, _) = steps.hold_s;
    drawing.push(Hold { level: 0.0, samples: samples_in(shortest, rig.period) });
    while drawing.left() > 0 {
        let hold = drawing.next();
        drawing.push(hold);
    }
    Schedule::new(rig.period, drawing.holds)
}

/// A trial that is drawn after others.
#[derive(Clone, Copy)]
pub(super) struct Behind<'a> {
    /// The trials before, whose transitions count.
    pub(super) before: Option<&'a Schedule>,
    /// Number of the draw, from 0: each is another.
    pub(super) draw: usize,
    /// Whether the joint is brought back to its start after the trial, wherever it ends.
    pub(super) is_brought_back: bool,
}

/// Draws a trial as [`random_steps`] draws an input, within `range`, which ends before its time
/// where no level is left after which the joint surely stays there.
///
/// Beyond half the way from the middle of the range to its ends, levels come first that lead
/// back; so they do towards the end, unless the joint is brought back, and the last level is rest.
pub(super) fn random_steps_within(
    steps: &RandomSteps,
    (rig, index): (&TestRig, usize),
    model: &Uncertain,
    range: (f64, f64),
    behind: Behind<'_>,
) -> Schedule {
    let mut drawing = Drawing::new(steps, rig, Some(model), index).behind(behind);
    let rest = samples_in(steps.hold_s.0, rig.period);
    drawing.samples = drawing.samples.saturating_sub(rest);
    drawing.push(Hold { level: 0.0, samples: rest });
    while drawing.left() >= rest {
        let Some(hold) = drawing.next_within(model, range) else { break };
        drawing.push(hold);
    }
    // What is left is too short for a level.
    let left = drawing.left();
    let rest = if left < rest { rest + left } else { rest };
    drawing.samples += rest;
    drawing.rest(rest);
    Schedule::new(rig.period, drawing.holds)
}

/// An input that is being drawn.
struct Drawing<'a> {
    steps: &'a RandomSteps,
    rig: &'a TestRig,
    model: Option<&'a Uncertain>,
    random: ChaCha8Rng,
    samples: usize,
    holds: Vec<Hold>,
    /// Levels of the trials before, in their order.
    before: Vec<f64>,
    /// Whether the joint is brought back to its start.
    is_brought_back: bool,
    /// Time in which a level acts, seconds.
    settling_s: f64,
}

/// Where a joint comes to by a level.
#[derive(Clone, Copy)]
struct Leading {
    hold: Hold,
    /// How far it may leave the range on its way, output units.
    excess: f64,
    /// Distance from the middle of the range at the end.
    off_middle: f64,
}

impl<'a> Drawing<'a> {
    fn new(
        steps: &'a RandomSteps,
        rig: &'a TestRig,
        model: Option<&'a Uncertain>,
        index: usize,
    ) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(steps.seed);
        // Joints of one seed draw from streams of their own.
        random.set_stream(index as u64);
        let samples = samples_in(steps.duration_s, rig.period);
        let levels = steps.levels.iter();
        let largest = levels.fold(0.0, |largest: f64, level| largest.max(level.abs()));
        let settling_s = model.map_or(0.0, |known| response_s(&known.model, rig, largest));
        let (holds, before) = (Vec::new(), Vec::new());
        let is_brought_back = false;
        Self { steps, rig, model, random, samples, holds, before, is_brought_back, settling_s }
    }

    /// This draw after other trials.
    fn behind(mut self, Behind { before, draw, is_brought_back }: Behind<'_>) -> Self {
        /// Joints of one experiment, at most: streams of random numbers of another draw lie apart.
        const JOINTS: u64 = 1 << 32;
        let levels = before.iter().flat_map(|before| before.holds());
        self.before = levels.map(|hold| hold.level).collect();
        self.random.set_stream(self.random.get_stream() + JOINTS * draw as u64);
        Self { is_brought_back, ..self }
    }

    /// Samples that are not drawn yet.
    fn left(&self) -> usize {
        let drawn: usize = self.holds.iter().map(|hold| hold.samples).sum();
        self.samples.saturating_sub(drawn)
    }

    fn push(&mut self, hold: Hold) {
        let samples = hold.samples.min(self.left());
        self.holds.push(Hold { samples, ..hold });
    }

    fn next(&mut self) -> Hold {
        let (shortest, longest) = self.steps.hold_s;
        let seconds = shortest + (longest - shortest) * self.random.random::<f64>();
        let samples = samples_in(seconds, self.rig.period);
        let levels = self.by_rarity();
        let kept = levels.iter().find(|level| self.excess(**level, samples) <= 0.0);
        if let Some(level) = kept {
            return Hold { level: *level, samples };
        }
        let samples = samples_in(shortest, self.rig.period);
        let excess = |level: &&f64| self.excess(**level, samples);
        let least = levels.iter().min_by(|a, b| excess(a).total_cmp(&excess(b)));
        Hold { level: least.copied().unwrap_or(0.0), samples }
    }

    /// A hold after which the joint surely stays in `range`, be it followed by rest.
    fn next_within(&mut self, model: &Uncertain, range: (f64, f64)) -> Option<Hold> {
        /// Part of the way from the middle to the ends beyond which levels lead back.
        const OUT: f64 = 0.5;
        /// Longest holds that are left when it is time to go back.
        const CLOSING: usize = 2;
        let (shortest, longest) = self.steps.hold_s;
        let seconds = shortest + (longest - shortest) * self.random.random::<f64>();
        let levels = self.by_rarity();
        let [shortest, longest, drawn] =
            [shortest, longest, seconds].map(|seconds| samples_in(seconds, self.rig.period));
        let now = self.leading(Hold { level: 0.0, samples: 1 }, model, range).off_middle;
        let is_out = now > OUT * 0.5 * (range.1 - range.0);
        let is_closing = self.left() <= CLOSING * longest && !self.is_brought_back;
        let [drawn, shortest] = [drawn, shortest].map(|samples| {
            let samples = samples.min(self.left());
            // No level is played for less than the shortest hold.
            let is_last = self.left() - samples < shortest;
            if is_last { self.left() } else { samples }
        });
        let tried = if self.is_brought_back {
            // In a short trial a level that is rare comes first, be it for a short time.
            vec![holds(&levels, &[drawn, shortest])]
        } else {
            vec![holds(&levels, &[drawn]), holds(&levels, &[shortest])]
        };
        tried.into_iter().find_map(|holds| {
            let leading = holds.into_iter().map(|hold| self.leading(hold, model, range));
            let kept = leading.filter(|found| found.excess <= 0.0);
            let chosen = if is_closing {
                kept.min_by(|a, b| a.off_middle.total_cmp(&b.off_middle))
            } else {
                first_that(kept, |found| !is_out || found.off_middle < now)
            };
            chosen.map(|found| found.hold)
        })
    }

    /// Where the joint comes to by `hold` when it rests after it, until that acts.
    fn leading(&self, hold: Hold, model: &Uncertain, range: (f64, f64)) -> Leading {
        // As long as the hold may act on.
        let rest = samples_in(self.settling_s.max(2.0 * self.steps.hold_s.0), self.rig.period);
        let mut holds = self.holds.clone();
        let from = holds.iter().map(|hold| hold.samples).sum();
        holds.extend([hold, Hold { level: 0.0, samples: rest }]);
        let foreseen = self.rig.foreseen(model, &Schedule::new(self.rig.period, holds));
        let end = foreseen.output.last().copied().unwrap_or(self.rig.start);
        let off_middle = (end - 0.5 * (range.0 + range.1)).abs();
        Leading { hold, excess: foreseen.excess(range, from), off_middle }
    }

    /// Rest for so many samples at the end, as a part of the last hold where that is rest.
    fn rest(&mut self, samples: usize) {
        match self.holds.last_mut() {
            Some(last) if !differ(last.level, 0.0) => last.samples += samples,
            _ => self.push(Hold { level: 0.0, samples }),
        }
    }

    /// The levels but the one at hand, rarest transition first.
    fn by_rarity(&mut self) -> Vec<f64> {
        let now = self.holds.last().map_or(0.0, |hold| hold.level);
        let others = self.steps.levels.iter().filter(|level| differ(**level, now));
        let mut ranked: Vec<(usize, usize, f64, f64)> = Vec::new();
        for level in others {
            let (transitions, visits) = self.counts(now, *level);
            ranked.push((transitions, visits, self.random.random(), *level));
        }
        // Transition, then level, then by lot.
        ranked.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
        ranked.into_iter().map(|(_, _, _, level)| level).collect()
    }

    /// How often the input went from `before` to `after`, and to `after` at all.
    fn counts(&self, before: f64, after: f64) -> (usize, usize) {
        let own = self.holds.windows(2).filter_map(|pair| match pair {
            [a, b] => Some((a.level, b.level)),
            _ => None,
        });
        let earlier = self.before.windows(2).filter_map(|pair| match pair {
            [a, b] => Some((*a, *b)),
            _ => None,
        });
        let pairs = own.chain(earlier);
        let into = pairs.filter(|(_, to)| !differ(*to, after));
        into.fold((0, 0), |(transitions, visits), (from, _)| {
            (transitions + usize::from(!differ(from, before)), visits + 1)
        })
    }

    /// How far the joint may leave its range while `level` acts, if held for so long.
    fn excess(&self, level: f64, samples: usize) -> f64 {
        let (Some(range), Some(uncertain)) = (self.rig.range, self.model) else { return 0.0 };
        let delay = samples_in(uncertain.model.delay.value, self.rig.period);
        let mut holds = self.holds.clone();
        let from = holds.iter().map(|hold| hold.samples).sum();
        holds.push(Hold { level, samples: samples + delay });
        let schedule = Schedule::new(self.rig.period, holds);
        self.rig.prediction(uncertain, &schedule).excess(range, from)
    }
}

/// Each of `levels` for each of so many samples.
fn holds(levels: &[f64], samples: &[usize]) -> Vec<Hold> {
    let holds = levels
        .iter()
        .flat_map(|level| samples.iter().map(|samples| Hold { level: *level, samples: *samples }));
    holds.collect()
}

/// The first of `items` for which `is_it`, else the first of all.
fn first_that<T>(items: impl Iterator<Item = T>, is_it: impl Fn(&T) -> bool) -> Option<T> {
    let mut first = None;
    for item in items {
        if is_it(&item) {
            return Some(item);
        }
        first.get_or_insert(item);
    }
    first
}

/// Fewest and most times that the input of `schedule` goes from one of its levels to another.
pub fn transitions(schedule: &Schedule) -> (usize, usize) {
    let levels = schedule.levels();
    let count = |from: f64, to: f64| {
        let pairs = schedule.holds().windows(2);
        let is_it = |pair: &&[Hold]| matches!(pair, [a, b] if !differ(a.level, from) && !differ(b.level, to));
        pairs.filter(is_it).count()
    };
    let pairs = levels.iter().flat_map(|from| levels.iter().map(move |to| (*from, *to)));
    let counts = pairs.filter(|(from, to)| differ(*from, *to)).map(|(from, to)| count(from, to));
    let (least, most) = counts.fold((usize::MAX, 0), |(l, m), n| (l.min(n), m.max(n)));
    (least.min(most), most)
}

/// Whether two levels are not the same.
pub(super) fn differ(a: f64, b: f64) -> bool {
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let differ = a != b;
    differ
}

#[cfg(test)]
mod tests {
    use super::super::predict::tests::rig;
    use super::*;

    fn steps(duration_s: f64) -> RandomSteps {
        let levels = vec![-2.0, -1.0, 0.0, 1.0, 2.0];
        RandomSteps { levels, hold_s: (0.9, 2.0), duration_s, seed: 1 }
    }

    #[test]
    fn levels_are_held_as_long_as_asked_and_change_every_time() {
        let made = random_steps(&steps(120.0), &rig(None), None, 0);
        assert_eq!(made.samples(), 12_000);
        let (shortest, longest) = made.hold_range_s();
        assert!(shortest >= 0.9 && longest <= 2.0 && longest - shortest > 0.8);
        assert!(made.holds().windows(2).all(|pair| differ(pair[0].level, pair[1].level)));
        assert_eq!(made.levels(), steps(1.0).levels);
        assert!(!differ(made.holds()[0].level, 0.0));
    }
}
