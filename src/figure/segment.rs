//! One decision: the segment with both lines, and the squared error of every candidate.
//!
//! Horizontal places are samples of the trial, counted from 1; they may lie between two.

use super::panel::Place;
use super::role::Role;
use super::span::{Span, thinned_to};
use crate::delay::{Candidate, Decision, Line, Verdict};
use crate::experiment::Trial;

/// Errors less than this part of the largest are drawn at it: the fit is exact there. Chosen
/// so that a curve over nine decades is still read.
const EXACT: f64 = 1e-9;

/// A segment, and what was decided on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SegmentFigure<'a> {
    decision: &'a Decision,
    /// First and last sample that are drawn: the segment with its step and a margin.
    pub(crate) window: (usize, usize),
    /// The least error that is drawn.
    least_error: f64,
}

impl<'a> SegmentFigure<'a> {
    pub(crate) fn new(trial: &Trial, decision: &'a Decision) -> Self {
        let segment = decision.segment;
        let margin = (segment.len() / 12).max(3);
        let first = segment.first.min(decision.input_step.sample);
        let first = first.saturating_sub(margin).max(1);
        let last = (segment.last + margin).min(trial.len());
        let highest = decision.candidates.sse().iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        Self { decision, window: (first, last), least_error: EXACT * highest }
    }

    /// Whether the best pair of lines was accepted.
    pub(crate) fn verdict(&self) -> Role {
        match self.decision.verdict() {
            Verdict::Accepted => Role::Accepted,
            Verdict::Rejected(_) => Role::Rejected,
        }
    }

    /// The part of a signal of the trial that is drawn.
    pub(crate) fn visible<'v>(&self, values: &'v [f64]) -> &'v [f64] {
        let (first, last) = self.window;
        values.get(first - 1..last).unwrap_or_default()
    }

    /// A signal of the trial, thinned to about so many points.
    pub(crate) fn signal(&self, values: &[f64], points: usize) -> Vec<Place> {
        let visible = self.visible(values);
        let place = |index: usize| ((self.window.0 + index) as f64, visible[index]);
        thinned_to(visible, points).into_iter().map(place).collect()
    }

    /// Where the lines of the decision break.
    pub(crate) fn breakpoint(&self) -> Option<f64> {
        Some(self.decision.input_step.sample as f64 + self.decision.delay()?)
    }

    /// Both lines of a candidate, which break at `q`.
    pub(crate) fn lines(&self, candidate: &Candidate, q: f64) -> [Vec<Place>; 2] {
        let segment = self.decision.segment;
        let ends = |line: &Line, from: f64, to: f64| [from, to].map(|k| (k, line.at(k))).to_vec();
        let before = ends(&candidate.before, segment.first as f64, q);
        [before, ends(&candidate.after, q, segment.last as f64)]
    }

    /// What the chosen lines leave of `output`, the trial's that they were fitted to.
    pub(crate) fn residual(&self, output: &[f64]) -> Vec<Place> {
        let Some(best) = self.decision.candidates.best() else { return Vec::new() };
        let segment = self.decision.segment;
        let values = output.get(segment.indices()).unwrap_or_default();
        let left = |(k, y): (usize, &f64)| {
            let line = if k < best.breakpoint { best.before } else { best.after };
            (k as f64, y - line.at(k as f64))
        };
        (segment.first..).zip(values).map(left).collect()
    }

    /// The logarithm to base ten of a candidate's squared error, at its breakpoint.
    pub(crate) fn error(&self, candidate: &Candidate) -> Place {
        (candidate.breakpoint as f64, candidate.sse.max(self.least_error).log10())
    }

    /// The curve of errors, thinned to about so many points.
    pub(crate) fn errors(&self, points: usize) -> Vec<Place> {
        let candidates = &self.decision.candidates;
        let kept = thinned_to(candidates.sse(), points).into_iter();
        kept.filter_map(|index| candidates.get(index)).map(|c| self.error(&c)).collect()
    }

    /// The range of the curve of errors.
    pub(crate) fn error_span(&self) -> Span {
        let sse = self.decision.candidates.sse().iter();
        Span::around(sse.map(|sse| sse.max(self.least_error).log10()), 0.12)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::{Method, Settings, estimate};
    use crate::numerics::testing::normals;
    use crate::units::SamplePeriod;

    #[test]
    fn lines_run_from_end_to_end_of_the_segment_and_break_where_they_are_told() {
        let ramp = |k: u32| 0.2 * (f64::from(k) - 111.0).max(0.0);
        let mut noise = normals(5);
        let output: Vec<f64> = (0..240).map(|k| ramp(k) + 0.01 * noise()).collect();
        let input = (0..240).map(|k| f64::from(u8::from(k >= 100))).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, input, output).unwrap();
        let decisions = estimate(&trial, &Settings::of(Method::TWO_LINE)).unwrap().decisions;
        let decision = decisions.first().unwrap();
        let figure = SegmentFigure::new(&trial, decision);
        let best = decision.candidates.best().unwrap();
        let [before, after] = figure.lines(&best, 112.0);
        let ends: Vec<f64> = before.iter().chain(&after).map(|(k, _)| *k).collect();
        let segment = decision.segment;
        assert_eq!(ends, [segment.first as f64, 112.0, 112.0, segment.last as f64]);
    }
}
