//! `lag-aware`: dead time apart from lag, the broken line behind a lag that all steps share.
//!
//! The lag comes from the whole joint ([`LagSearch`]); then each step's dead time is found
//! between its neighbours, together with them where holds are short, and with what earlier
//! steps left as part of the fit. A joint without a lag is left to the broken line.

use super::hinge;
use super::interface::{DelayMethod, Shared};
use super::step_context::StepContext;
use crate::delay::broken_line;
use crate::delay::decision::Decision;
use crate::delay::interval::FineDelay;
use crate::delay::lag::{FINE, FitWindow, Lag, LagModel, LagSearch, Linearised};
use crate::delay::motion::DEPARTED;
use crate::delay::onsets::{
    GradualOnset, Onset, OnsetPath, Precision, RefinedOnset, Refinement, fit_windows, located,
    thinned,
};
use crate::delay::prepared::Prepared;
use crate::delay::search::Candidates;
use crate::delay::segment::Segment;
use crate::delay::settings::{CONFIDENCE, Settings};
use crate::delay::spec::{Method, MethodSpec, Scope};
use crate::numerics::{Line, NoiseModel, least_change, student_quantile};
use crate::units::ceil_to_index;

static SPEC: MethodSpec = MethodSpec {
    id: "lag-aware",
    fits: "broken line behind a lag",
    source: None,
    summary: "A broken line behind a lag: dead time apart from lag, with intervals",
    has_rows: false,
    cuts_segments: false,
    has_intervals: true,
    scope: Scope::Joint,
    low_pass: None,
    confidence: Some(CONFIDENCE),
};

impl Method {
    /// The broken line behind a lag that all steps of a joint share: dead time apart from
    /// lag, each with an interval.
    pub const LAG_AWARE: Self = Self::of(&SPEC);
}

pub(super) struct LagAware;

impl DelayMethod for LagAware {
    fn method(&self) -> Method {
        Method::LAG_AWARE
    }

    fn shared(&self, trials: &[Prepared<'_>], settings: &Settings) -> Shared {
        Shared { lag: Some(lag_of(trials, settings)), ..Shared::default() }
    }

    fn decide(&self, trial: &Prepared<'_>, shared: &Shared, settings: &Settings) -> Vec<Decision> {
        let lag = shared.lag.as_ref();
        match lag.filter(|lag| lag.order() > 0) {
            Some(lag) => decide_all(trial, lag, settings),
            // A joint that follows at once has a broken line.
            None if lag.is_none_or(Lag::is_determined) => {
                hinge::decide_by_broken_lines(trial, settings)
            }
            // Onsets from rest by the speed that they gather, all others by broken lines.
            None => hinge::decide_all(trial, settings, from_rest),
        }
    }
}

/// Samples that are enough to know which poles a lag has, and where they are.
const ENOUGH_FOR_POLES: usize = 6_000;
const ENOUGH: usize = 20_000;

/// Times that the lag is searched where holds are short, at most.
const ROUNDS: usize = 12;

/// The first of them, in which a simpler lag is taken although its squared error is larger by
/// this part.
const CAUTIOUS: usize = 2;
const CAUTION: f64 = 0.02;

/// The lag that the trials of a joint share.
fn lag_of(trials: &[Prepared<'_>], settings: &Settings) -> Lag {
    let Some(period) = trials.first().map(|trial| trial.period) else { return Lag::none() };
    let alike = trials.iter().filter(|trial| trial.period == period);
    let paths: Vec<_> = alike.map(|trial| (trial.output(), rough(trial, settings))).collect();
    if !is_shown(paths.iter().flat_map(|(_, path)| &path.onsets)) {
        return Lag::undetermined();
    }
    let all: Vec<_> = paths
        .iter()
        .flat_map(|(output, path)| fit_windows(output, path, Precision::Rough))
        .collect();
    let clear = paths.iter().all(|(_, path)| path.in_time());
    let enough = if clear { ENOUGH_FOR_POLES } else { ENOUGH };
    let mut found = LagSearch::new(thinned(all.clone(), enough)).select();
    if found.model.order() == 0 && found.is_faint() {
        found = LagSearch::new(thinned(all, ENOUGH)).select();
    }
    // With the dead times known better, windows reach as far as they may.
    for round in 0..if clear { 1 } else { ROUNDS } {
        if found.model.order() == 0 {
            break;
        }
        let refined = refined(&paths, &found);
        let windows =
            refined.iter().flat_map(|it| fit_windows(it.output, &it.path, Precision::Refined));
        let windows = thinned(windows.collect(), ENOUGH);
        if windows.is_empty() {
            break;
        }
        let again = LagSearch::new(windows).with_model(found.model, found.noise.clone());
        // Onsets suit the lag behind which they were found: at first only what is plain counts.
        let caution = if round < CAUTIOUS { CAUTION } else { 0.0 };
        let before = found.model;
        found = if clear { again.refit() } else { again.reselected(caution) };
        // A pole too many makes onsets that speak for it, which it takes some rounds to undo.
        if round > CAUTIOUS && found.model.is_close_to(&before) {
            break;
        }
    }
    if found.model.order() > 0 && is_early(&refined(&paths, &found)) {
        return Lag::undetermined();
    }
    let outputs = trials.iter().flat_map(|trial| trial.raw.windows(2));
    if found.model.order() > 0 && !found.is_seen_by(least_change(outputs).unwrap_or(0.0)) {
        return Lag::undetermined();
    }
    let lag = Lag::new(period, found.model, found.covariance());
    if found.model.order() > 0 && !is_known(&lag) { Lag::undetermined() } else { lag }
}

/// Whether the lag is more than its own uncertainty: two standard errors.
fn is_known(lag: &Lag) -> bool {
    let mean = lag.mean_s();
    mean.value > 2.0 * mean.std_error
}

/// Whether onsets behind this lag come before the input that they answer: then it is no lag of
/// the joint, but what its steps share otherwise, as a load that changes along each stroke.
fn is_early(refined: &[Refinement<'_>]) -> bool {
    /// Part of the onsets that may, and how many at least (chosen).
    const PART: f64 = 0.1;
    const FEW: usize = 3;
    /// By how many standard errors, and samples.
    const STANDARD_ERRORS: f64 = 3.0;
    const SAMPLES: f64 = 1.0;
    let onsets = || refined.iter().flat_map(|trial| &trial.path.onsets).filter(|it| it.counts);
    let ends = |onset: &Onset| onset.position + STANDARD_ERRORS * onset.error + SAMPLES;
    let early = onsets().filter(|onset| ends(onset) < onset.origin as f64).count();
    early >= FEW && early as f64 > PART * onsets().count() as f64
}

/// Whether enough steps can show a lag, where some cannot: those of a joint that rested, and
/// does not go on as it starts. They must be no fewer than those that cannot.
fn is_shown<'a>(onsets: impl Iterator<Item = &'a Onset>) -> bool {
    /// Steps that say more than one of them alone (chosen).
    const FEWEST: usize = 3;
    let (unfit, fit): (Vec<&Onset>, Vec<&Onset>) =
        onsets.partition(|onset| onset.alone || onset.at_rest);
    unfit.is_empty() || fit.len() >= FEWEST.max(unfit.len())
}

/// The decision on a step at which the joint rested and then departed.
fn from_rest(context: &StepContext<'_>) -> Option<Decision> {
    let StepContext { settings, .. } = *context;
    let output = context.output();
    let (found, start) = context.gradual()?;
    let step = context.step().sample - 1;
    let fine = found.delay((step - start) as f64, settings.interval);
    let segment = Segment::clipped(start + found.first + 1, start + found.len, output.len());
    let candidates = gradual_candidates(&found, output.get(start..)?, start);
    let mut decision = context.decision(segment, 1, candidates, Some(fine));
    if let Some(confidence) = settings.confidence {
        decision.test_reaction(Some(DEPARTED), confidence);
    }
    Some(decision)
}

/// The onset at every sample, with the line before it and the chord behind it.
fn gradual_candidates(found: &GradualOnset, values: &[f64], start: usize) -> Candidates {
    let number = |index: usize| (start + index + 1) as f64;
    let last = found.len - 1;
    // Over the sample numbers of the trial, counted from 1.
    let before = found.before;
    let before = Line { intercept: before.intercept - before.slope * number(0), ..before };
    let lines = (found.first..found.first + found.sse.len()).map(|index| {
        let level = before.at(number(index));
        // The chord: how the speed behind the onset grows is no line's.
        let slope = (values[last] - level) / (last.max(index + 1) - index) as f64;
        (before, Line { slope, intercept: level - slope * number(index) })
    });
    let best = ceil_to_index(found.position).saturating_sub(found.first);
    let best = best.min(found.sse.len().saturating_sub(1));
    Candidates::fitted(start + found.first, found.sse.clone(), lines.unzip(), best)
}

/// The onsets of each trial behind the lag that was found.
fn refined<'a>(paths: &[(&'a [f64], OnsetPath)], found: &LagSearch<'_>) -> Vec<Refinement<'a>> {
    let refined = |(output, path): &(&'a [f64], OnsetPath)| {
        let path = behind(path, output, &found.model);
        Refinement::of(output, path, found.model, found.noise.clone()).refined(1)
    };
    paths.iter().map(refined).collect()
}

/// The onsets by broken lines. Their residuals hold the lag's transients, which are no noise:
/// its memory is not estimated from them.
fn rough(trial: &Prepared<'_>, settings: &Settings) -> OnsetPath {
    let (mut path, _) = located(trial, settings, 1);
    path.onsets.iter_mut().for_each(|onset| onset.counts = !onset.at_rest);
    path
}

/// About where onsets behind a lag are, given where broken lines put them. Where holds
/// are short, the transients of earlier steps hide which one belongs to which step.
fn behind(rough: &OnsetPath, output: &[f64], model: &LagModel) -> OnsetPath {
    let path = rough.clone();
    if path.in_time() { path.without(model) } else { path.behind(model, output) }
}

/// The decisions on all steps of a trial with this lag.
fn decide_all(prepared: &Prepared<'_>, lag: &Lag, settings: &Settings) -> Vec<Decision> {
    /// Passes: the first takes the noise for white, the second knows its memory.
    const PASSES: usize = 2;
    let (output, model) = (prepared.output(), lag.model_at(prepared.period));
    let path = behind(&rough(prepared, settings), output, &model);
    let trial = Refinement::of(output, path, model, NoiseModel::white()).refined(PASSES);
    let decide = |index| decide(&StepContext { trial: prepared, index, settings }, &trial, lag);
    (0..prepared.steps.len()).map(decide).collect()
}

fn decide(context: &StepContext<'_>, trial: &Refinement<'_>, lag: &Lag) -> Decision {
    let StepContext { index, settings, .. } = *context;
    let output = context.output();
    let range = trial.path.window(index);
    let segment = Segment::clipped(range.start + 1, range.end, output.len());
    let found = trial.fit(index, FINE);
    let p_value = found.as_ref().map(|found| trial.p_value(index, found));
    let origin = context.step().sample as f64 - 1.0;
    let fine = found.as_ref().map(|found| fine(trial, found, origin, lag, settings.interval));
    let candidates = found.map_or_else(Candidates::default, |found| candidates(trial, &found));
    let mut decision = context.decision(segment, 1, candidates, fine);
    if let Some(confidence) = settings.confidence {
        decision.test_reaction(context.departed().or(p_value), confidence);
    }
    decision
}

/// The dead time and its interval: the profile likelihood of the onset, and, independent of
/// it, the delta method for the uncertainty of the lag.
fn fine(
    trial: &Refinement<'_>,
    found: &RefinedOnset<'_>,
    origin: f64,
    lag: &Lag,
    confidence: f64,
) -> FineDelay {
    /// Half-width in samples from which an onset isn't known at all.
    const UNKNOWN: f64 = 1e6;
    let Refinement { basis, noise, .. } = trial;
    let with_lag = found.window.with_lag_columns(&basis.model, noise, &found.fit.parts);
    let rows = found.range.len() - noise.order();
    let freedom = (rows as f64 - found.fit.parameters() as f64).max(1.0);
    let variance = found.fit.sse / freedom;
    let t = student_quantile(f64::midpoint(1.0, confidence), freedom);
    // t·σ(τ) with the lag taken for known.
    let own = t * (variance * found.fit.onset_variance()).sqrt();
    // Delta method: √(g'·C·g), g being how far the onset moves with each parameter of the lag.
    let shared = t * lag.variance_along(&with_lag.onset_slopes()).sqrt();
    let side = |sign: f64| {
        let reach = found.reach(sign * own, variance * t * t, basis, noise);
        sign * reach.hypot(shared)
    };
    let delay = found.position() - origin;
    let (low, high) = if own < UNKNOWN { (side(-1.0), side(1.0)) } else { (-own, own) };
    let ends = (delay + low, delay + high);
    FineDelay::causal(broken_line::median(delay, ends, t), ends.0, ends.1, confidence)
}

/// The onset where it was found, and a sample to each side.
fn candidates(trial: &Refinement<'_>, found: &RefinedOnset<'_>) -> Candidates {
    let start = found.range.start;
    let mean = trial.basis.response.mean;
    let there = |by: f64| {
        let window = found.window.with_last_onset(found.window.last_onset() + by);
        let fit = window.at(&trial.basis, &trial.noise);
        (fit.sse, lines(&window, &fit, start, mean))
    };
    let best = (found.fit.sse, lines(&found.window, &found.fit, start, mean));
    let all = [there(-1.0), best, there(1.0)];
    let (sse, lines): (Vec<f64>, Vec<(Line, Line)>) = all.into_iter().unzip();
    let first = ceil_to_index(found.position()).saturating_sub(1);
    Candidates::fitted(first, sse, lines.into_iter().unzip(), 1)
}

/// The lines that the output approaches before and after the last onset, behind a lag that is
/// `mean` samples late; over sample numbers.
fn lines(window: &FitWindow<'_>, fit: &Linearised, start: usize, mean: f64) -> (Line, Line) {
    let (value, slope) = (fit.parts[0], fit.parts[1]);
    let first = start as f64 + 1.0;
    let before = Line { slope, intercept: value + window.values[0] - slope * first };
    let change = fit.change();
    let at = first + window.last_onset() + mean;
    (before, Line { slope: slope + change, intercept: before.intercept - change * at })
}
