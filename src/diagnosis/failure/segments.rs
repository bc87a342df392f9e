//! The segments that hold more than their share of the squared residual.

use std::ops::Range;

use super::record::ResidualRecord;

/// A segment with a larger share of the squared residual than it has of the time.
#[derive(Clone, Debug, PartialEq)]
pub struct WorstSegment {
    /// Label of its trial.
    pub trial: String,
    /// Time of its first sample, seconds.
    pub start_s: f64,
    /// Time of its last sample, seconds.
    pub end_s: f64,
    /// Root mean square of its residual, output units.
    pub rmse: f64,
    /// The largest residual in it, with its sign, output units.
    pub largest_residual: f64,
    /// Its share of the squared residual of the whole record: what is seen of it. Where that arises,
    /// which may be before, [`super::fails_where`] says.
    pub share_of_squared_error: f64,
    /// Its samples, counted from 0 over all trials.
    pub samples: Range<usize>,
}

/// At most `count` segments of `record`, the one with the largest share of the square of `residual`
/// first: the values at its samples, one after the other, of this simulation or another one.
///
/// Only those are named whose share is above what an even spread over the samples gives. Where any
/// is, the one with the largest residual of all is among them, whatever its share: a short spike has
/// few squares.
pub fn worst_segments(
    record: &ResidualRecord,
    residual: impl IntoIterator<Item = f64>,
    count: usize,
) -> Vec<WorstSegment> {
    let (of_segments, all) = sums(record.segments(), residual);
    let segments = record.segments().iter().zip(of_segments);
    let segments = segments.filter_map(|(span, sum)| segment(record, span, sum, all));
    let mut segments: Vec<_> = segments.collect();
    segments.sort_by(|a, b| b.share_of_squared_error.total_cmp(&a.share_of_squared_error));
    let height = |segment: &WorstSegment| segment.largest_residual.abs();
    let highest = segments.iter().map(height).reduce(f64::max).unwrap_or_default();
    let is_spike = |segment: &WorstSegment| height(segment) >= highest;
    let mut worst: Vec<_> =
        segments.iter().filter(|it| is_above_even(record, it)).take(count).cloned().collect();
    if !worst.is_empty() && !worst.iter().any(is_spike) {
        // The spike takes the last place.
        worst.truncate(count - 1);
        worst.extend(segments.into_iter().find(is_spike));
    }
    worst
}

/// What is added up of the values in a segment.
#[derive(Clone, Copy, Default)]
struct Sum {
    square: f64,
    /// The value that is farthest from zero.
    largest: f64,
}

/// The sum in each of `segments`, and the squares of all values.
fn sums(segments: &[Range<usize>], values: impl IntoIterator<Item = f64>) -> (Vec<Sum>, f64) {
    let mut of_segments = vec![Sum::default(); segments.len()];
    let (mut at, mut all) = (0, 0.0);
    for (sample, value) in values.into_iter().enumerate() {
        let square = value * value;
        all += square;
        while segments.get(at).is_some_and(|span| span.end <= sample) {
            at += 1;
        }
        let own = segments.get(at).filter(|span| span.contains(&sample));
        if let Some(sum) = own.and_then(|_| of_segments.get_mut(at)) {
            sum.square += square;
            if value.abs() > sum.largest.abs() {
                sum.largest = value;
            }
        }
    }
    (of_segments, all)
}

fn segment(
    record: &ResidualRecord,
    span: &Range<usize>,
    Sum { square, largest }: Sum,
    all: f64,
) -> Option<WorstSegment> {
    let share_of_squared_error = if all > 0.0 { square / all } else { 0.0 };
    // Squares that overflow have no shares.
    if share_of_squared_error.is_nan() {
        return None;
    }
    let time_s = |sample: usize| record.samples().time_s.get(sample).copied();
    let trial = *record.samples().trial.get(span.start)? as usize;
    Some(WorstSegment {
        trial: record.trials().get(trial)?.clone(),
        start_s: time_s(span.start)?,
        end_s: time_s(span.end - 1)?,
        rmse: (square / span.len() as f64).sqrt(),
        largest_residual: largest,
        share_of_squared_error,
        samples: span.clone(),
    })
}

/// Whether a segment has more of the squared residual than of the time.
fn is_above_even(record: &ResidualRecord, segment: &WorstSegment) -> bool {
    segment.share_of_squared_error > segment.samples.len() as f64 / record.len() as f64
}
