//! Where trials, samples and decisions lie on the timelines.
//!
//! - `sample`: the paper's sample number. Trials follow one another with one empty
//!   sample between, so the first trial has its own numbers.
//! - `time`: the same in seconds since the start of the record.
//! - `decision`: per segment an opening tick, one tick per recorded candidate and a
//!   verdict tick, counted from 1 without a gap; each joint counts for itself.
//! - `segment`: the number of the step, counted on over the trials.
//! - `doubt`: the rank of the decision, the most doubtful being the first.
//! - `difference`: likewise by its difference to other results, where there are any.
//!
//! What is drawn of a decision carries the first four and `doubt`, so that one cursor moves all
//! views; samples carry all but `segment` and `doubt`, on which a plot of them would be a comb.
//! The samples from one step to the next are spread over
//! the ticks of its segment.

use std::collections::HashMap;

use super::chunk::{Index, Moment, Opening};
use crate::delay::{Candidate, Decision, Doubt, TrialEstimate, Verdict, doubts};
use crate::experiment::{Joint, Trial};
use crate::report::page::timeline::Timeline;
use crate::report::{Detail, Doubted, EstimatedJoint};
use crate::units::signed;
use crate::wording::{doubt_sentence, number};

/// Candidates that [`Detail::Lean`] keeps of an accepted segment.
const LEAN_CANDIDATES: usize = 25;

/// Where each trial starts, the same for all joints.
#[derive(Debug, Default)]
pub(super) struct TrialStarts {
    starts: HashMap<String, Start>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Start {
    samples_before: i64,
    seconds_before: f64,
}

impl Start {
    /// Sample `k` of `trial`, which starts here, on the timeline of samples.
    pub(super) fn sample(self, k: usize) -> i64 {
        self.samples_before + signed(k)
    }

    /// Sample `k` of `trial`, which starts here, on the timeline of time.
    pub(super) fn time_ns(self, trial: &Trial, k: usize) -> i64 {
        let seconds = self.seconds_before + (k as f64 - 1.0) * trial.period().seconds();
        #[expect(clippy::cast_possible_truncation, reason = "292 years fit")]
        let nanoseconds = (seconds * 1e9).round() as i64;
        nanoseconds
    }
}

impl TrialStarts {
    pub(super) fn of<'a>(joints: impl Iterator<Item = &'a Joint>) -> Self {
        let mut longest: Vec<&Trial> = Vec::new();
        let mut place: HashMap<&str, usize> = HashMap::new();
        for trial in joints.flat_map(|joint| &joint.trials) {
            match place.get(trial.label()).and_then(|&index| longest.get_mut(index)) {
                Some(known) if known.len() < trial.len() => *known = trial,
                Some(_) => {}
                None => {
                    place.insert(trial.label(), longest.len());
                    longest.push(trial);
                }
            }
        }
        let mut next = Start { samples_before: 0, seconds_before: 0.0 };
        let mut starts = HashMap::new();
        for trial in longest {
            starts.insert(trial.label().to_owned(), next);
            next.samples_before += signed(trial.len()) + 1;
            next.seconds_before += (trial.len() + 1) as f64 * trial.period().seconds();
        }
        Self { starts }
    }

    pub(super) fn of_trial(&self, trial: &Trial) -> Start {
        let first = Start { samples_before: 0, seconds_before: 0.0 };
        self.starts.get(trial.label()).copied().unwrap_or(first)
    }
}

/// One joint on the timelines.
#[derive(Debug)]
pub(super) struct JointLayout<'a> {
    pub(super) estimated: EstimatedJoint<'a>,
    pub(super) joint: &'a Joint,
    pub(super) trials: Vec<TrialLayout<'a>>,
    /// What the recording opens on, beside its decisions.
    pub(super) first: Opening,
    /// The last one.
    pub(super) last_revision: Option<i64>,
}

/// One trial of a joint on the timelines.
#[derive(Debug)]
pub(super) struct TrialLayout<'a> {
    /// Its place among the joint's trials.
    pub(super) index: usize,
    /// The joint that it is of.
    pub(super) estimated: EstimatedJoint<'a>,
    pub(super) trial: &'a Trial,
    pub(super) estimate: &'a TrialEstimate,
    pub(super) segments: Vec<SegmentLayout<'a>>,
    start: Start,
    /// Tick and segment of the samples before the first step.
    idle: (i64, i64),
}

/// One segment on the timelines.
#[derive(Debug)]
pub(super) struct SegmentLayout<'a> {
    pub(super) decision: &'a Decision,
    /// Number of the segment over all trials, from 1.
    pub(super) number: i64,
    /// Its first tick.
    pub(super) opening: i64,
    /// How doubtful its decision is.
    pub(super) doubt: Doubt,
    /// Its place among all decisions of the joint by doubt, from 1.
    pub(super) rank: i64,
    /// Its place by the difference to other results, from 1; 0 where there are none.
    pub(super) difference: i64,
    /// Indices of the candidates that are recorded, ascending.
    pub(super) kept: Vec<usize>,
}

/// A segment, with the trial it lies in.
pub(super) type Placed<'l, 'a> = (&'l TrialLayout<'a>, &'l SegmentLayout<'a>);

impl SegmentLayout<'_> {
    pub(super) fn is_accepted(&self) -> bool {
        self.decision.verdict() == Verdict::Accepted
    }

    /// Its last tick.
    pub(super) fn verdict(&self) -> i64 {
        self.opening + signed(self.kept.len()) + 1
    }

    /// Where the delay ends: a sample, or a place between two where it is known so finely.
    pub(super) fn place(&self) -> Option<String> {
        let p = self.decision.input_step.sample;
        if self.decision.delay_before_review().is_some() {
            return self.decision.delay().map(|delay| number(p as f64 + delay));
        }
        match (self.decision.fine, self.decision.candidates.best()) {
            (Some(fine), Some(_)) => Some(format!("{:.2}", p as f64 + fine.delay)),
            (_, best) => best.map(|best| best.breakpoint.to_string()),
        }
    }

    /// The tick that belongs to a sample of the trial: those between this step and the
    /// next are spread evenly over the ticks.
    fn tick_at(&self, sample: usize) -> i64 {
        let ticks = self.kept.len() + 2;
        let passed = sample.saturating_sub(self.decision.input_step.sample);
        let reached = (passed * ticks / self.decision.hold.max(1)).min(ticks - 1);
        self.opening + signed(reached)
    }
}

impl<'a> JointLayout<'a> {
    pub(super) fn of(
        estimated: EstimatedJoint<'a>,
        starts: &TrialStarts,
        (detail, revisions): (Detail, Option<(i64, i64)>),
        first_tick: i64,
    ) -> Self {
        let mut tick = 1;
        let mut number = 0;
        let mut trials: Vec<TrialLayout<'a>> = Vec::new();
        let joint = estimated.joint;
        let results = joint.trials.iter().zip(&estimated.estimate.trials).enumerate();
        for (index, (trial, result)) in results {
            let Ok(estimate) = result else { continue };
            let idle = (tick, number.max(1));
            let mut segments = Vec::with_capacity(estimate.decisions.len());
            let output = estimate.smoothed.as_deref().unwrap_or(trial.output());
            for (decision, doubt) in doubts(&estimate.decisions, output) {
                number += 1;
                let kept = kept(decision, &doubt, detail);
                let segment = SegmentLayout {
                    decision,
                    number,
                    opening: tick,
                    doubt,
                    rank: 0,
                    difference: 0,
                    kept,
                };
                tick = segment.verdict() + 1;
                segments.push(segment);
            }
            let start = starts.of_trial(trial);
            let trial = TrialLayout { index, estimated, trial, estimate, segments, start, idle };
            trials.push(trial);
        }
        let (first_revision, last_revision) = revisions.unzip();
        let first = Opening { tick: first_tick, revision: first_revision, is_compared: false };
        let mut segments: Vec<_> =
            trials.iter_mut().flat_map(|trial| &mut trial.segments).collect();
        segments.sort_by(|a, b| b.doubt.value().total_cmp(&a.doubt.value()));
        for (segment, rank) in segments.into_iter().zip(1..) {
            segment.rank = rank;
        }
        Self { estimated, joint, trials, first, last_revision }
    }

    /// The opening ticks of all segments, with their ranks by doubt.
    pub(super) fn openings(&self) -> Index {
        let index: Index = self.segments().map(|(trial, segment)| trial.opening(segment)).collect();
        let differences = self.segments().filter(|_| self.first.is_compared);
        index
            .with("doubt", self.segments().map(|(_, segment)| segment.rank))
            .with("difference", differences.map(|(_, segment)| segment.difference))
    }

    /// So many rows at the last moment of the record.
    ///
    /// There a list keeps its own order, and a viewer does not scroll it to the cursor; a click on a
    /// rank leads to the timeline of ranks.
    pub(super) fn at_the_end(&self, rows: usize) -> Index {
        let last = self
            .segments()
            .last()
            .map(|(trial, segment)| trial.moment(segment, segment.verdict(), trial.trial.len()));
        last.into_iter().cycle().take(rows).collect()
    }

    /// The record as the viewer's timeline `time` has it.
    pub(super) fn timeline(&self) -> Timeline<'a> {
        let shift = |index: usize| {
            let trial = self.trial(index)?;
            Some(trial.seconds(1) - trial.trial.time_s(1))
        };
        let shifts = (0..self.joint.trials.len()).map(|index| shift(index).unwrap_or_default());
        Timeline::shifted(self.joint, shifts.collect())
    }

    /// The first sample of all.
    pub(super) fn start(&self) -> Option<Moment> {
        self.trials.iter().find_map(|trial| trial.moments(1).next())
    }

    /// The trial with this place among those of the joint.
    pub(super) fn trial(&self, index: usize) -> Option<&TrialLayout<'a>> {
        self.trials.iter().find(|trial| trial.index == index)
    }

    /// A signal of all trials: a row per sample that it is known at, and an empty one where it stops, so
    /// that no line is drawn over the gap.
    pub(super) fn series(
        &self,
        mut values: impl FnMut(&TrialLayout<'a>) -> Vec<Option<f64>>,
    ) -> (Index, Vec<Option<f64>>) {
        let (mut moments, mut known) = (Vec::new(), Vec::new());
        for trial in &self.trials {
            let mut there = false;
            let values = values(trial).into_iter().chain([None]);
            for (moment, value) in trial.moments(trial.trial.len() + 1).zip(values) {
                if value.is_some() || there {
                    moments.push(moment);
                    known.push(value);
                }
                there = value.is_some();
            }
        }
        (moments.into_iter().collect::<Index>().without_segment(), known)
    }

    /// Counts all decisions by their difference to other results, which is `weight` of a trial's
    /// label and the sample of a step: the largest first.
    pub(super) fn rank_by_difference(&mut self, weight: impl Fn(&str, usize) -> (u8, f64)) {
        self.first.is_compared = true;
        let mut all = Vec::new();
        for TrialLayout { trial, segments, .. } in &mut self.trials {
            let weight = |segment: &SegmentLayout<'_>| {
                weight(trial.label(), segment.decision.input_step.sample)
            };
            all.extend(segments.iter_mut().map(|segment| (weight(segment), segment)));
        }
        all.sort_by(|((kind_a, size_a), _), ((kind_b, size_b), _)| {
            kind_b.cmp(kind_a).then(size_b.total_cmp(size_a))
        });
        for ((_, segment), rank) in all.into_iter().zip(1..) {
            segment.difference = rank;
        }
    }

    /// The decision that is shown first: the most different one, or the most doubtful one.
    pub(super) fn shown_first(&self) -> Option<&SegmentLayout<'a>> {
        let by = |segment: &SegmentLayout<'_>| {
            if self.first.is_compared { segment.difference } else { segment.rank }
        };
        self.segments().map(|(_, segment)| segment).min_by_key(|segment| by(segment))
    }

    /// All segments in the order of a rank, such as that by doubt.
    pub(super) fn ranked(&self, rank: fn(&SegmentLayout<'_>) -> i64) -> Vec<Placed<'_, 'a>> {
        let mut all: Vec<_> = self.segments().collect();
        all.sort_by_key(|(_, segment)| rank(segment));
        all
    }

    /// All segments, with the trial they lie in.
    pub(super) fn segments(&self) -> impl Iterator<Item = Placed<'_, 'a>> {
        self.trials.iter().flat_map(|t| t.segments.iter().map(move |segment| (t, segment)))
    }
}

fn kept(decision: &Decision, doubt: &Doubt, detail: Detail) -> Vec<usize> {
    let count = decision.candidates.len();
    let thin = detail == Detail::Lean
        && decision.verdict() == Verdict::Accepted
        && !doubt.is_doubtful()
        && count > LEAN_CANDIDATES;
    if !thin {
        return (0..count).collect();
    }
    let best = decision.candidates.best().map_or(0, |best| best.f - 1);
    let spread = LEAN_CANDIDATES - 3;
    let mut kept: Vec<_> = (0..spread).map(|step| step * (count - 1) / (spread - 1)).collect();
    kept.extend([best.saturating_sub(1), best, (best + 1).min(count - 1)]);
    kept.sort_unstable();
    kept.dedup();
    kept
}

impl<'a> TrialLayout<'a> {
    /// The smoothed output, or the measured one where nothing was smoothed.
    pub(super) fn output(&self) -> &'a [f64] {
        self.estimate.smoothed.as_deref().unwrap_or(self.trial.output())
    }

    /// Values at every sample; none at those that were filled in while nothing was logged.
    pub(super) fn logged(&self, values: &[f64]) -> Vec<Option<f64>> {
        let mut logged = vec![None; values.len()];
        for k in self.trial.logged().flatten() {
            if let (Some(logged), Some(value)) = (logged.get_mut(k), values.get(k)) {
                *logged = Some(*value);
            }
        }
        logged
    }

    pub(super) fn sample(&self, k: usize) -> i64 {
        self.start.sample(k)
    }

    /// Seconds since the start of the record, in which trials follow one another.
    pub(super) fn seconds(&self, k: usize) -> f64 {
        self.time_ns(k) as f64 * 1e-9
    }

    /// Whether the joint has several trials.
    pub(super) fn is_one_of_several(&self) -> bool {
        self.estimated.joint.trials.len() > 1
    }

    /// Which step of which trial it is.
    pub(super) fn step(&self, segment: &SegmentLayout<'_>) -> String {
        let step = format!("step {}", segment.decision.number);
        if self.is_one_of_several() { format!("{}, {step}", self.trial.label()) } else { step }
    }

    pub(super) fn time_ns(&self, k: usize) -> i64 {
        self.start.time_ns(self.trial, k)
    }

    /// The moment of the samples `1 …  last`, in order.
    ///
    /// `last` may be one beyond the trial: the empty sample between two trials.
    pub(super) fn moments(&self, last: usize) -> impl Iterator<Item = Moment> + '_ {
        let mut coming = self.segments.iter().peekable();
        let mut current: Option<&SegmentLayout<'_>> = None;
        (1..=last).map(move |k| {
            if let Some(segment) = coming.next_if(|next| next.decision.input_step.sample <= k) {
                current = Some(segment);
            }
            let (decision, segment) =
                current.map_or(self.idle, |segment| (segment.tick_at(k), segment.number));
            Moment { decision, segment, sample: self.sample(k), time_ns: self.time_ns(k) }
        })
    }

    /// The moment of one sample; see [`moments`](Self::moments).
    pub(super) fn moment_of(&self, k: usize) -> Moment {
        let after = self.segments.partition_point(|s| s.decision.input_step.sample <= k);
        let current = after.checked_sub(1).and_then(|index| self.segments.get(index));
        let (decision, segment) = current.map_or(self.idle, |s| (s.tick_at(k), s.number));
        Moment { decision, segment, sample: self.sample(k), time_ns: self.time_ns(k) }
    }

    /// A tick of a segment, at the sample it speaks of.
    pub(super) fn moment(&self, segment: &SegmentLayout<'_>, decision: i64, k: usize) -> Moment {
        let (sample, time_ns) = (self.sample(k), self.time_ns(k));
        Moment { decision, segment: segment.number, sample, time_ns }
    }

    /// The decision on `segment`, as it is said in tables and pages.
    pub(super) fn doubted(&self, segment: &SegmentLayout<'a>) -> Doubted<'a> {
        let smoothed = self.estimate.smoothed.as_deref();
        let (decision, doubt) = (segment.decision, segment.doubt.clone());
        Doubted { joint: self.estimated, trial: self.trial, smoothed, decision, doubt }
    }

    /// What speaks most against the decision on `segment`.
    pub(super) fn reason(&self, segment: &SegmentLayout<'_>) -> String {
        let (decision, period) = (segment.decision, self.trial.period());
        doubt_sentence(&segment.doubt, decision.program_verdict(), period.seconds())
    }

    /// The opening tick, at the input step.
    pub(super) fn opening(&self, segment: &SegmentLayout<'_>) -> Moment {
        self.moment(segment, segment.opening, segment.decision.input_step.sample)
    }

    /// The verdict tick, at the breakpoint where there is one.
    pub(super) fn verdict(&self, segment: &SegmentLayout<'_>) -> Moment {
        let best = segment.decision.candidates.best();
        let k = best.map_or(segment.decision.input_step.sample, |best| best.breakpoint);
        self.moment(segment, segment.verdict(), k)
    }

    /// A tick moved to a sample between this step and the next: what is drawn of a
    /// candidate is then never seen in the drawing of another segment, whatever the
    /// timeline. Candidates reach into both neighbours.
    pub(super) fn within(&self, segment: &SegmentLayout<'_>, moment: Moment) -> Moment {
        let p = segment.decision.input_step.sample;
        let (first, last) = (self.sample(p), self.sample(segment.decision.next_sample() - 1));
        let sample = moment.sample.clamp(first, last.max(first));
        let ahead = usize::try_from(sample - first).unwrap_or(0);
        Moment { sample, time_ns: self.time_ns(p + ahead), ..moment }
    }

    /// All ticks of a segment: those without a candidate at its beginning and its end clear what is
    /// drawn of candidates.
    pub(super) fn ticks<'s>(
        &'s self,
        segment: &'s SegmentLayout<'_>,
    ) -> impl Iterator<Item = (Moment, Option<Candidate>)> + 's {
        let candidates = self.candidates(segment).map(|(moment, it)| (moment, Some(it)));
        let opening = std::iter::once((self.opening(segment), None));
        opening.chain(candidates).chain([(self.verdict(segment), None)])
    }

    /// The ticks of the recorded candidates, each at its breakpoint.
    pub(super) fn candidates<'s>(
        &'s self,
        segment: &'s SegmentLayout<'_>,
    ) -> impl Iterator<Item = (Moment, Candidate)> + 's {
        segment.kept.iter().zip(1..).filter_map(move |(&index, tick)| {
            let candidate = segment.decision.candidates.get(index)?;
            let decision = segment.opening + tick;
            Some((self.moment(segment, decision, candidate.breakpoint), candidate))
        })
    }
}
