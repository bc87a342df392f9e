//! A continuous broken line at every step, with its break between samples.
//!
//! The [`Chain`] tells roughly where each reaction is; each is then searched exactly
//! between its neighbours, with the noise that all fits leave. What turns out to be no
//! reaction no longer bounds its neighbours, which are searched again.

use std::ops::{Range, RangeInclusive};

use super::broken_line::{BrokenLine, Evidence, PARAMETERS, Window};
use super::chain::{Chain, Link, ceil};
use super::condition::{Facts, nothing_happened};
use super::decision::Decision;
use super::interval::FineDelay;
use super::search::Candidates;
use super::segment::Segment;
use super::settings::Settings;
use super::steps::InputStep;
use crate::numerics::Line;
use crate::numerics::NoiseModel;

/// Times that all reactions are searched between neighbours of the time before.
const PASSES: usize = 2;

/// A reaction that noise makes so often does not bound its neighbours.
const DOUBTFUL: f64 = 0.01;

/// A broken line within a trial; its places are indices of `start ..`.
struct Found {
    start: usize,
    line: BrokenLine,
    evidence: Evidence,
}

/// The decisions on all steps of a trial.
pub(super) fn decide_all(
    output: &[f64],
    steps: &[InputStep],
    settings: &Settings,
) -> Vec<Decision> {
    let (chain, noise) = located(output, steps, settings, PASSES);
    let decide = |(index, step): (usize, &InputStep)| {
        let found = search(&chain, index, output, &noise, settings.interval);
        decision(&Place { steps, index, step: *step, output, settings }, &chain, found)
    };
    steps.iter().enumerate().map(decide).collect()
}

/// Where each reaction is, and the noise about the lines, after `passes` at most; after
/// one the noise is taken for white.
pub(super) fn located(
    output: &[f64],
    steps: &[InputStep],
    settings: &Settings,
    passes: usize,
) -> (Chain, NoiseModel) {
    /// Samples that are enough to know the noise.
    const ENOUGH: usize = 50_000;
    let mut chain = Chain::of(output, steps, settings);
    let every = output.len().div_ceil(ENOUGH).max(1);
    let mut noise = NoiseModel::white();
    for pass in 0..passes {
        if pass > 0 && chain.in_time() && chain.is_fine() {
            break;
        }
        let mut residuals = Vec::new();
        for index in 0..chain.links.len() {
            let range = if pass == 0 { chain.cautious_window(index) } else { chain.window(index) };
            let start = range.start;
            let Some(values) = output.get(range.clone()) else { continue };
            let found = window(&chain, index, values, start, &noise);
            let Some(line) = found.and_then(|(window, places)| window.best(places)) else {
                continue;
            };
            if index % every == 0 {
                residuals.push(line.residuals(values));
            }
            if let Some(link) = chain.links.get_mut(index) {
                link.place = start as f64 + line.place;
                link.counts = line.p_value <= DOUBTFUL;
                link.error = line.place_error(values.len());
            }
        }
        noise = NoiseModel::of(&residuals, PARAMETERS);
    }
    (chain, noise)
}

/// The window of link `index`, which begins at `start`, and where its break may be.
fn window<'a>(
    chain: &Chain,
    index: usize,
    values: &[f64],
    start: usize,
    noise: &'a NoiseModel,
) -> Option<(Window<'a>, RangeInclusive<usize>)> {
    let link = chain.links.get(index)?;
    let window = Window::of(values, noise)?;
    let places = window.places();
    let first = link.earliest.saturating_sub(start).max(*places.start());
    let last = link.last_place().checked_sub(start)?.min(*places.end());
    Some((window, first..=last))
}

/// The best broken line at link `index`, between its neighbours.
fn search(
    chain: &Chain,
    index: usize,
    output: &[f64],
    noise: &NoiseModel,
    interval: f64,
) -> Option<Found> {
    let Range { start, end } = chain.window(index);
    let (window, places) = window(chain, index, output.get(start..end)?, start, noise)?;
    // Lines stand over the sample numbers of the trial, counted from 1.
    let (line, evidence) = window.fit(places, interval, (start + 1) as f64)?;
    Some(Found { start, line, evidence })
}

/// A step among all.
pub(super) struct Place<'a> {
    pub(super) steps: &'a [InputStep],
    pub(super) index: usize,
    pub(super) step: InputStep,
    pub(super) output: &'a [f64],
    pub(super) settings: &'a Settings,
}

fn decision(place: &Place<'_>, chain: &Chain, found: Option<Found>) -> Decision {
    let link = chain.links.get(place.index);
    let fine = found.as_ref().zip(link).map(|(found, link)| fine(found, link, place.settings));
    let range = chain.window(place.index);
    let p_value = found.as_ref().map(|found| found.line.p_value);
    let candidates = found.map_or_else(Candidates::default, candidates);
    place.decision(range, candidates, fine, p_value)
}

impl Place<'_> {
    /// The decision that follows from what was found in the samples of `range`.
    pub(super) fn decision(
        &self,
        range: Range<usize>,
        candidates: Candidates,
        fine: Option<FineDelay>,
        p_value: Option<f64>,
    ) -> Decision {
        let samples = self.output.len();
        let next = self.steps.get(self.index + 1).map_or(samples + 1, |next| next.sample);
        let hold = next - self.step.sample;
        let segment = Segment::clipped(range.start + 1, range.end, samples);
        let facts = Facts {
            step: self.index + 1,
            steps: self.steps.len(),
            input_sample: self.step.sample,
            hold,
            output: self.output.get(segment.indices()).unwrap_or_default(),
            rows: segment.len(),
            best: candidates.best(),
            fine,
        };
        let mut checks = facts.check(self.settings);
        if let (Some(confidence), Some(last)) = (self.settings.confidence, checks.last_mut()) {
            *last = nothing_happened(p_value, confidence);
        }
        let (number, input_step) = (self.index + 1, self.step);
        Decision { number, input_step, hold, segment, candidates, checks, fine }
    }
}

/// The delay from the step's own place on. A joint cannot move before it is told to.
fn fine(found: &Found, link: &Link, settings: &Settings) -> FineDelay {
    let delay = |place: f64| found.start as f64 + place - link.origin as f64;
    let BrokenLine { middle, low, high, .. } = found.line;
    FineDelay::from_zero(delay(middle), delay(low), delay(high), settings.interval)
}

impl FineDelay {
    /// A delay that cannot be below zero, unless all of its interval is.
    pub(super) fn from_zero(delay: f64, low: f64, high: f64, confidence: f64) -> Self {
        if high < 0.0 {
            return Self { delay, low, high, confidence };
        }
        Self { delay: delay.max(0.0), low: low.max(0.0), high, confidence }
    }
}

/// Every place that was tried, over the sample numbers of the trial.
fn candidates(found: Found) -> Candidates {
    let Found { start, line, evidence, .. } = found;
    let Evidence { first, mut sse, bends } = evidence;
    let best = ceil(line.place).saturating_sub(first).min(sse.len().saturating_sub(1));
    sse.iter_mut().skip(best).take(1).for_each(|slot| *slot = line.sse);
    let number = (start + 1) as f64;
    let over_numbers =
        |line: Line| Line { intercept: line.intercept - line.slope * number, ..line };
    let lines = (over_numbers(line.before), over_numbers(line.after));
    Candidates::broken(start + first, sse, bends, (best, lines))
}
