//! The segments in which more than their share of the error arises.

use std::ops::Range;

use super::record::ResidualRecord;

/// A segment in which a larger share of the squared error arises than it has of the time.
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
    /// Share of the squared error that arises in it: of the error of the speed, where that is known,
    /// else of the residual; so with a condition of [`super::fails_where`] it adds up.
    pub share_of_squared_error: f64,
    /// Its samples, counted from 0 over all trials.
    pub samples: Range<usize>,
}

/// At most `count` segments, the one with the largest share of the squared error first.
///
/// Only those are named whose share is above what an even spread over the samples gives.
pub fn worst_segments(record: &ResidualRecord, count: usize) -> Vec<WorstSegment> {
    let Some(shares) = record.shares_of_what_arises() else { return Vec::new() };
    let segments = record.segments().iter().filter_map(|span| segment(record, span, &shares));
    let mut worst: Vec<_> = segments.collect();
    worst.sort_by(|a, b| b.share_of_squared_error.total_cmp(&a.share_of_squared_error));
    worst.truncate(count);
    worst
}

fn segment(record: &ResidualRecord, span: &Range<usize>, shares: &[f64]) -> Option<WorstSegment> {
    let share: f64 = shares.get(span.clone())?.iter().sum();
    let share_of_time = span.len() as f64 / record.len() as f64;
    if share <= share_of_time {
        return None;
    }
    let time_s = |sample: usize| record.samples().time_s.get(sample);
    let trial = *record.samples().trial.get(span.start)? as usize;
    Some(WorstSegment {
        trial: record.trials().get(trial)?.clone(),
        start_s: time_s(span.start)?,
        end_s: time_s(span.end - 1)?,
        rmse: record.rmse_of(span.clone()),
        share_of_squared_error: share,
        samples: span.clone(),
    })
}
