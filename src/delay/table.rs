//! The delays of a joint by the kind of step and its levels: what a controller looks up.

use std::cmp::Ordering;

use super::condition::Condition;
use super::decision::{Decision, Verdict};
use super::estimate::TrialEstimate;
use super::hold::{alike, level_tolerance};
use super::neutral::{Neutral, Transition};
use super::typical::{Scatter, StepSample, TypicalDelay};
use crate::experiment::{Joint, Trial};
use crate::numerics::limits;

/// Pairs of levels above which the steps of a kind are put together in bins: chosen; seven
/// levels on both sides of neutral are still a row each.
const MOST_PAIRS: usize = 14;

/// Steps that a bin holds at least: the fewest whose median has an interval of its own.
const BIN: usize = 6;

/// Accepted steps below which a kind has no typical delay (chosen).
const FEWEST: usize = 3;

/// Part of the steps of a kind that is accepted at least, or its delay is not typical: where
/// most are rejected, those that are left are a selection (chosen).
const LEAST_SHARE: f64 = 1.0 / 3.0;

/// The delays of one joint by kind and level.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayTable {
    /// Where the input is neutral, where that is known.
    pub neutral: Option<Neutral>,
    /// A row per kind and pair of levels, in the order of [`Transition::ALL`], then of the
    /// levels.
    pub rows: Vec<DelayRow>,
    /// The delay over the level, for each kind, side of neutral and direction.
    pub curves: Vec<DelayCurve>,
    /// All steps of a kind together, for each kind that there is.
    pub kinds: Vec<KindDelay>,
}

/// The steps of one kind between two levels, or between two bins of levels.
///
/// Where a kind has more than fourteen pairs of levels, its steps are put together for each
/// side of neutral and direction: starts and stops in up to three bins of the level that is
/// not neutral, the others in up to two bins of the size of the step, each of at least six
/// steps. The levels are then the means of the bin.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayRow {
    /// Which kind.
    pub transition: Transition,
    /// Level before, input units.
    pub level_from: f64,
    /// Level after, input units.
    pub level_to: f64,
    /// The least and the greatest level before.
    pub from_limits: (f64, f64),
    /// The least and the greatest level after.
    pub to_limits: (f64, f64),
    /// Steps of the input.
    pub steps: usize,
    /// Those whose delay was accepted.
    pub accepted: usize,
    /// Their delays; none where none was accepted.
    pub delay: Option<TypicalDelay>,
}

/// The delay over the level, of the steps of one kind on one side in one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct DelayCurve {
    /// Which kind.
    pub transition: Transition,
    /// Which side of neutral: that of the level which is not neutral, for reversals that of
    /// the level after; equal where neutral is not known.
    pub side: Ordering,
    /// Whether the input rises.
    pub rises: bool,
    /// In rising order of the level.
    pub points: Vec<CurvePoint>,
}

/// The delays at one level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// The level: for a stop that before, else that after; input units.
    pub level: f64,
    /// Accepted steps.
    pub accepted: usize,
    /// Their delays.
    pub delay: TypicalDelay,
}

/// All steps of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KindDelay {
    /// Which kind.
    pub transition: Transition,
    /// Steps of the input.
    pub steps: usize,
    /// Those whose delay was accepted.
    pub accepted: usize,
    /// The typical delay; none where fewer than three steps, or less than a third of them,
    /// were accepted.
    pub typical: Option<TypicalDelay>,
    /// What most of the others were rejected for, and how many.
    pub rejected: Option<(Condition, usize)>,
}

impl KindDelay {
    /// Whether the medians of `kinds` differ by more than is uncertain, so that they have no
    /// common one.
    pub fn differ(kinds: &[Self]) -> bool {
        let typical = || kinds.iter().filter_map(|kind| kind.typical?.interval_s);
        typical().any(|(low, _)| typical().any(|(_, high)| high < low))
    }
}

/// A step, its levels put together with those that are the same.
#[derive(Clone, Copy, Debug)]
struct KindStep {
    course: Course,
    from: f64,
    to: f64,
    sample: Option<StepSample>,
    verdict: Verdict,
}

/// Steps that are alike but for their levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Course {
    transition: Transition,
    side: Ordering,
    rises: bool,
}

impl DelayTable {
    /// The table of `joint`; `estimates` has one entry per trial of it, in order, none where
    /// there is no estimate.
    pub fn of<'a>(
        joint: &'a Joint,
        estimates: impl IntoIterator<Item = Option<&'a TrialEstimate>>,
    ) -> Self {
        let tolerance = level_tolerance(&joint.trials);
        let neutral = Neutral::of(&joint.trials);
        let trials = joint.trials.iter().zip(estimates);
        let estimated = trials.filter_map(|(trial, estimate)| Some((trial, estimate?)));
        let decisions = estimated.flat_map(|(trial, estimate)| {
            estimate.decisions.iter().map(move |decision| (trial, decision))
        });
        let step = |(trial, decision)| KindStep::of(trial, decision, neutral.as_ref());
        let mut steps: Vec<KindStep> = decisions.map(step).collect();
        join_levels(&mut steps, tolerance);
        let (mut kinds, mut curves, mut rows) = (Vec::new(), Vec::new(), Vec::new());
        for transition in Transition::ALL {
            let own = steps.iter().filter(|step| step.course.transition == transition);
            let own: Vec<KindStep> = own.copied().collect();
            kinds.extend(summary(&own));
            curves.extend(self::curves(&own));
            rows.extend(self::rows(own));
        }
        Self { neutral, rows, curves, kinds }
    }
}

impl KindStep {
    fn of(trial: &Trial, decision: &Decision, neutral: Option<&Neutral>) -> Self {
        let step = decision.input_step;
        let transition = Transition::of(&step, neutral);
        let sided = if transition == Transition::Stop { step.before } else { step.after };
        let side = neutral.map_or(Ordering::Equal, |neutral| neutral.side(sided));
        Self {
            course: Course { transition, side, rises: step.after > step.before },
            from: step.before,
            to: step.after,
            sample: StepSample::of(decision, trial.period()),
            verdict: decision.verdict(),
        }
    }

    /// The level that the delay is looked up by.
    fn level(&self) -> f64 {
        if self.course.transition == Transition::Stop { self.from } else { self.to }
    }

    /// What bins are made of.
    fn size(&self) -> f64 {
        match self.course.transition {
            Transition::Start | Transition::Stop => self.level(),
            Transition::Change | Transition::Reversal => (self.to - self.from).abs(),
        }
    }
}

/// Replaces levels that lie within `tolerance` by the middle one of them.
fn join_levels(steps: &mut [KindStep], tolerance: f64) {
    let mut levels: Vec<f64> = steps.iter().flat_map(|step| [step.from, step.to]).collect();
    levels.sort_by(f64::total_cmp);
    let joined: Vec<(f64, f64)> = alike(&levels, |level| *level, tolerance)
        .into_iter()
        .map(|same| (same[0], same[same.len() / 2]))
        .collect();
    let middle = |level: f64| {
        let index = joined.partition_point(|(least, _)| *least <= level);
        index.checked_sub(1).and_then(|index| joined.get(index)).map_or(level, |found| found.1)
    };
    for step in steps {
        (step.from, step.to) = (middle(step.from), middle(step.to));
    }
}

/// The rows of a kind, of all its steps.
fn rows(mut same: Vec<KindStep>) -> Vec<DelayRow> {
    let pair = |a: &KindStep, b: &KindStep| a.from.total_cmp(&b.from).then(a.to.total_cmp(&b.to));
    same.sort_by(pair);
    let pairs: Vec<_> = same.chunk_by(|a, b| pair(a, b).is_eq()).collect();
    if pairs.len() <= MOST_PAIRS {
        return each_with(&pairs, row);
    }
    let transition = same.first().map(|step| step.course.transition);
    let most = if matches!(transition, Some(Transition::Start | Transition::Stop)) { 3 } else { 2 };
    same.sort_by(|a, b| a.course.cmp(&b.course).then(a.size().total_cmp(&b.size())));
    let courses = same.chunk_by(|a, b| a.course == b.course);
    let bins: Vec<_> = courses.flat_map(|course| bins(course, most, KindStep::size)).collect();
    each_with(&bins, row)
}

/// What `make` makes of each group of steps, and of how much all of them scatter.
fn each_with<T>(
    groups: &[&[KindStep]],
    make: impl Fn(&[KindStep], Scatter) -> Option<T>,
) -> Vec<T> {
    let delays: Vec<Vec<StepSample>> = groups.iter().map(|group| samples(group)).collect();
    let scatter = Scatter::pooled(delays.iter().map(Vec::as_slice));
    groups.iter().filter_map(|group| make(group, scatter)).collect()
}

/// Up to `most` bins of about as many steps each, of at least [`BIN`]; steps of one size
/// stay together. `steps` are sorted by their size.
fn bins(steps: &[KindStep], most: usize, size: fn(&KindStep) -> f64) -> Vec<&[KindStep]> {
    let count = (steps.len() / BIN).clamp(1, most);
    let mut bins = Vec::new();
    let mut done = 0;
    for number in 1..=count {
        let end = steps.len() * number / count;
        let last = end.checked_sub(1).and_then(|last| steps.get(last)).map_or(0.0, size);
        // A size is never split between two bins.
        let end = steps.partition_point(|step| size(step) <= last);
        bins.extend(steps.get(done..end).filter(|bin| !bin.is_empty()));
        done = done.max(end);
    }
    bins
}

fn row(steps: &[KindStep], scatter: Scatter) -> Option<DelayRow> {
    let (from, to) = (spread(steps, |step| step.from), spread(steps, |step| step.to));
    let samples = samples(steps);
    Some(DelayRow {
        transition: steps.first()?.course.transition,
        level_from: from.0,
        level_to: to.0,
        from_limits: from.1,
        to_limits: to.1,
        steps: steps.len(),
        accepted: samples.len(),
        delay: TypicalDelay::of(&samples, scatter),
    })
}

/// Mean and limits of a level; exactly that level where there is only one.
fn spread(steps: &[KindStep], level: impl Fn(&KindStep) -> f64) -> (f64, (f64, f64)) {
    let (low, high) = limits(steps.iter().map(&level));
    let mean = low + steps.iter().map(|step| level(step) - low).sum::<f64>() / steps.len() as f64;
    (mean, (low, high))
}

/// The delays that were accepted.
fn samples(steps: &[KindStep]) -> Vec<StepSample> {
    let accepted = steps.iter().filter(|step| step.verdict == Verdict::Accepted);
    accepted.filter_map(|step| step.sample).collect()
}

/// The curves of all courses of a kind with an accepted step.
fn curves(same: &[KindStep]) -> Vec<DelayCurve> {
    let accepted = same.iter().filter(|step| step.verdict == Verdict::Accepted);
    let mut accepted: Vec<KindStep> = accepted.copied().collect();
    accepted.sort_by(|a, b| a.course.cmp(&b.course).then(a.level().total_cmp(&b.level())));
    let courses = accepted.chunk_by(|a, b| a.course == b.course);
    courses.filter_map(|steps| Some(curve(steps.first()?.course, steps))).collect()
}

fn curve(course: Course, steps: &[KindStep]) -> DelayCurve {
    let levels: Vec<_> = steps.chunk_by(|a, b| a.level().total_cmp(&b.level()).is_eq()).collect();
    let is_dense = levels.len() > MOST_PAIRS;
    let groups = if is_dense { bins(steps, MOST_PAIRS, KindStep::level) } else { levels };
    let point = |steps: &[KindStep], scatter| {
        let (level, _) = spread(steps, KindStep::level);
        let samples = samples(steps);
        let delay = TypicalDelay::of(&samples, scatter)?;
        Some(CurvePoint { level, accepted: samples.len(), delay })
    };
    let Course { transition, side, rises } = course;
    DelayCurve { transition, side, rises, points: each_with(&groups, point) }
}

/// What the steps of a kind have in common.
fn summary(same: &[KindStep]) -> Option<KindDelay> {
    let samples = samples(same);
    let count = |condition: Condition| {
        let rejected = Verdict::Rejected(condition);
        (condition, same.iter().filter(|step| step.verdict == rejected).count())
    };
    let counts = Condition::ALL.into_iter().map(count).filter(|(_, steps)| *steps > 0);
    let enough =
        samples.len() >= FEWEST.max(1) && samples.len() as f64 >= LEAST_SHARE * same.len() as f64;
    Some(KindDelay {
        transition: same.first()?.course.transition,
        steps: same.len(),
        accepted: samples.len(),
        typical: TypicalDelay::of(&samples, Scatter::pooled([samples.as_slice()]))
            .filter(|_| enough),
        // Of equal numbers the condition that comes first.
        rejected: counts.rev().max_by_key(|(_, steps)| *steps),
    })
}
