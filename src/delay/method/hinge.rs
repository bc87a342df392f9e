//! `hinge`: a continuous broken line at every step, with its break between samples and an
//! interval.
//!
//! [`located`] finds roughly where each onset is; each is then searched exactly between its
//! neighbours, with the noise of all residuals.

use std::ops::Range;

use super::interface::{DelayMethod, Shared};
use super::step_context::StepContext;
use crate::delay::broken_line::{BrokenLine, Evidence};
use crate::delay::decision::Decision;
use crate::delay::interval::FineDelay;
use crate::delay::onsets::{Onset, OnsetPath, break_window, located};
use crate::delay::prepared::Prepared;
use crate::delay::search::Candidates;
use crate::delay::segment::Segment;
use crate::delay::settings::{CONFIDENCE, Settings};
use crate::delay::spec::{Method, MethodSpec, Scope};
use crate::numerics::{Line, NoiseModel};
use crate::units::ceil_to_index;

static SPEC: MethodSpec = MethodSpec {
    id: "hinge",
    fits: "broken line",
    source: None,
    summary: "A continuous broken line, with intervals",
    has_rows: false,
    cuts_segments: false,
    has_intervals: true,
    scope: Scope::Trial,
    low_pass: None,
    confidence: Some(CONFIDENCE),
};

impl Method {
    /// A broken line whose parts meet between two samples, with an interval.
    pub const HINGE: Self = Self::of(&SPEC);
}

pub(super) struct Hinge;

impl DelayMethod for Hinge {
    fn method(&self) -> Method {
        Method::HINGE
    }

    fn decide(&self, trial: &Prepared<'_>, _: &Shared, settings: &Settings) -> Vec<Decision> {
        decide_by_broken_lines(trial, settings)
    }
}

/// Times that all onsets are searched between neighbours of the pass before: the first takes
/// the noise for white, the second knows its memory.
const PASSES: usize = 2;

/// A broken line within a trial; its positions are indices of `start ..`.
struct Found {
    start: usize,
    line: BrokenLine,
    evidence: Evidence,
}

/// The decisions on all steps of a trial.
pub(in crate::delay) fn decide_by_broken_lines(
    trial: &Prepared<'_>,
    settings: &Settings,
) -> Vec<Decision> {
    decide_all(trial, settings, |_| None)
}

/// The decisions on all steps of a trial; by broken lines where there is no `other`.
pub(super) fn decide_all(
    trial: &Prepared<'_>,
    settings: &Settings,
    other: impl Fn(&StepContext<'_>) -> Option<Decision>,
) -> Vec<Decision> {
    let (path, noise) = located(trial, settings, PASSES);
    let decide = |index| {
        let context = StepContext { trial, index, settings };
        other(&context).unwrap_or_else(|| decide(&context, &path, &noise))
    };
    (0..trial.steps.len()).map(decide).collect()
}

fn decide(context: &StepContext<'_>, path: &OnsetPath, noise: &NoiseModel) -> Decision {
    let StepContext { index, settings, .. } = *context;
    let output = context.output();
    let found = search(path, index, output, noise, settings.interval);
    let fine =
        found.as_ref().map(|found| from_rest(context, fine(found, &path.onsets[index], settings)));
    let p_value = found.as_ref().map(|found| found.line.p_value);
    let range = path.window(index);
    let segment = Segment::clipped(range.start + 1, range.end, output.len());
    let candidates = found.map_or_else(Candidates::default, candidates);
    let mut decision = context.decision(segment, 1, candidates, fine);
    if let Some(confidence) = settings.confidence {
        decision.test_reaction(context.departed().or(p_value), confidence);
    }
    decision
}

/// The best broken line at the onset of an index, between its neighbours.
fn search(
    path: &OnsetPath,
    index: usize,
    output: &[f64],
    noise: &NoiseModel,
    interval: f64,
) -> Option<Found> {
    let Range { start, end } = path.window(index);
    let (window, positions) = break_window(path, index, output.get(start..end)?, start, noise)?;
    // Lines are over the sample numbers of the trial, counted from 1.
    let (line, evidence) = window.fit(positions, interval, (start + 1) as f64)?;
    Some(Found { start, line, evidence })
}

/// The delay from the step's own sample on. A joint cannot move before its input does.
fn fine(found: &Found, onset: &Onset, settings: &Settings) -> FineDelay {
    let delay = |position: f64| found.start as f64 + position - onset.origin as f64;
    let BrokenLine { median, low, high, .. } = found.line;
    FineDelay::causal(delay(median), delay(low), delay(high), settings.interval)
}

/// `fine`, whose interval also holds the onsets of a joint that gathers speed from rest in a way
/// of its own: the lines meet behind them.
fn from_rest(context: &StepContext<'_>, fine: FineDelay) -> FineDelay {
    let Some((gradual, start)) = context.gradual() else { return fine };
    let origin = context.step().sample as f64 - 1.0 - start as f64;
    let other = gradual.delay(origin, fine.confidence);
    FineDelay { low: fine.low.min(other.low), high: fine.high.max(other.high), ..fine }
}

/// Every position that was tried, over the sample numbers of the trial.
fn candidates(found: Found) -> Candidates {
    let Found { start, line, evidence, .. } = found;
    let Evidence { first, mut sse, bends } = evidence;
    let best = ceil_to_index(line.position).saturating_sub(first).min(sse.len() - 1);
    // The break between samples takes the place of the one at the sample behind it.
    sse[best] = line.sse;
    let number = (start + 1) as f64;
    let over_numbers =
        |line: Line| Line { intercept: line.intercept - line.slope * number, ..line };
    let lines = (over_numbers(line.before), over_numbers(line.after));
    Candidates::broken(start + first, sse, bends, (best, lines))
}
