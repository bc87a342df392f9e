//! How doubtful a decision is, from its own evidence: what a reviewer looks at first.

use std::fmt;

use super::condition::{Check, Condition, Outcome};
use super::decision::{Decision, Verdict};
use super::search::Candidate;
use crate::numerics::limits;

/// A number this near its limit, as a part of their sum, is near; farther away it is no doubt.
const NEAR: f64 = 0.25;

/// So near to an output limit it is doubtful, as a part of the output's range.
const NEAR_STOP: f64 = 0.05;

/// Part of the output's range that is its end: within it a joint stands at a stop.
const END: f64 = 0.01;

/// Doubt from which on a decision is doubtful: on synthetic records every fifth accepted step or more
/// above it is off by more than one and a half rows of β, of the others one in fifty.
const DOUBTFUL: f64 = 0.3;

#[cfg(feature = "rrd")]
impl Doubt {
    /// Doubt from which on a decision is doubtful, in percent.
    pub(crate) const DOUBTFUL_PERCENT: f64 = 100.0 * DOUBTFUL;
}

/// Something odd about a decision, whatever the margins say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Flag {
    /// The best breakpoint is the first or the last one of the segment.
    Edge,
    /// The lines jump apart at the breakpoint: they cross more than two rows away.
    Jump,
    /// The output stands at an end of its range, in the later half after the breakpoint, though
    /// the input is not zero.
    Stop,
}

impl Flag {
    /// Its name in files and tables.
    pub fn id(self) -> &'static str {
        match self {
            Self::Edge => "edge",
            Self::Jump => "jump",
            Self::Stop => "stop",
        }
    }

    /// What it says, in words.
    pub(crate) fn meaning(self) -> &'static str {
        match self {
            Self::Edge => "breakpoint at the edge of the segment",
            Self::Jump => "lines jump apart at the breakpoint",
            Self::Stop => "output at an end of its range after the breakpoint",
        }
    }
}

impl fmt::Display for Flag {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

/// The evidence against a decision. Each margin is between 0, where the decision would turn,
/// and 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// Part of the squared error of one line that the break removes: `1 − SSE₂ / SSE₁`. Where the
    /// output settles, of that without a reaction.
    pub explained: f64,
    /// How far from the best breakpoint those lie that fit nearly as well, samples: the root
    /// mean square distance of all candidates, weighted by `(SSE_best / SSE)⁴`; of a delay
    /// between samples, half its interval.
    pub spread: f64,
    /// From the breakpoint to where both lines cross, samples.
    pub crossing: f64,
    /// The condition nearest its limit, and its margin.
    pub nearest: Option<(Condition, f64)>,
    /// What is odd besides.
    pub flags: Vec<Flag>,
    /// Samples that the input is held, which `spread` and `crossing` are compared with.
    pub hold: f64,
    /// Whether the output settles, so that no lines were fitted.
    pub settles: bool,
    is_accepted: bool,
}

impl Doubt {
    /// The doubt as one number from 0 to 1, by which decisions are ordered: of an accepted
    /// step one less the product of all margins,
    ///
    /// `1 − explained · (1 − spread / hold) · (1 − crossing / hold) · nearest`;
    ///
    /// with a further factor of 0.7 where something is odd, so that such a decision is a doubtful
    /// one; of a rejected step one less the largest margin of a condition that failed, since all
    /// of them would have to turn.
    pub fn value(&self) -> f64 {
        let nearest = self.nearest.map_or(1.0, |(_, margin)| margin);
        if !self.is_accepted {
            return 1.0 - nearest;
        }
        let [explained, placed, meeting] = self.margins();
        let odd = if self.flags.is_empty() { 1.0 } else { 1.0 - DOUBTFUL };
        1.0 - explained * placed * meeting * nearest * odd
    }

    /// Whether a person should look at the decision: its doubt is 0.3 or more, as that of every
    /// accepted one with a flag.
    pub fn is_doubtful(&self) -> bool {
        self.value() >= DOUBTFUL
    }

    /// Margins of the break itself: what it explains, how surely it is placed, how well the
    /// lines meet.
    pub(crate) fn margins(&self) -> [f64; 3] {
        let part = |samples: f64| 1.0 - (samples / self.hold.max(1.0)).min(1.0);
        [self.explained, part(self.spread), part(self.crossing)]
    }
}

/// Each of the decisions on a trial with its doubt; `output` is what the method looked at, the whole
/// trial.
pub fn doubts<'d>(
    decisions: &'d [Decision],
    output: &'d [f64],
) -> impl Iterator<Item = (&'d Decision, Doubt)> {
    let range = limits(output.iter().copied());
    decisions.iter().map(move |decision| (decision, decision.doubt_within(output, range)))
}

impl Decision {
    /// How doubtful the program's decision is; `output` is what the method looked at, the whole trial.
    pub fn doubt(&self, output: &[f64]) -> Doubt {
        self.doubt_within(output, limits(output.iter().copied()))
    }

    /// The doubt where the range of the output is known.
    fn doubt_within(&self, output: &[f64], range: (f64, f64)) -> Doubt {
        let best = self.candidates.best();
        let fine = self.fine.map(|fine| (fine.high - fine.low) / 2.0);
        Doubt {
            explained: best.map_or(1.0, |_| self.explained()),
            spread: fine.unwrap_or_else(|| self.candidates.spread()),
            crossing: best.map_or(0.0, |best| self.crossing(&best)),
            settles: self.rests(),
            nearest: self.nearest(range.1 - range.0),
            flags: self.flags(output, range),
            hold: self.hold as f64,
            is_accepted: self.program_verdict() == Verdict::Accepted,
        }
    }

    /// Whether the output settles at a level.
    fn rests(&self) -> bool {
        self.onset.as_ref().is_some_and(|onset| onset.rests)
    }

    /// `1 − SSE₂ / SSE₁`, or what an onset removes.
    fn explained(&self) -> f64 {
        let onset = self.onset.as_ref().map(|onset| onset.explained);
        onset.unwrap_or_else(|| self.candidates.explained())
    }

    fn crossing(&self, best: &Candidate) -> f64 {
        // The lines are Algorithm 1's, and not the answer.
        if self.onset.is_some() {
            return 0.0;
        }
        let q = best.breakpoint as f64;
        let jump = (best.after.at(q) - best.before.at(q)).abs();
        let turn = best.slope_change().abs();
        // The lines close by the change of slope at every sample.
        if turn > 0.0 { jump / turn } else { self.hold as f64 }
    }

    /// Of an accepted step the condition nearest its limit, of a rejected one the failed
    /// condition farthest from it.
    fn nearest(&self, range: f64) -> Option<(Condition, f64)> {
        let margin = |check: Check| Some((check.condition, self.margin(&check, range)?));
        let by_margin = |a: &(Condition, f64), b: &(Condition, f64)| a.1.total_cmp(&b.1);
        let of = |outcome| self.checks.into_iter().filter(move |check| check.outcome == outcome);
        match self.program_verdict() {
            Verdict::Accepted => of(Outcome::Passed).filter_map(margin).min_by(by_margin),
            Verdict::Rejected(_) => {
                let sure = |check: Check| margin(check).unwrap_or((check.condition, 1.0));
                of(Outcome::Failed).map(sure).max_by(by_margin)
            }
        }
    }

    /// How far a condition is from turning; none where no number would turn it.
    fn margin(&self, check: &Check, range: f64) -> Option<f64> {
        let (value, limit) = check.value.zip(check.limit)?;
        let apart = (value - limit).abs();
        let of_sum = |near: f64| (apart / (value.abs() + limit.abs()) / near).min(1.0);
        match check.condition {
            Condition::FirstOrLast | Condition::TooShort | Condition::Reviewer => None,
            Condition::OutputLimit => Some((apart / range / NEAR_STOP).min(1.0)),
            Condition::BeforeInput => {
                Some(((apart + 1.0) / (1.0 + self.candidates.spacing() as f64)).min(1.0))
            }
            // The probabilities of noise spread over many decades.
            Condition::NothingHappened => {
                let log = |p: f64| p.max(f64::MIN_POSITIVE).ln();
                Some(((log(value) - log(limit)) / log(limit)).abs().min(1.0))
            }
            Condition::SlopeChange | Condition::ShortHold | Condition::Sse | Condition::AtRest => {
                (limit != 0.0).then(|| of_sum(NEAR))
            }
        }
    }

    fn flags(&self, output: &[f64], range: (f64, f64)) -> Vec<Flag> {
        let Some(best) = self.candidates.best() else { return Vec::new() };
        let is_edge = self.candidates.len() > 2 && (best.f == 1 || best.f == self.candidates.len());
        let is_jump = self.crossing(&best) > 2.0 * self.candidates.spacing() as f64;
        // Where the input is let go, a joint that stands is at rest, wherever that is.
        // One that settles stands where the input holds it.
        let is_driven = self.input_step.after.abs() > 0.0 && !self.rests();
        // The joint may still be on its way at first.
        let behind = usize::midpoint(best.breakpoint, self.segment.last);
        let found = [
            (Flag::Edge, is_edge && self.fine.is_none()),
            (Flag::Jump, is_jump && self.fine.is_none()),
            (Flag::Stop, is_driven && is_at_one_end(output, (behind, self.segment.last), range)),
        ];
        found.into_iter().filter_map(|(flag, is_on)| is_on.then_some(flag)).collect()
    }
}

/// Whether all samples `from ..= to` are at one end of the range of the output.
fn is_at_one_end(output: &[f64], (from, to): (usize, usize), (low, high): (f64, f64)) -> bool {
    let end = END * (high - low);
    let part = output.get(from.saturating_sub(1)..to).unwrap_or_default();
    let all = |near: &dyn Fn(f64) -> bool| !part.is_empty() && part.iter().all(|y| near(*y));
    end > 0.0 && (all(&|y| y - low <= end) || all(&|y| high - y <= end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::{FirstLast, Method, Settings, estimate};
    use crate::experiment::Trial;
    use crate::units::SamplePeriod;

    /// A step at 100, followed 12 samples later by a slope of `rise`, with ripple; the output
    /// jumps by `jump` at the bend, and stops at `stop`.
    fn decided(rise: f64, jump: f64, stop: f64, settings: &Settings) -> (Decision, Vec<f64>) {
        let input = (0..240).map(|k| f64::from(u8::from(k >= 100))).collect();
        let output = |k: i32| {
            let ripple = 0.05 * f64::from((k * 7919) % 101 - 50) / 50.0;
            let moved = rise * f64::from((k - 112).max(0));
            let jumped = if k >= 112 { jump } else { 0.0 };
            (moved + jumped).min(stop) + ripple
        };
        let output: Vec<f64> = (0..240).map(output).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, input, output.clone()).unwrap();
        (estimate(&trial, settings).unwrap().decisions.remove(0), output)
    }

    fn settings() -> Settings {
        Settings { first_last: FirstLast::Keep, low_pass: None, ..Settings::of(Method::TWO_LINE) }
    }

    fn doubt(rise: f64, jump: f64, stop: f64) -> Doubt {
        let (decision, output) = decided(rise, jump, stop, &settings());
        decision.doubt(&output)
    }

    #[test]
    fn a_bend_in_noise_is_more_doubtful_than_a_clear_one() {
        let (clear, faint) = (doubt(0.2, 0.0, 99.0), doubt(0.002, 0.0, 99.0));
        assert!(clear.value() < 0.1, "{clear:?}");
        assert!(faint.value() > 0.3, "{faint:?}");
        assert!(faint.spread > clear.spread && faint.explained < clear.explained);
    }

    #[test]
    fn the_break_explains_what_one_line_leaves_over() {
        let (decision, output) = decided(0.2, 0.0, 99.0, &settings());
        let best = decision.candidates.best().unwrap();
        let rows = decision.segment.len() / 5 * 5;
        let part = &output[decision.segment.first - 1..][..rows];
        let mut line = crate::numerics::RunningLine::default();
        for y in part {
            line.push(*y);
        }
        let expected = 1.0 - best.sse / line.sse();
        assert!((decision.doubt(&output).explained - expected).abs() < 1e-9);
    }

    #[test]
    fn a_clear_bend_is_clear_to_every_method() {
        for method in [Method::TWO_LINE, Method::HINGE, Method::LAG_AWARE] {
            let settings = Settings { method, ..settings() };
            for rise in [0.2, 2.0] {
                let (decision, output) = decided(rise, 0.0, 99.0, &settings);
                let doubt = decision.doubt(&output);
                assert!(doubt.explained > 0.9 && doubt.value() < 0.1, "{method:?}: {doubt:?}");
            }
        }
    }

    #[test]
    fn a_jump_and_a_stop_are_flagged() {
        assert_eq!(doubt(0.2, 0.0, 99.0).flags, []);
        assert_eq!(doubt(0.02, 1.5, 99.0).flags, [Flag::Jump]);
        assert!(doubt(0.2, 30.0, 30.0).flags.contains(&Flag::Stop));
    }

    #[test]
    fn what_is_accepted_with_a_flag_is_doubtful_however_clear_it_is() {
        let clear = doubt(0.2, 0.0, 99.0);
        let flagged = Doubt { flags: vec![Flag::Edge], ..clear.clone() };
        assert!(!clear.is_doubtful() && flagged.is_doubtful(), "{flagged:?}");
        let stopped = doubt(0.2, 30.0, 30.0);
        assert!(stopped.is_doubtful(), "{stopped:?}");
        let rejected = Doubt { is_accepted: false, nearest: None, ..stopped };
        assert!(!rejected.is_doubtful() && rejected.value() < DOUBTFUL);
    }

    #[test]
    fn a_condition_near_its_limit_is_a_doubt_and_one_without_a_number_is_none() {
        let limited = |min_slope_change| {
            let settings = Settings { min_slope_change, ..settings() };
            let (decision, output) = decided(0.2, 0.0, 99.0, &settings);
            (decision.verdict(), decision.doubt(&output))
        };
        let (accepted, near) = limited(0.19);
        assert_eq!(accepted, Verdict::Accepted);
        assert_eq!(near.nearest.map(|(condition, _)| condition), Some(Condition::SlopeChange));
        assert!(near.value() > 0.8, "{near:?}");
        assert!(limited(0.05).1.value() < 0.1);
        let (rejected, near) = limited(0.21);
        assert_eq!(rejected, Verdict::Rejected(Condition::SlopeChange));
        assert!(near.value() > 0.8 && limited(0.8).1.value() < 0.1, "{near:?}");
        let first = Settings { first_last: FirstLast::Reject, ..settings() };
        let (decision, output) = decided(0.002, 0.0, 99.0, &first);
        assert!(decision.doubt(&output).value().abs() < 1e-12, "a step at an end is no doubt");
    }
}
