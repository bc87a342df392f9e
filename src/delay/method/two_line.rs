//! `two-line`: Albrecht and Taylor's Algorithm 1, step by step, since each segment begins
//! where the verdict before it says.
//!
//! For step `i` at sample `p_i` the segment runs from `r_i` to `p_(i+1) + α`, with
//! `r_i = q_(i−1)` if step `i−1` was accepted and `p_i − α` otherwise. The pair of lines
//! with the least squared error breaks at `q_i`; the delay is `δ_i = q_i − p_i`. Where the
//! breakpoints of a trial turn out to be reactions to the next steps, since the joint reacts within
//! α, all is decided again with segments that end before these; not with
//! [`Settings::paper`].
//!
//! # References
//! Albrecht and Taylor, Algorithm 1 (time-varying delays of hydraulic manipulators).

use super::next_reaction::answer_the_next_step;
use super::noise_test;
use super::step_context::StepContext;
use crate::delay::decision::{Decision, Verdict};
use crate::delay::prepared::Prepared;
use crate::delay::search::Candidates;
use crate::delay::segment::Segment;
use crate::delay::settings::{CONFIDENCE, CandidateLines, FirstLast, Settings};

/// The segments of all steps with their candidates, before it is asked whether anything happened.
pub(super) fn by_lines(trial: &Prepared<'_>, settings: &Settings) -> Vec<Decision> {
    let decisions = in_turn(trial, settings, settings.alpha);
    // Not what a step is judged by that may come later, and nothing that is not the paper's.
    if !settings.paper && !settings.grows && answer_the_next_step(&decisions, settings.beta) {
        return in_turn(trial, settings, 0);
    }
    decisions
}

/// The decisions on all steps of a trial.
pub(super) fn decide(trial: &Prepared<'_>, settings: &Settings) -> Vec<Decision> {
    let mut decisions = by_lines(trial, settings);
    if let Some(confidence) = confidence(trial, settings) {
        noise_test::judge(&mut decisions, trial, confidence);
        for (index, decision) in decisions.iter_mut().enumerate() {
            let context = StepContext { trial, index, settings };
            if let Some(p_value) = context.departed() {
                decision.test_reaction(Some(p_value), confidence);
            }
        }
    } else if !settings.paper {
        let departs = |index| StepContext { trial, index, settings }.departed().is_some();
        noise_test::judge_until_one_reacts(&mut decisions, trial, departs, CONFIDENCE);
    }
    decisions
}

/// The steps decided in turn; segments reach `beyond` samples beyond the next step, or end before it
/// where that is none.
fn in_turn(trial: &Prepared<'_>, settings: &Settings, beyond: usize) -> Vec<Decision> {
    let mut decisions: Vec<Decision> = Vec::with_capacity(trial.steps.len());
    for index in 0..trial.steps.len() {
        let context = StepContext { trial, index, settings };
        decisions.push(decide_one(&context, decisions.last(), beyond));
    }
    decisions
}

/// How sure a reaction must be. The paper asks nothing, but rejects the ends of a trial; where
/// they are judged since there is hardly anything else, whether anything happened is asked.
fn confidence(trial: &Prepared<'_>, settings: &Settings) -> Option<f64> {
    let few =
        settings.first_last == FirstLast::Auto && settings.first_last.are_judged(trial.steps.len());
    settings.confidence.or((few || trial.is_tested).then_some(CONFIDENCE))
}

/// The first sample that a segment may have, the last breakpoint, and the last sample.
fn bounds(context: &StepContext<'_>) -> (usize, usize, usize) {
    let Settings { alpha, beta, max_delay, .. } = *context.settings;
    let p = context.step().sample;
    let before_step = p.saturating_sub(alpha);
    let asked = max_delay.map(|delay| p.saturating_add(delay));
    let mut bounds = asked.map_or((0, usize::MAX, usize::MAX), |latest| {
        (before_step, latest, latest.saturating_add(alpha))
    });
    if let Some(motion) = context.motion() {
        bounds.0 = bounds.0.max(motion.first + 1);
        // A breakpoint is at the end of a row of β samples.
        bounds.1 = bounds.1.min(motion.latest + beta);
        bounds.2 = bounds.2.min(motion.end);
    }
    bounds
}

/// The decision on a step, after the one `before` it; see [`in_turn`].
fn decide_one(context: &StepContext<'_>, before: Option<&Decision>, beyond: usize) -> Decision {
    let StepContext { settings, .. } = *context;
    let output = context.output();
    let p = context.step().sample;
    let accepted = before.filter(|before| before.verdict() == Verdict::Accepted);
    let previous = accepted.and_then(Decision::breakpoint);
    let before_step = p.saturating_sub(settings.alpha);
    let breakpoint = previous.map(|best| best.candidate.breakpoint);
    let (from, latest, until) = bounds(context);
    // r_i = q_(i−1) if step i−1 was accepted, else p_i − α; what came long before the step is
    // none of its business where its own reaction is bounded.
    let first = breakpoint.map_or(before_step, |breakpoint| breakpoint.max(from));
    let next = context.next_sample();
    // p_(i+1) + α.
    let end = if beyond == 0 { next.saturating_sub(1) } else { next.saturating_add(beyond) };
    let last = end.min(until);
    let segment = Segment::clipped(first, last, output.len());
    let values = &output[segment.indices()];
    let candidates = Candidates::search_until(values, segment.first, settings.beta, latest);
    let candidates = match settings.lines {
        CandidateLines::All => candidates,
        CandidateLines::Best => candidates.with_best_alone(),
    };
    context.decision(segment, candidates, None)
}
