//! Dead time apart from lag: the broken line behind a lag that all steps share.
//!
//! The lag comes from the whole joint ([`Joint`]); then each step's dead time is found
//! between its neighbours, together with them where holds are short, and with what earlier
//! steps left as part of the fit. A joint without a lag is left to the broken line.

use std::ops::Range;

use super::basis::Basis;
use super::broken_line;
use super::chain::{Chain, Link, ceil};
use super::decision::Decision;
use super::hinge::{self, Place};
use super::interval::FineDelay;
use super::lag_search::Joint;
use super::prepared::Prepared;
use super::response::{Lag, Shape};
use super::search::Candidates;
use super::settings::Settings;
use super::steps::InputStep;
use super::stretch::{FINE, Linearised, Stretch};
use crate::numerics::Line;
use crate::numerics::NoiseModel;
use crate::numerics::student_quantile;
use crate::units::SamplePeriod;

/// Reactions in a stretch that helps to find the lag.
const TOGETHER: usize = 4;

/// Samples that are enough to tell what kind of lag it is, and to know it well.
const ENOUGH: [usize; 2] = [6_000, 20_000];

/// Times that the lag is looked for where holds are short, at most.
const ROUNDS: usize = 12;

/// The first of them, in which a simpler lag is taken although its squared error is larger by
/// this part.
const CAUTIOUS: usize = 2;
const CAUTION: f64 = 0.02;

/// Times that reactions are searched where holds are short.
const PASSES: usize = 3;

/// Samples by which a place that only bounds its neighbours may still move.
const ROUGHLY: f64 = 0.2;

/// A reaction that noise makes so often does not bound its neighbours.
const DOUBTFUL: f64 = 0.01;

/// The same where holds are short: a small one that is there spoils its neighbours more
/// than one that is not.
const DOUBTFUL_IF_SHORT: f64 = 0.3;

/// The lag that the trials of a joint share.
pub(super) fn lag_of(trials: &[Prepared<'_>], settings: &Settings) -> Lag {
    let Some(period) = trials.first().map(|trial| trial.period) else { return Lag::none() };
    let alike: Vec<_> = trials.iter().filter(|trial| trial.period == period).collect();
    let chains: Vec<_> = alike
        .iter()
        .map(|trial| (trial.output(), rough(trial.output(), &trial.steps, settings)))
        .collect();
    let all = chains.iter().flat_map(|(output, chain)| stretches(output, chain, Places::Rough));
    let all: Vec<_> = all.collect();
    let clear = chains.iter().all(|(_, chain)| chain.in_time());
    let enough = if clear { ENOUGH[0] } else { ENOUGH[1] };
    let mut found = Joint::new(some(all.clone(), enough)).best();
    if found.shape.order() == 0 && found.is_faint() {
        found = Joint::new(some(all, ENOUGH[1])).best();
    }
    if found.shape.order() == 0 {
        return Lag::new(period, found.shape, found.covariance());
    }
    // With the dead times known better, stretches reach as far as they may.
    for round in 0..if clear { 1 } else { ROUNDS } {
        let known = known(&chains, &found);
        let all = known.iter().flat_map(|it| stretches(it.output, &it.chain, Places::Known));
        let again = Joint::new(some(all.collect(), ENOUGH[1]));
        if again.stretches.is_empty() {
            break;
        }
        let again = again.under(found.shape, found.noise.clone());
        // Places suit the lag behind which they were found: at first only what is plain counts.
        let caution = if round < CAUTIOUS { CAUTION } else { 0.0 };
        let before = found.shape;
        found = if clear { again.settled_again() } else { again.reconsidered(caution) };
        // A pole too many makes places that speak for it, which it takes some rounds to undo.
        let has_settled = round > CAUTIOUS && found.shape.is_near(&before);
        if found.shape.order() == 0 || has_settled {
            break;
        }
    }
    Lag::new(period, found.shape, found.covariance())
}

/// The reactions of each trial behind the lag that was found.
fn known<'a>(chains: &[(&'a [f64], Chain)], found: &Joint<'_>) -> Vec<Reactions<'a>> {
    let known = |(output, chain): &(&'a [f64], Chain)| {
        let chain = behind(chain, output, &found.shape);
        Reactions::of(output, chain, found.shape, found.noise.clone()).settled(1)
    };
    chains.iter().map(known).collect()
}

/// Where broken lines put the reactions. What they leave of a lag is no noise, so its
/// memory is not asked for.
fn rough(output: &[f64], steps: &[InputStep], settings: &Settings) -> Chain {
    let (mut chain, _) = hinge::located(output, steps, settings, 1);
    chain.links.iter_mut().for_each(|link| link.counts = true);
    chain
}

/// About where reactions behind a lag begin, given where broken lines put them. Where holds
/// are short, what is left of earlier reactions hides which one belongs to which step.
fn behind(rough: &Chain, output: &[f64], shape: &Shape) -> Chain {
    let chain = rough.clone();
    if chain.in_time() { chain.without(shape) } else { chain.behind(shape, output) }
}

/// How well the places of a chain are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Places {
    /// From broken lines: late by the lag, and not judged.
    Rough,
    Known,
}

/// Stretches of a few reactions each, with the places of the chain. Each begins and ends where
/// no other reaction can be, as well as their places are known.
fn stretches<'a>(output: &'a [f64], chain: &Chain, places: Places) -> Vec<Stretch<'a>> {
    /// Samples that a reaction needs before the next one may be.
    const ROOM: f64 = 10.0;
    /// Samples by which a reaction of another step may be later than it was found, behind a
    /// lag that is not known yet.
    const GUARD: usize = 4;
    let rough = places == Places::Rough;
    let least = if rough || chain.in_time() { 0 } else { GUARD };
    let counting: Vec<_> = chain.links.iter().filter(|link| rough || link.counts).collect();
    let groups = counting.chunks(TOGETHER).enumerate();
    let range = |(index, group): (usize, &[&Link])| {
        let before = (index * TOGETHER).checked_sub(1).and_then(|i| counting.get(i));
        let start = before.map_or(0, |before| ceil(before.place) + before.guard().max(least));
        let next = counting.get((index + 1) * TOGETHER);
        let last = group.last()?.place;
        let end = match next {
            None => output.len(),
            // Nothing reacts to an input that has not changed yet.
            Some(next) if rough && next.origin as f64 > last + ROOM => next.origin,
            Some(next) => ceil(next.place).saturating_sub(next.guard()),
        };
        let known = output.get(start..end).is_some_and(|values| values.len() > 8 * group.len());
        known.then(|| (start..end, group.iter().map(|link| link.place - start as f64).collect()))
    };
    let ranges: Vec<(Range<usize>, Vec<f64>)> = groups.filter_map(range).collect();
    let stretch = |(index, (range, places)): (usize, &(Range<usize>, Vec<f64>))| {
        let before = index.checked_sub(1).and_then(|before| ranges.get(before));
        let first = before.map_or(0, |(before, _)| before.end.saturating_sub(range.start));
        let after = ranges.get(index + 1);
        let last = after.map_or(0, |(after, _)| range.end.saturating_sub(after.start));
        let values = output.get(range.clone())?;
        Some(Stretch { values, places: places.clone(), shared: (first, last) })
    };
    ranges.iter().enumerate().filter_map(stretch).collect()
}

/// Enough of the stretches, from all over the record.
fn some(stretches: Vec<Stretch<'_>>, enough: usize) -> Vec<Stretch<'_>> {
    let samples: usize = stretches.iter().map(|stretch| stretch.values.len()).sum();
    let every = samples.div_ceil(enough).max(1);
    let mut some: Vec<_> = stretches.into_iter().step_by(every).collect();
    if every > 1 {
        for stretch in &mut some {
            stretch.shared = (0, 0);
        }
    }
    some
}

/// The decisions on all steps of a trial with this lag.
pub(super) fn decide_all(
    output: &[f64],
    steps: &[InputStep],
    lag: &Lag,
    period: SamplePeriod,
    settings: &Settings,
) -> Vec<Decision> {
    let shape = lag.shape_at(period);
    let chain = behind(&rough(output, steps, settings), output, &shape);
    let trial = Reactions::of(output, chain, shape, NoiseModel::white()).settled(2);
    let decide = |(index, step): (usize, &InputStep)| {
        let place = Place { steps, index, step: *step, output, settings };
        trial.decision(&place, lag)
    };
    steps.iter().enumerate().map(decide).collect()
}

/// The reactions of a trial behind a known lag.
struct Reactions<'a> {
    output: &'a [f64],
    chain: Chain,
    basis: Basis,
    noise: NoiseModel,
    /// Whether holds are long beside delays.
    in_time: bool,
}

/// A reaction between its neighbours.
struct Found<'a> {
    /// The samples it was fitted to.
    range: Range<usize>,
    stretch: Stretch<'a>,
    fit: Linearised,
}

impl<'a> Reactions<'a> {
    /// The reactions behind this lag, from about where they are.
    fn of(output: &'a [f64], chain: Chain, shape: Shape, noise: NoiseModel) -> Self {
        let in_time = chain.in_time();
        let basis = Basis::of(&shape, output.len());
        Self { output, chain, basis, noise, in_time }
    }

    /// The same after all reactions were searched between neighbours of the time before,
    /// `times` or, where holds are short, some more.
    fn settled(mut self, times: usize) -> Self {
        let passes = if self.in_time { times } else { PASSES };
        for _ in 0..passes {
            self.noise = self.settle();
            self.in_time = self.chain.in_time();
        }
        self
    }

    /// Searches all reactions; tells the noise about them.
    fn settle(&mut self) -> NoiseModel {
        /// Reactions that are enough to know the noise.
        const ENOUGH: usize = 100;
        // Where holds are short a place that is not fine may be taken for a neighbour's.
        let fine = if self.in_time { ROUGHLY } else { FINE };
        let doubtful = if self.in_time { DOUBTFUL } else { DOUBTFUL_IF_SHORT };
        let every = self.chain.links.len().div_ceil(ENOUGH).max(1);
        let mut leftovers = Vec::new();
        for index in 0..self.chain.links.len() {
            let Some(found) = self.find(index, fine) else { continue };
            if index % every == 0 {
                leftovers.push(found.stretch.leftover(&self.basis.shape));
            }
            let p_value = self.chance(index, &found);
            if let Some(link) = self.chain.links.get_mut(index) {
                link.place = found.place();
                link.counts = p_value <= doubtful;
                link.error = found.place_error();
            }
        }
        NoiseModel::left_by(&leftovers)
    }

    /// The reaction of step `index`, with its neighbours where they are near, after a step of no
    /// more than `fine` samples.
    fn find(&self, index: usize, fine: f64) -> Option<Found<'a>> {
        /// Samples behind a transient that a line needs.
        const LINE: f64 = 20.0;
        let link = self.chain.links.get(index)?;
        let room = self.basis.response.settling() + LINE;
        let near = |other: &usize| {
            let other = self.chain.links.get(*other);
            other.is_some_and(|other| (other.place - link.place).abs() < room)
        };
        let before = self.chain.before(index).filter(near);
        let after = self.chain.after(index).filter(near);
        let first = before.unwrap_or(index);
        let last = after.unwrap_or(index);
        let range = self.chain.window(first).start..self.chain.window(last).end;
        let values = self.output.get(range.clone())?;
        let members: Vec<usize> = before.into_iter().chain(after).chain([index]).collect();
        let of = |member: &usize| self.chain.links.get(*member);
        let places = members.iter().filter_map(of).map(|link| link.place - range.start as f64);
        let places: Vec<f64> = places.collect();
        let limits = members.iter().map(|member| self.limits(*member, &range));
        let limits: Vec<_> = limits.collect();
        if values.len() < 2 * (self.basis.response.modes() + 2 * places.len()) + broken_line::FEWEST
        {
            return None;
        }
        let mut stretch = Stretch::alone(values, places);
        let mut fit = stretch.settle(&self.basis, &self.noise, &limits, fine);
        if members.len() > 1 || Self::is_vague(&fit, values.len()) {
            self.look_around(&mut stretch, &mut fit, &limits, fine);
        }
        Some(Found { range, stretch, fit })
    }

    /// Where a reaction may be, as indices of a window.
    fn limits(&self, index: usize, range: &Range<usize>) -> (f64, f64) {
        let Some(link) = self.chain.links.get(index) else { return (0.0, 0.0) };
        let place = |at: Option<usize>| Some(self.chain.links.get(at?)?.place + 1.0);
        let start = range.start as f64;
        let low = place(self.chain.before(index)).unwrap_or(0.0).max(link.earliest as f64);
        let high = place(self.chain.after(index)).unwrap_or(f64::INFINITY) - 2.0;
        let last = if self.in_time { link.last_place() } else { link.latest };
        let high = high.min(last as f64).min(range.end as f64 - 2.0);
        (low - start, (high - start).max(low - start))
    }

    /// Whether the place is so badly known that another one may be better.
    fn is_vague(fit: &Linearised, samples: usize) -> bool {
        let variance = fit.sse / samples as f64 * fit.place_variance();
        variance.is_nan() || variance > 0.25
    }

    /// Tries the reaction all over its limits, and settles where it is best.
    fn look_around(
        &self,
        stretch: &mut Stretch<'a>,
        fit: &mut Linearised,
        limits: &[(f64, f64)],
        fine: f64,
    ) {
        const TRIED: u32 = 12;
        let Some(&(low, high)) = limits.last() else { return };
        let tried =
            (0..TRIED).map(|n| low + (high - low) * (f64::from(n) + 0.5) / f64::from(TRIED));
        let at = |place: f64| {
            let mut there = stretch.clone();
            if let Some(last) = there.places.last_mut() {
                *last = place;
            }
            let sse = there.at(&self.basis, &self.noise).sse;
            (sse, there)
        };
        let best = tried.map(at).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, mut there)) = best else { return };
        let found = there.settle(&self.basis, &self.noise, limits, fine);
        if found.sse < fit.sse {
            (*stretch, *fit) = (there, found);
        }
    }

    /// The chance that noise alone looks as much like this reaction.
    fn chance(&self, index: usize, found: &Found<'_>) -> f64 {
        let ends = self.limits(index, &found.range);
        let others = found.fit.parameters() - 2;
        let rows = found.range.len().saturating_sub(self.noise.order()) as f64;
        let (dimensions, samples) = (rows - others as f64, found.range.len() as f64);
        broken_line::chance(found.fit.share(), dimensions, samples, ends)
    }

    fn decision(&self, place: &Place<'_>, lag: &Lag) -> Decision {
        let found = self.find(place.index, FINE);
        let range = self.chain.window(place.index);
        let Some(found) = found else {
            return place.decision(range, Candidates::default(), None, None);
        };
        let p_value = self.chance(place.index, &found);
        let origin = place.step.sample as f64 - 1.0;
        let fine = self.fine(&found, origin, lag, place.settings.interval);
        let candidates = self.candidates(&found);
        place.decision(range, candidates, Some(fine), Some(p_value))
    }

    /// The dead time and its interval, in which the uncertainty of the lag has its part.
    fn fine(&self, found: &Found<'_>, origin: f64, lag: &Lag, confidence: f64) -> FineDelay {
        let with_shape = found.stretch.with_shape(&self.basis.shape, &self.noise, &found.fit.parts);
        let rows = found.range.len() - self.noise.order();
        let freedom = (rows as f64 - found.fit.parameters() as f64).max(1.0);
        let noise = found.fit.sse / freedom;
        let t = student_quantile(f64::midpoint(1.0, confidence), freedom);
        let own = t * (noise * found.fit.place_variance()).sqrt();
        let shared = t * lag.variance_along(&with_shape.place_slopes()).sqrt();
        let side = |sign: f64| {
            let reach = found.reach(sign * own, noise * t * t, &self.basis, &self.noise);
            sign * reach.hypot(shared)
        };
        let delay = found.place() - origin;
        let clear = own < 1e6;
        let (low, high) = if clear { (side(-1.0), side(1.0)) } else { (-own, own) };
        let ends = (delay + low, delay + high);
        let middle = broken_line::middle(delay, ends, t);
        FineDelay::from_zero(middle, ends.0, ends.1, confidence)
    }

    /// The reaction where it was found, and a sample to each side.
    fn candidates(&self, found: &Found<'_>) -> Candidates {
        let there = |by: f64| {
            let mut there = found.stretch.clone();
            there.places.iter_mut().rev().take(1).for_each(|place| *place += by);
            let fit = there.at(&self.basis, &self.noise);
            (fit.sse, self.lines(&there, &fit, found.range.start))
        };
        let best = (found.fit.sse, self.lines(&found.stretch, &found.fit, found.range.start));
        let all = [there(-1.0), best, there(1.0)];
        let (sse, lines): (Vec<f64>, Vec<(Line, Line)>) = all.into_iter().unzip();
        Candidates::fitted(ceil(found.place()).saturating_sub(1), sse, lines.into_iter().unzip(), 1)
    }

    /// The lines that the output approaches before and after, over sample numbers.
    fn lines(&self, stretch: &Stretch<'_>, fit: &Linearised, start: usize) -> (Line, Line) {
        let [value, slope, ..] = *fit.parts.as_slice() else {
            return (Line::default(), Line::default());
        };
        let first = start as f64 + 1.0;
        let place = stretch.places.last().copied().unwrap_or_default();
        let offset = stretch.values.first().copied().unwrap_or_default();
        let before = Line { slope, intercept: value + offset - slope * first };
        let change = fit.change();
        let at = first + place + self.basis.response.mean;
        (before, Line { slope: slope + change, intercept: before.intercept - change * at })
    }
}

impl Found<'_> {
    /// Index in the trial.
    fn place(&self) -> f64 {
        self.range.start as f64 + self.stretch.places.last().copied().unwrap_or_default()
    }

    /// Standard error of the place.
    fn place_error(&self) -> f64 {
        (self.fit.sse / self.range.len() as f64 * self.fit.place_variance()).sqrt()
    }

    /// How far the place may move, about as far as `guess`, until the squared error has
    /// grown by `growth`.
    fn reach(&self, guess: f64, growth: f64, basis: &Basis, noise: &NoiseModel) -> f64 {
        /// Half-widths in samples below which the error is a parabola.
        const PARABOLIC: f64 = 0.3;
        if guess.abs() < PARABOLIC || self.stretch.places.len() > 1 {
            return guess.abs();
        }
        let mut there = self.stretch.clone();
        there.places.iter_mut().for_each(|place| *place += guess);
        let grown = there.at(basis, noise).sse - self.fit.sse;
        let ratio = (growth / grown.max(f64::MIN_POSITIVE)).sqrt();
        guess.abs() * ratio.clamp(0.5, 3.0)
    }
}
