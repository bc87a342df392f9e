//! What the output does about each step of the input: rest, departure, arrival at a stop.
//!
//! An actuator that rests until the input steps, moves, and stands at its stop long before the
//! input steps again says two things that hold for every method. It cannot have begun to react
//! later than it has plainly left its rest; and what it does at its stop is no reaction to a step.
//!
//! A joint *rests* over `n` samples when the line through them, of slope `v` with the standard
//! error `e = s·√(12/n³)` and residuals of standard deviation `s`, is shown to be slower than the
//! part [`REST`] of the fastest motion so far, `v_max`, or shows nothing although it would show
//! a slow one:
//!
//! ```text
//! |v| + 2e ≤ REST · v_max      or      |v| ≤ 2e ≤ SLOW · v_max
//! ```
//!
//! A joint that turns has larger residuals about a line than its noise: the second holds only where `s` is
//! what the differences of neighbours say of the noise.
//!
//! It has *departed* once the output stays beyond that line by more than `6·s`, by more than the
//! part [`PLAIN`] of the motion to come, and by more than as much drift again as before. It has
//! *arrived* at a stop when it rests before the next step, although it was plainly driven: its
//! input was not eased, and it came faster than it went before the step, or from the other side.
//! A joint whose rest is not shown, as under much noise, is left alone.

use super::settings::{FirstLast, Settings};
use super::steps::InputStep;
use crate::numerics::{RunningLine, limits};
use crate::units::{SamplePeriod, ceil_to_index};

/// Part of the fastest motion up to which a joint rests.
const REST: f64 = 0.02;

/// Part of the fastest motion that would be seen in what shows none.
const SLOW: f64 = 0.1;

/// Part of the output's range so far that a joint at rest may still move by when its input goes
/// back to where the trial began: a cylinder that was pressed against its stop comes off it a
/// little when the valve closes.
const STILL: f64 = 0.03;

/// Part of the motion to come that the output has plainly moved by; a pressure transient moves
/// a joint by less before it starts.
const PLAIN: f64 = 0.002;

/// Standard deviations of the noise that the output has plainly moved by.
const BEYOND_NOISE: f64 = 6.0;

/// Seconds before a step over which a joint must rest, at most; and samples, at least.
const LOOK_BACK_S: f64 = 0.5;
const FEWEST: usize = 8;

/// Samples in a row that a departure lasts.
const PERSISTENT: usize = 3;

/// What the output does about one step; positions are indices of the trial's samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepMotion {
    /// The first sample that says something of this step.
    pub(super) first: usize,
    /// The last position that its reaction may have.
    pub(super) latest: usize,
    /// After the last sample that says something of it.
    pub(super) end: usize,
    /// What shows that the joint rested when the input stepped; none where it moved.
    pub(super) rest: Option<Rest>,
}

/// A joint that rested when the input stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rest {
    /// How far it moves until the next step, output units.
    pub(super) moved: f64,
    /// How far it may, for one that goes on resting.
    pub(super) limit: f64,
}

/// The probability that noise alone departs: beyond [`BEYOND_NOISE`] standard deviations of a
/// normal variable, to either side.
pub(super) const DEPARTED: f64 = 2e-9;

impl StepMotion {
    /// Whether the joint rested, and left its rest plainly.
    pub(super) fn departs(&self) -> bool {
        self.rest.is_some_and(|rest| !rest.lasts())
    }
}

impl Rest {
    /// Whether it went on resting.
    pub(super) fn lasts(&self) -> bool {
        self.moved <= self.limit
    }
}

/// Samples of a hold until its output stays so near to `level`; all where it does not.
pub(super) fn arrival(held: &[f64], level: f64, near: f64) -> usize {
    held.iter().rposition(|y| (y - level).abs() > near).map_or(0, |last| last + 1)
}

/// What the output does about each of `steps`; none where neither rest nor a stop is shown.
///
/// What is found of a step depends on no sample after the next one, so that it stays as a
/// record grows.
pub(super) fn motions(
    output: &[f64],
    steps: &[InputStep],
    period: SamplePeriod,
    settings: &Settings,
) -> Vec<Option<Box<StepMotion>>> {
    if settings.paper {
        return vec![None; steps.len()];
    }
    let look_back =
        ceil_to_index(LOOK_BACK_S / period.seconds()).clamp(FEWEST, output.len().max(FEWEST));
    let origin = steps.first().map_or(0.0, |first| first.before);
    let is_stroke =
        settings.first_last == FirstLast::Auto && settings.first_last.are_judged(steps.len());
    let mut so_far = SoFar::default();
    let motion = |(index, step): (usize, &InputStep)| {
        let before = index.checked_sub(1).and_then(|before| steps.get(before));
        let hold = Hold {
            output,
            since: before.map_or(0, |before| before.sample - 1),
            step: step.sample - 1,
            next: steps.get(index + 1).map(|next| next.sample - 1),
            look_back,
            reach: settings.alpha,
            is_eased: (step.after - origin).abs() < (step.before - origin).abs(),
            is_stroke,
        };
        so_far.add(&hold);
        // Of most steps nothing is shown, and a long log has a hundred thousand.
        hold.motion(&so_far).map(Box::new)
    };
    steps.iter().enumerate().map(motion).collect()
}

/// The fastest motion so far, output units per sample, and the range of the output.
#[derive(Clone, Copy, Debug)]
struct SoFar {
    fastest: f64,
    low: f64,
    high: f64,
}

impl Default for SoFar {
    fn default() -> Self {
        Self { fastest: 0.0, low: f64::INFINITY, high: f64::NEG_INFINITY }
    }
}

impl SoFar {
    /// Takes in what the output does until the next step, from every few of its samples.
    fn add(&mut self, hold: &Hold<'_>) {
        /// Looks per look back.
        const LOOKS: usize = 5;
        let held = hold.held();
        let every = (hold.look_back / LOOKS).max(1);
        let apart = hold.look_back.min(held.len().saturating_sub(1));
        for (k, y) in held.iter().enumerate().step_by(every) {
            self.low = self.low.min(*y);
            self.high = self.high.max(*y);
            if let Some(later) = held.get(k + apart).filter(|_| apart + 1 >= FEWEST) {
                self.fastest = self.fastest.max((later - y).abs() / apart as f64);
            }
        }
    }

    fn range(&self) -> f64 {
        (self.high - self.low).max(0.0)
    }
}

/// A step of the input and the output about it; positions are indices of the trial.
#[derive(Clone, Copy, Debug)]
struct Hold<'a> {
    output: &'a [f64],
    /// The step before, or the trial's start.
    since: usize,
    step: usize,
    /// The next step, if there is one.
    next: Option<usize>,
    look_back: usize,
    /// α.
    reach: usize,
    /// Whether the input comes nearer to where the trial began.
    is_eased: bool,
    /// Whether the trial has so few steps that it is a stroke: its motion lasts long, and bends.
    is_stroke: bool,
}

impl Hold<'_> {
    /// The output until the next step.
    fn held(&self) -> &[f64] {
        self.output.get(self.step..self.end()).unwrap_or_default()
    }

    fn end(&self) -> usize {
        self.next.unwrap_or(self.output.len())
    }

    fn motion(&self, so_far: &SoFar) -> Option<StepMotion> {
        match self.quiet_at(self.step).find(|quiet| quiet.rests(so_far)) {
            Some(rest) => self.leaving(&rest, so_far),
            None => self.stopping(so_far),
        }
    }

    /// The lines before a sample: what is sampled seldom needs longer to show its rest.
    fn quiet_at(&self, end: usize) -> impl Iterator<Item = Quiet> {
        let looks = [self.look_back, 2 * self.look_back];
        let (output, least) = (self.output, if end > self.step { self.step } else { 0 });
        let lines =
            looks.into_iter().filter(move |look_back| least + look_back <= end || least == 0);
        lines.filter_map(move |look_back| Quiet::before(output, end, look_back))
    }

    /// From rest: not far after the departure, where the joint does not go on as it started
    /// until the next step. Where it does, nothing needs to be known.
    fn leaving(&self, before: &Quiet, so_far: &SoFar) -> Option<StepMotion> {
        let moved = self.held().iter().map(|y| (y - before.level).abs()).fold(0.0, f64::max);
        let rest = Rest { moved, limit: self.limit_at_rest(before, so_far) };
        let first = self.step.saturating_sub(self.reach);
        if rest.lasts() && moved < so_far.range() {
            // A reaction that comes after the next step would not be seen.
            let long = self.next.is_none() || self.held().len() >= self.look_back;
            let end = self.end();
            return long.then_some(StepMotion { first, latest: end, end, rest: Some(rest) });
        }
        let departed = self.step + before.departure(self.held(), PLAIN * moved)?;
        let delay = departed - self.step;
        // After a rest that is shorter it might answer the step before.
        if self.since > 0 && self.step - self.since < delay {
            return None;
        }
        let moving = self.output.get(departed..self.end())?;
        let bends = self.is_stroke || self.quiet_at(self.end()).any(|quiet| quiet.rests(so_far));
        if !bends && before.moves_evenly(moving, delay) {
            return None;
        }
        let end = departed.saturating_add((delay / 2).max(self.reach)).min(self.end());
        Some(StepMotion { first, latest: departed, end, rest: Some(rest) })
    }

    /// How far a joint may move that goes on resting.
    fn limit_at_rest(&self, before: &Quiet, so_far: &SoFar) -> f64 {
        let still = STILL * so_far.range();
        let slow = REST * so_far.fastest * self.held().len() as f64;
        let limit = if self.is_eased { still } else { slow.min(still) };
        limit.max(BEYOND_NOISE * before.noise)
    }

    /// In motion, and at a stop before the next step. An input that is eased needs no stop to
    /// bring the joint to rest.
    fn stopping(&self, so_far: &SoFar) -> Option<StepMotion> {
        let held = self.held();
        if self.is_eased || held.len() < 2 * self.look_back {
            return None;
        }
        let before = Quiet::before(self.output, self.step, self.look_back)?;
        let at_stop = self.quiet_at(self.end()).find(|quiet| quiet.rests(so_far))?;
        let near = (PLAIN * so_far.range()).max(BEYOND_NOISE * at_stop.noise);
        let arrived = held.iter().rposition(|y| (y - at_stop.level).abs() > near)? + 1;
        // A joint that only ends its motion comes no faster than it went.
        let approach =
            held.get(..arrived).and_then(|held| Quiet::before(held, arrived, self.look_back))?;
        let driven = approach.speed * before.speed < 0.0
            || approach.speed.abs() > FASTER * before.speed.abs();
        let end = self.step + arrived;
        (driven && !approach.rests(so_far)).then_some(StepMotion {
            first: 0,
            latest: end,
            end,
            rest: None,
        })
    }
}

/// Times the noise of neighbours that the residuals about a line have, of a joint that does not
/// turn: more than white noise does in one of a thousand windows of eight.
const TURNS: f64 = 1.5;

/// Times as fast as before the step that a joint is plainly driven.
const FASTER: f64 = 1.2;

/// The line through a few samples.
#[derive(Clone, Copy, Debug)]
struct Quiet {
    samples: f64,
    /// Output units per sample.
    speed: f64,
    /// Its value at the last sample.
    level: f64,
    /// Standard deviation of the residuals.
    noise: f64,
    /// That of white noise with such differences between neighbours.
    rough: f64,
}

impl Quiet {
    /// Through the samples before `end`, at most `look_back` of them.
    fn before(output: &[f64], end: usize, look_back: usize) -> Option<Self> {
        let values = output.get(end.saturating_sub(look_back)..end)?;
        let origin = *values.first().filter(|_| values.len() >= FEWEST)?;
        let mut line = RunningLine::default();
        for y in values {
            line.push(y - origin);
        }
        let samples = values.len() as f64;
        let level = origin + line.mean() + line.slope() * (samples - 1.0) / 2.0;
        let noise = (line.sse() / (samples - 2.0)).sqrt();
        let differences = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>();
        // Differences of white noise have twice its variance.
        let rough = (differences / (2.0 * (samples - 1.0))).sqrt();
        Some(Self { samples, speed: line.slope(), level, noise, rough })
    }

    fn rests(&self, so_far: &SoFar) -> bool {
        // 2e, with e = s·√(12/n³).
        let uncertain = 2.0 * self.noise * (12.0 / self.samples.powi(3)).sqrt();
        let is_shown = self.speed.abs() + uncertain <= REST * so_far.fastest;
        let shows_none = self.speed.abs() <= uncertain
            && uncertain <= SLOW * so_far.fastest
            && self.noise <= TURNS * self.rough;
        so_far.fastest > 0.0 && (is_shown || shows_none)
    }

    /// Whether the joint, which departed after `delay` samples, moves on so evenly that a line
    /// through all of `moving` meets its rest no further off than the delay is long.
    ///
    /// A speed that changes by `Δv` over `n` samples bends the line so that it meets the rest
    /// about `n·Δv/(8·v)` samples off. The first quarter is left out, in which a joint gathers
    /// speed.
    fn moves_evenly(&self, moving: &[f64], delay: usize) -> bool {
        let quarter = moving.len() / 4;
        let at = |n: usize| moving.get(n * quarter).or(moving.last()).copied().unwrap_or_default();
        let ways = [1, 2, 3].map(|n| (at(n + 1) - at(n)).abs());
        let (least, most) = limits(ways);
        // n·Δv/(8·v) ≤ delay, times v.
        let off = moving.len() as f64 / 8.0 * (most - least - BEYOND_NOISE * self.noise);
        off <= delay as f64 * most.midpoint(least)
    }

    /// Samples of `held`, which follows, until the output has plainly left this line.
    fn departure(&self, held: &[f64], plain: f64) -> Option<usize> {
        let plain = plain.max(BEYOND_NOISE * self.noise);
        let side = |(k, y): (usize, &f64)| {
            let ahead = (k + 1) as f64;
            let away = y - self.level - self.speed * ahead;
            // The drift may be as large again as it was.
            let beyond = away.abs() > plain + self.speed.abs() * ahead;
            if beyond { away.signum() } else { 0.0 }
        };
        let sides: Vec<f64> = held.iter().enumerate().map(side).collect();
        sides.windows(PERSISTENT).position(|run| {
            let sum: f64 = run.iter().sum();
            sum.abs() >= PERSISTENT as f64
        })
    }
}
