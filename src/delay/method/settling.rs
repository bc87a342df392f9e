//! The decisions on a record whose output settles, whatever the method: no line follows it.

use super::step_context::StepContext;
use crate::delay::decision::Decision;
use crate::delay::prepared::Prepared;
use crate::delay::search::Candidates;
use crate::delay::segment::Segment;
use crate::delay::settings::{CONFIDENCE, Settings};
use crate::delay::settling::{Settling, SettlingOnset};
use crate::numerics::Line;
use crate::units::{ceil_to_index, floor_to_index};

/// The decisions on all steps of a trial whose output settles.
pub(in crate::delay) fn decide_settling(
    trial: &Prepared<'_>,
    settling: &Settling,
    settings: &Settings,
) -> Vec<Decision> {
    let onsets = settling.onsets(trial, settings).into_iter().enumerate();
    onsets.map(|(index, onset)| decide(&StepContext { trial, index, settings }, onset)).collect()
}

fn decide(context: &StepContext<'_>, onset: Option<SettlingOnset>) -> Decision {
    let samples = context.output().len();
    let step = context.step().sample;
    let (fine, p_value) = (onset.as_ref().map(|it| it.fine), onset.as_ref().map(|it| it.p_value));
    let whole = Segment::clipped(step, context.next_sample() - 1, samples);
    let segment = onset
        .as_ref()
        .map_or(whole, |it| Segment::clipped(it.start + 1, it.start + it.response.len(), samples));
    let candidates = onset.as_ref().map_or_else(Candidates::default, candidates);
    let mut decision = context.settling_decision(segment, candidates, fine);
    decision.response = onset.map(|it| Box::new(it.response));
    decision.test_reaction(p_value, context.settings.confidence.unwrap_or(CONFIDENCE));
    decision
}

/// The onset where it was found, and a sample to each side, with the chords of the response
/// before and behind it.
fn candidates(found: &SettlingOnset) -> Candidates {
    let number = |at: f64| found.start as f64 + 1.0 + at;
    let curve = found.response.values();
    let last = curve.len() - 1;
    let value = |at: f64| {
        let index = floor_to_index(at).min(last);
        let (here, next) = (curve[index], curve[(index + 1).min(last)]);
        here + (next - here) * (at - index as f64)
    };
    let chord = |from: f64, to: f64| {
        let slope = (value(to) - value(from)) / (to - from).max(1.0);
        Line { slope, intercept: value(from) - slope * number(from) }
    };
    let onset = found.response.onset;
    let at = |by: f64| (onset + by).clamp(0.0, last as f64);
    let lines = [-1.0, 0.0, 1.0].map(|by| (chord(0.0, at(by)), chord(at(by), last as f64)));
    let first = ceil_to_index(found.start as f64 + onset).saturating_sub(1);
    Candidates::fitted(first, found.sse.to_vec(), lines.into_iter().unzip(), 1)
}
