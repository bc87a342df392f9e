//! Random steps that keep a joint in its range: in one trial, or in several, before each of which
//! it is brought back, so that what a prediction is off by does not add up.

use super::free_run::FreeRunError;
use super::logged::Logged;
use super::planned::{Plan, PlanRequest};
use super::predict::{Prediction, TestRig, Uncertain};
use super::random::{Behind, RandomSteps, differ, random_steps_within};
use super::refusal::{NotKept, PlanError, rounded};
use super::schedule::{Schedule, samples_in};
use super::trend::Travel;

/// Shorter inputs that are tried where one trial is asked for and it is not said how long it is to
/// be, as parts of the longest.
const SHORTER: [f64; 7] = [0.75, 0.5, 0.375, 0.25, 0.1875, 0.125, 0.0833];

/// Into how many trials an input is divided, fewest first.
const TRIALS: [usize; 9] = [2, 3, 4, 6, 8, 12, 16, 24, 40];

/// More trials nobody plays who did not ask for the length that they make up.
const MOST_TRIALS: usize = 12;

/// Draws of a trial, of which the first that keeps the range is taken.
const DRAWS: usize = 3;

/// Wider ranges that are tried to say which one would do.
const WIDER: [f64; 4] = [1.5, 2.0, 3.0, 5.0];

/// Part of what a log has gone through by which the joint may leave that on either side.
const BEYOND: f64 = 0.1;

/// Fewest steps of an input that is worth to be played, and of one of its trials: to a level and
/// back.
const FEWEST_STEPS: usize = 6;
const FEWEST_STEPS_OF_TRIAL: usize = 2;

/// Where a joint may be: in the range that is asked for, and about where its log has been.
///
/// What a joint does elsewhere, near its stops or where its lever is another, no model knows from
/// the log.
///
/// # Errors
/// [`PlanError::Elsewhere`].
pub fn reach(range: (f64, f64), logged: Option<&Logged>) -> Result<(f64, f64), PlanError> {
    let Some(&Logged { extent, .. }) = logged else { return Ok(range) };
    let beyond = BEYOND * (extent.1 - extent.0);
    let reach = (range.0.max(extent.0 - beyond), range.1.min(extent.1 + beyond));
    if reach.0 < reach.1 { Ok(reach) } else { Err(PlanError::Elsewhere { range, extent }) }
}

/// How an input is divided.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Division {
    trials: usize,
    /// Length of each, seconds.
    trial_s: f64,
}

/// A joint that is to be kept in a range.
#[derive(Clone, Copy)]
pub(super) struct Keeper<'a> {
    pub(super) request: &'a PlanRequest,
    pub(super) rig: &'a TestRig,
    pub(super) known: &'a Uncertain,
    pub(super) logged: Option<&'a Logged>,
    pub(super) index: usize,
    /// Length that is wanted, seconds.
    pub(super) duration_s: f64,
}

impl Keeper<'_> {
    /// The steps within `range`, as they are asked for or as near to that as can be.
    ///
    /// # Errors
    /// [`PlanError::NotKept`].
    pub(super) fn plan(
        &self,
        range: (f64, f64),
        levels: &[f64],
        hold_s: (f64, f64),
    ) -> Result<Plan, PlanError> {
        let ways = self.ways(levels, hold_s);
        let divisions = self.divisions(&ways);
        let is_open = self.request.duration_s.is_none();
        let asked = |divisions: &[Division], range| self.divided(range, &ways, divisions);
        // A length that nobody asked for may be shortened.
        let wanted = |division: &Division| is_open || self.is_whole(*division);
        let whole: Vec<Division> = divisions.iter().copied().filter(wanted).collect();
        if let Some(plan) = asked(&whole, range) {
            return Ok(plan);
        }
        let shorter = asked(&divisions, range).map(|plan| plan.schedule.duration_s().round());
        let several = whole.iter().filter(|division| division.trials > 1);
        let trial_s = several.map(|division| division.trial_s).reduce(f64::min);
        let margin = |of: &FreeRunError| of.margin(at_rest(trial_s.unwrap_or(self.duration_s)));
        let asked_for = self.rig.range.unwrap_or(range);
        let why = NotKept {
            duration_s: self.duration_s,
            trial_s,
            margin: self.known.free_run.as_ref().map(margin),
            shorter_s: shorter,
            wider: self.wider(asked_for, |range| asked(&whole, range).is_some()),
        };
        Err(PlanError::NotKept { range: asked_for, why })
    }

    /// How far the joint may be from its start in `range`: whoever brings it back is not exact.
    pub(super) fn start_tolerance(&self, range: (f64, f64)) -> Option<f64> {
        /// As a part of the range.
        const TOLERANCE: f64 = 0.01;
        let free_run = self.known.free_run.as_ref();
        let drifts = free_run.is_some_and(|free_run| !free_run.is_bounded());
        drifts.then_some(TOLERANCE * (range.1 - range.0))
    }

    /// How the input may be divided, best first: the fewest trials that are no longer than what
    /// shows how far predictions are off, and then shorter inputs where there may be one trial only.
    fn divisions(&self, ways: &[(Vec<f64>, (f64, f64))]) -> Vec<Division> {
        let Self { duration_s, request, known, .. } = *self;
        let one = Division { trials: 1, trial_s: duration_s };
        let shortest_s = ways.iter().map(|(_, hold_s)| hold_s.0).fold(f64::INFINITY, f64::min);
        let is_bounded = known.free_run.as_ref().is_some_and(FreeRunError::is_bounded);
        let others: Vec<Division> = if request.trials == Some(1) || is_bounded {
            let shorter = SHORTER.iter().map(|part| (part * duration_s).round());
            shorter.map(|trial_s| Division { trials: 1, trial_s }).collect()
        } else {
            let most = request.trials.unwrap_or(if request.duration_s.is_some() {
                usize::MAX
            } else {
                MOST_TRIALS
            });
            let divided = TRIALS.iter().map(|parts| Division {
                trials: (*parts).min(most),
                trial_s: duration_s / *parts as f64,
            });
            divided.collect()
        };
        let longest_s = known.free_run.as_ref().map_or(f64::INFINITY, FreeRunError::trusted_s);
        let has_steps = |division: &Division| {
            let holds = division.trial_s / shortest_s;
            let steps = FEWEST_STEPS_OF_TRIAL.max(FEWEST_STEPS.div_ceil(division.trials));
            holds >= (steps + 1) as f64 && division.trial_s <= longest_s
        };
        std::iter::once(one).chain(others).filter(has_steps).collect()
    }

    /// Whether it is as long as what is wanted.
    fn is_whole(&self, Division { trials, trial_s }: Division) -> bool {
        trials as f64 * trial_s > self.duration_s - self.rig.period.seconds()
    }

    /// The first of `divisions` and `ways` in which the joint is kept in `range`; rather one in
    /// which each level is played.
    fn divided(
        &self,
        range: (f64, f64),
        ways: &[(Vec<f64>, (f64, f64))],
        divisions: &[Division],
    ) -> Option<Plan> {
        let mut partial = None;
        for division in divisions {
            let mut plans = self.kept(range, ways, *division);
            plans.sort_by_key(|(_, evenness)| std::cmp::Reverse(*evenness));
            match plans.into_iter().next() {
                Some((plan, Evenness::Partial)) => partial = partial.or(Some(plan)),
                Some((plan, _)) => return Some(plan),
                None => {}
            }
        }
        partial.filter(|_| self.request.levels.is_none())
    }

    /// The narrowest wider range that will do.
    fn wider(&self, asked: (f64, f64), will_do: impl Fn((f64, f64)) -> bool) -> Option<(f64, f64)> {
        let (middle, half) = (0.5 * (asked.0 + asked.1), 0.5 * (asked.1 - asked.0));
        let wider =
            WIDER.map(|times| (rounded(middle - times * half), rounded(middle + times * half)));
        let mut wider = wider.into_iter();
        wider.find(|range| reach(*range, self.logged).is_ok_and(&will_do))
    }

    /// Levels and holds that are tried, best first: with shorter holds, and without the largest
    /// levels, where these were not asked for.
    fn ways(&self, levels: &[f64], hold_s: (f64, f64)) -> Vec<(Vec<f64>, (f64, f64))> {
        /// Longest hold over shortest of the shorter ones.
        const SHORT: f64 = 1.4;
        /// Of shorter holds a fit sees little.
        const SHORTEST_S: f64 = 0.5;
        let mut holds = vec![hold_s];
        if self.request.hold_s.is_none() {
            holds.push((hold_s.0, SHORT * hold_s.0));
            // The usual ones are twice as long as the response.
            let half = 0.5 * hold_s.0;
            holds.extend((half >= SHORTEST_S).then_some((half, SHORT * half)));
        }
        let mut sets = vec![levels.to_vec()];
        let smaller: Vec<f64> = match levels {
            [_, inner @ .., _] => inner.to_vec(),
            _ => Vec::new(),
        };
        if self.request.levels.is_none() && smaller.len() > 2 {
            sets.push(smaller);
        }
        let ways = sets.iter().flat_map(|levels| holds.iter().map(|hold| (levels.clone(), *hold)));
        ways.collect()
    }

    /// Those of `ways` in which the joint is kept in `range` for the whole time, up to the first in
    /// which no level is rare.
    fn kept(
        &self,
        range: (f64, f64),
        ways: &[(Vec<f64>, (f64, f64))],
        division: Division,
    ) -> Vec<(Plan, Evenness)> {
        // At its end it is somewhere in the range, whatever is played.
        let free_run = self.known.free_run.as_ref();
        let least = free_run.map_or(0.0, |of| of.margin(at_rest(division.trial_s)));
        // Even a joint at rest may be off by so much to either side.
        if 2.0 * least > range.1 - range.0 {
            return Vec::new();
        }
        let all = ways.first().map_or(&[][..], |(levels, _)| levels.as_slice());
        let mut found = Vec::new();
        for (levels, hold_s) in ways {
            let seed = self.request.seed;
            let duration_s = division.trial_s;
            let steps = RandomSteps { levels: levels.clone(), hold_s: *hold_s, duration_s, seed };
            let Some((schedule, prediction)) = self.trials(&steps, range, division.trials) else {
                continue;
            };
            let Some(evenness) = Evenness::of(&schedule, levels) else { continue };
            let whole_s = self.duration_s;
            let plan = Plan {
                shortened_from_s: (!self.is_whole(division)).then_some(whole_s),
                start_tolerance: self.start_tolerance(self.rig.range.unwrap_or(range)),
                ..Plan::new(schedule, Some(prediction), *hold_s).leaving_out(all)
            };
            found.push((plan, evenness));
            if evenness == Evenness::Even {
                break;
            }
        }
        found
    }

    /// So many trials of `steps` in which the joint is kept in `range`, and what is expected.
    fn trials(
        &self,
        steps: &RandomSteps,
        range: (f64, f64),
        trials: usize,
    ) -> Option<(Schedule, Prediction)> {
        let draws = if trials > 1 { DRAWS } else { 1 };
        let mut made: Option<(Schedule, Prediction)> = None;
        for trial in 0..trials {
            let (schedule, prediction) = (0..draws).find_map(|draw| {
                let before = made.as_ref().map(|(schedule, _)| schedule);
                let (draw, is_brought_back) = (trial * draws + draw, trials > 1);
                let behind = Behind { before, draw, is_brought_back };
                self.trial(steps, range, behind)
            })?;
            made = Some(match made {
                Some((before, expected)) => {
                    (before.followed_by(&schedule), expected.followed_by(prediction))
                }
                None => (schedule, prediction),
            });
        }
        made.filter(|(schedule, _)| schedule.steps() >= FEWEST_STEPS)
    }

    /// One of them.
    fn trial(
        &self,
        steps: &RandomSteps,
        range: (f64, f64),
        behind: Behind<'_>,
    ) -> Option<(Schedule, Prediction)> {
        let Self { rig, known, index, .. } = *self;
        let schedule = random_steps_within(steps, (rig, index), known, range, behind);
        let is_whole = schedule.samples() == samples_in(steps.duration_s, rig.period);
        if !is_whole || schedule.steps() < FEWEST_STEPS_OF_TRIAL {
            return None;
        }
        let prediction = rig.prediction(known, &schedule);
        prediction.kept_until(range).is_none().then_some((schedule, prediction))
    }
}

/// Rest for so many seconds.
fn at_rest(seconds: f64) -> Travel {
    Travel { seconds, ..Travel::default() }
}

/// How evenly levels are played, worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Evenness {
    /// Some are not.
    Partial,
    /// Some are rare.
    Rare,
    /// All are about as frequent.
    Even,
}

impl Evenness {
    /// How evenly `schedule` plays `levels`; `None` where none of a sign that they have is played.
    fn of(schedule: &Schedule, levels: &[f64]) -> Option<Self> {
        /// A level is rare that is played so many times less often than on average.
        const RARE: usize = 3;
        let played = schedule.levels();
        let has = |levels: &[f64], sign: f64| levels.iter().any(|level| sign * level > 0.0);
        if [1.0, -1.0].into_iter().any(|sign| has(levels, sign) && !has(&played, sign)) {
            return None;
        }
        let fewest = fewest_visits(schedule, levels);
        Some(match fewest {
            0 => Self::Partial,
            _ if fewest * levels.len() * RARE >= schedule.holds().len() => Self::Even,
            _ => Self::Rare,
        })
    }
}

/// How often that of `levels` is played which is played least often.
fn fewest_visits(schedule: &Schedule, levels: &[f64]) -> usize {
    let visits =
        |level: &f64| schedule.holds().iter().filter(|hold| !differ(hold.level, *level)).count();
    levels.iter().map(visits).min().unwrap_or(0)
}
