//! Trials on one time axis, signals as lines along it, and parts of the record that are marked behind a
//! residual: what the model was not fitted to, where it is worst, and where it fails.

use std::ops::Range;

use crate::diagnosis::Comparison;
use crate::diagnosis::failure::{FailsWhere, WorstSegment};
use crate::experiment::{Joint, Trial};
use crate::figure::{Axis, Mark, Place, Role, Shape, Span, thinned_to};
use crate::fit::Part;
use crate::units::floor_to_index;
use crate::wording::misfit_units;

/// Points of a line over the whole width: two for each column that is seen.
const POINTS: f64 = 1500.0;

/// When each trial of a joint is: as in the log where trials follow one another there, else
/// each after the one before it.
pub(crate) struct Timeline<'a> {
    trials: &'a [Trial],
    /// What is added to the times of each trial, seconds.
    shifts_s: Vec<f64>,
    name: &'static str,
}

impl<'a> Timeline<'a> {
    /// Each trial by its own clock, and so many seconds later.
    pub(crate) fn shifted(joint: &'a Joint, shifts_s: Vec<f64>) -> Self {
        Self { trials: &joint.trials, shifts_s, name: "time [s]" }
    }

    pub(super) fn of(joint: &'a Joint) -> Self {
        let trials = &*joint.trials;
        let follows = |pair: &[Trial]| match pair {
            [before, after] => end_s(before) < after.time_s(1),
            _ => true,
        };
        if trials.windows(2).all(follows) {
            return Self { trials, shifts_s: vec![0.0; trials.len()], name: "time [s]" };
        }
        let mut start = 0.0;
        let shift = |trial: &Trial| {
            let shift = start - trial.time_s(1);
            start += end_s(trial) - trial.time_s(1);
            shift
        };
        let name = "time, one trial after the other [s]";
        Self { trials, shifts_s: trials.iter().map(shift).collect(), name }
    }

    /// The place of a sample, counted from 1, of a trial.
    pub(crate) fn at(&self, trial: usize, sample: f64) -> f64 {
        let shift = self.shifts_s.get(trial).copied().unwrap_or_default();
        self.trials
            .get(trial)
            .map_or(shift, |own| shift + own.time_s(1) + (sample - 1.0) * own.period().seconds())
    }

    /// A time of the log in a trial.
    pub(super) fn of_log(&self, trial: usize, time_s: f64) -> f64 {
        self.shifts_s.get(trial).copied().unwrap_or_default() + time_s
    }

    pub(super) fn axis(&self) -> Axis {
        let (from, to) = self.ends();
        Axis::new(Span::new(from, to), self.name, 10.0)
    }

    /// The first and the last moment.
    pub(super) fn ends(&self) -> (f64, f64) {
        let last = self.trials.len().saturating_sub(1);
        let samples = self.trials.last().map_or(1, Trial::len);
        (self.at(0, 1.0), self.at(last, samples as f64))
    }

    /// Where trials after the first begin; nothing where these are too many to be distinguished.
    pub(super) fn borders(&self) -> Mark {
        const MOST: usize = 60;
        let places = (1..self.trials.len()).map(|trial| self.at(trial, 1.0));
        let places = if self.trials.len() > MOST { Vec::new() } else { places.collect() };
        Mark::new(Role::Faint, Shape::Verticals(places, 0.5))
    }

    /// Parts of the record, as dense as that.
    pub(super) fn shaded(&self, role: Role, spans: Spans, density: f64) -> Mark {
        let ends = spans.into_iter().map(|(trial, span)| {
            (self.at(trial, (span.start + 1) as f64), self.at(trial, span.end as f64))
        });
        Mark::new(role, Shape::Spans(ends.collect(), density))
    }

    /// A signal of each trial as lines, thinned to what can be seen; none where nothing was logged.
    pub(super) fn lines<'v>(
        &self,
        values: impl Fn(usize, &'a Trial) -> &'v [f64],
    ) -> Vec<Vec<Place>> {
        let all: usize = self.trials.iter().map(Trial::len).sum();
        let runs = |(index, trial): (usize, &'a Trial)| {
            let values = values(index, trial);
            trial.logged().map(move |run| (index, run.start, values.get(run).unwrap_or_default()))
        };
        let line = |(index, start, values): (usize, usize, &'v [f64])| {
            let kept = thinned_to(values, points(values.len(), all));
            let place = |k: usize| Some((self.at(index, (start + k + 1) as f64), *values.get(k)?));
            kept.into_iter().filter_map(place).collect()
        };
        self.trials.iter().enumerate().flat_map(runs).map(line).collect()
    }

    /// A signal that is held between its changes, in steps.
    pub(super) fn held<'v>(
        &self,
        values: impl Fn(usize, &'a Trial) -> &'v [f64],
    ) -> Vec<Vec<Place>> {
        self.lines(values).into_iter().map(|line| steps(&line)).collect()
    }
}

/// A signal's values in all trials, where they were logged.
pub(super) fn values_of<'v>(
    joint: &'v Joint,
    values: impl Fn(usize, &'v Trial) -> &'v [f64],
) -> impl Iterator<Item = f64> {
    let logged = move |(index, trial): (usize, &'v Trial)| {
        let values = values(index, trial);
        trial.logged().flat_map(move |run| values.get(run).unwrap_or_default()).copied()
    };
    joint.trials.iter().enumerate().flat_map(logged)
}

/// Time of the end of the last sample.
fn end_s(trial: &Trial) -> f64 {
    trial.time_s(trial.len() + 1)
}

/// Points for a part of a line.
fn points(part: usize, whole: usize) -> usize {
    /// Fewest for any part.
    const FEWEST: usize = 8;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of it")]
    let share = (POINTS * part as f64 / whole.max(1) as f64) as usize;
    share.max(FEWEST)
}

/// Corners of a line that keeps each value until the next place.
fn steps(line: &[Place]) -> Vec<Place> {
    let mut corners: Vec<Place> = Vec::new();
    let mut level = f64::NAN;
    for (x, y) in line.iter().copied() {
        #[expect(clippy::float_cmp, reason = "a step is any change")]
        if y != level {
            corners.extend((!level.is_nan()).then_some((x, level)));
            corners.push((x, y));
            level = y;
        }
    }
    corners.extend(line.last().map(|last| (last.0, level)));
    corners
}

/// Samples of a trial, counted from 0, with the trial's index among those of its joint.
pub(crate) type Spans = Vec<(usize, Range<usize>)>;

/// The part that was not fitted to.
pub(crate) fn validation(comparison: &Comparison) -> Spans {
    let steps = comparison.per_step.iter().filter(|step| step.part == Part::Validation);
    joined(steps.map(|step| (step.trial, step.start..step.start + step.samples)))
}

/// The worst segments, in their order.
pub(crate) fn worst(joint: &Joint, comparison: &Comparison) -> Spans {
    let segments = comparison.failure.iter().flat_map(|failure| &failure.worst_segments);
    let span = |worst: &WorstSegment| {
        let mut trials = joint.trials.iter().enumerate();
        let (index, trial) = trials.find(|(_, trial)| trial.label() == worst.trial)?;
        let [first, last] = [worst.start_s, worst.end_s].map(|time_s| {
            floor_to_index(((time_s - trial.time_s(1)) / trial.period().seconds()).round())
        });
        Some((index, first..last + 1))
    };
    segments.filter_map(span).collect()
}

/// The condition under which most of the error arises.
fn condition(comparison: &Comparison) -> Option<&FailsWhere> {
    FailsWhere::strongest(&comparison.failure.as_ref()?.fails_where)
}

/// Its name, and where it holds.
pub(crate) fn named(joint: &Joint, comparison: &Comparison) -> Option<(String, Spans)> {
    let units = misfit_units(joint);
    let clauses = condition(comparison)?.clauses.iter().map(|clause| clause.with_unit(&units));
    let name = clauses.collect::<Vec<_>>().join(" and ");
    Some((name, where_it_fails(comparison)))
}

/// Where that condition holds.
fn where_it_fails(comparison: &Comparison) -> Spans {
    let samples = condition(comparison).map_or(&[][..], |condition| &condition.samples);
    let mut holding = samples.iter().map(|sample| *sample as usize).peekable();
    let mut spans = Spans::new();
    let mut start = 0;
    for (index, residual) in comparison.fit.evaluation.residuals.iter().enumerate() {
        let end = start + residual.len();
        let own = std::iter::from_fn(|| holding.next_if(|sample| *sample < end));
        spans.extend(joined(own.map(|sample| (index, sample - start..sample - start + 1))));
        start = end;
    }
    spans
}

/// Neighbours as one.
fn joined(spans: impl Iterator<Item = (usize, Range<usize>)>) -> Spans {
    let mut all: Spans = Vec::new();
    for (trial, span) in spans {
        match all.last_mut() {
            Some((known, last)) if *known == trial && last.end == span.start => last.end = span.end,
            _ => all.push((trial, span)),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    fn joint(starts_s: &[f64]) -> Joint {
        let period = SamplePeriod::from_seconds(0.1).unwrap();
        let trial =
            |start: &f64| Trial::new("t", *start, period, vec![0.0; 50], vec![0.0; 50]).unwrap();
        let trials = starts_s.iter().map(trial).collect();
        let name = "boom".to_owned();
        Joint { name, input_unit: None, output_unit: None, covariates: Vec::new(), trials }
    }

    #[test]
    fn trials_that_follow_one_another_keep_their_times() {
        let joint = joint(&[10.0, 20.0]);
        let timeline = Timeline::of(&joint);
        assert!((timeline.at(1, 1.0) - 20.0).abs() < 1e-12);
        assert_eq!(timeline.name, "time [s]");
    }

    #[test]
    fn trials_that_each_count_from_zero_stand_in_a_row() {
        let joint = joint(&[0.0, 0.0]);
        let timeline = Timeline::of(&joint);
        assert!((timeline.at(1, 1.0) - 5.0).abs() < 1e-12);
        assert!((timeline.of_log(1, 0.3) - 5.3).abs() < 1e-12);
    }

    #[test]
    fn a_held_signal_has_corners_only() {
        let line = [(0.0, 1.0), (1.0, 1.0), (2.0, 3.0), (3.0, 3.0)];
        assert_eq!(steps(&line), [(0.0, 1.0), (2.0, 1.0), (2.0, 3.0), (3.0, 3.0)]);
    }

    #[test]
    fn neighbours_are_joined_within_a_trial() {
        let spans = [(0, 0..2), (0, 2..5), (0, 7..9), (1, 9..10)];
        assert_eq!(joined(spans.into_iter()), [(0, 0..5), (0, 7..9), (1, 9..10)]);
    }
}
