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
    /// Its share of the squared residual of the whole record: what is seen of it. Where that arises,
    /// which may be before, [`super::fails_where`] says.
    pub share_of_squared_error: f64,
    /// Its samples, counted from 0 over all trials.
    pub samples: Range<usize>,
}

/// At most `count` segments of `record`, the one with the largest share of the square of `residual`
/// first: the values at its samples, one behind the other, of this simulation or another one.
///
/// Only those are named whose share is above what an even spread over the samples gives.
pub fn worst_segments(
    record: &ResidualRecord,
    residual: impl IntoIterator<Item = f64>,
    count: usize,
) -> Vec<WorstSegment> {
    let (of_segments, all) = squares(record.segments(), residual);
    let segments = record.segments().iter().zip(of_segments);
    let segments = segments.filter_map(|(span, square)| segment(record, span, (square, all)));
    let mut worst: Vec<_> = segments.collect();
    worst.sort_by(|a, b| b.share_of_squared_error.total_cmp(&a.share_of_squared_error));
    worst.truncate(count);
    worst
}

/// The sum of squares in each of `segments`, and of all values.
fn squares(segments: &[Range<usize>], values: impl IntoIterator<Item = f64>) -> (Vec<f64>, f64) {
    let mut of_segments = vec![0.0; segments.len()];
    let (mut at, mut all) = (0, 0.0);
    for (sample, value) in values.into_iter().enumerate() {
        let square = value * value;
        all += square;
        while segments.get(at).is_some_and(|span| span.end <= sample) {
            at += 1;
        }
        let own = segments.get(at).filter(|span| span.contains(&sample));
        if let Some(sum) = own.and_then(|_| of_segments.get_mut(at)) {
            *sum += square;
        }
    }
    (of_segments, all)
}

fn segment(
    record: &ResidualRecord,
    span: &Range<usize>,
    (square, all): (f64, f64),
) -> Option<WorstSegment> {
    let share_of_squared_error = if all > 0.0 { square / all } else { 0.0 };
    let share_of_time = span.len() as f64 / record.len() as f64;
    // Squares that overflow have no shares.
    if share_of_squared_error.is_nan() || share_of_squared_error <= share_of_time {
        return None;
    }
    let time_s = |sample: usize| record.samples().time_s.get(sample);
    let trial = *record.samples().trial.get(span.start)? as usize;
    Some(WorstSegment {
        trial: record.trials().get(trial)?.clone(),
        start_s: time_s(span.start)?,
        end_s: time_s(span.end - 1)?,
        rmse: (square / span.len() as f64).sqrt(),
        share_of_squared_error,
        samples: span.clone(),
    })
}
