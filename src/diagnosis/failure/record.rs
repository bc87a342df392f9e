//! The residual of one joint, and what happened at each of its samples.

use std::ops::Range;

/// The index of a sample, from 0: half as long as a `usize`, and there are columns of them.
pub(super) type Row = u32;

/// The value of a row.
pub(super) fn of_row<T: Copy>(column: &[T], row: Row) -> T {
    column[row as usize]
}

/// What happened at each sample of one joint, over all its trials one after the other.
///
/// All columns have the same length. NaN stands where a value is not known, as the time
/// since the last step is before the first one; the residual is always known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Measured minus simulated, output units.
    pub residual: Vec<f64>,
    /// The input as it acts, so delayed, input units.
    pub input: Vec<f64>,
    /// Output units.
    pub output: Vec<f64>,
    /// Speed of the output with its sign, output units per second.
    pub speed: Vec<f64>,
    /// Seconds in the record.
    pub time_s: Vec<f64>,
    /// Seconds since the step that acts.
    pub since_step_s: Vec<f64>,
    /// How long its level is held, seconds.
    pub hold_s: Vec<f64>,
    /// Index of the trial in [`ResidualRecord::trials`].
    pub trial: Vec<u32>,
    /// Measured minus simulated speed, output units per second: where an error arises. Empty
    /// where it is not known.
    pub speed_error: Vec<f64>,
}

/// Units of input and output, where they are known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Units {
    /// Unit of the input.
    pub input: Option<String>,
    /// Unit of the output.
    pub output: Option<String>,
}

/// Why samples do not make a [`ResidualRecord`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{what}` does not go with {samples} samples of the residual, at {index}")]
pub struct RecordError {
    /// A column, or `segments`.
    pub what: &'static str,
    /// The first value or segment that is no finite number, of no known trial, or not after the
    /// one before; the length of a column with another one.
    pub index: usize,
    /// Samples of the residual.
    pub samples: usize,
}

/// The residual of one joint with all that it is held against.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualRecord {
    samples: Samples,
    trials: Vec<String>,
    segments: Vec<Range<usize>>,
}

impl ResidualRecord {
    /// A record of `samples`, whose trials have the labels `trials`.
    ///
    /// `segments` are the spans of samples, counted from 0, that belong to one input step
    /// each. They are in order, do not overlap, and need not cover all samples.
    ///
    /// # Errors
    /// [`RecordError`], the first that is found.
    pub fn new(
        samples: Samples,
        trials: Vec<String>,
        segments: Vec<Range<usize>>,
    ) -> Result<Self, RecordError> {
        let count = samples.residual.len();
        let error = |what: &'static str, index: usize| RecordError { what, index, samples: count };
        if Row::try_from(count).is_err() {
            return Err(error("residual", count));
        }
        if let Some((column, length)) = samples.lengths().find(|(_, length)| *length != count) {
            return Err(error(column, length));
        }
        for (column, values) in
            [("residual", &samples.residual), ("speed_error", &samples.speed_error)]
        {
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                return Err(error(column, index));
            }
        }
        let is_unknown = |trial: &u32| *trial as usize >= trials.len();
        if let Some(index) = samples.trial.iter().position(is_unknown) {
            return Err(error("trial", index));
        }
        if let Some(index) = misplaced(&segments, count) {
            return Err(error("segments", index));
        }
        Ok(Self { samples, trials, segments })
    }

    /// The columns.
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// Labels of the trials.
    pub fn trials(&self) -> &[String] {
        &self.trials
    }

    /// The spans of samples, counted from 0, that belong to one input step each.
    pub fn segments(&self) -> &[Range<usize>] {
        &self.segments
    }

    /// The indices of all samples.
    pub(super) fn rows(&self) -> Range<Row> {
        0..Row::try_from(self.len()).unwrap_or(Row::MAX)
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.samples.residual.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The squared error of the speed of each sample, or its residual where that is not
    /// known, as a share of their sum.
    pub(super) fn shares_of_what_arises(&self) -> Option<Vec<f64>> {
        let known = Some(&self.samples.speed_error).filter(|errors| !errors.is_empty());
        squared_shares(known.unwrap_or(&self.samples.residual))
    }

    /// Root mean square of the residuals of the samples `rows`, output units.
    pub(super) fn rmse_of(&self, rows: impl IntoIterator<Item = Row>) -> f64 {
        let residuals = rows.into_iter().map(|row| of_row(&self.samples.residual, row));
        let (sum, count) = residuals.fold((0.0, 0_usize), |(sum, n), r| (sum + r * r, n + 1));
        (sum / count.max(1) as f64).sqrt()
    }
}

/// The square of each value, as a share of their sum; `None` when that is 0.
fn squared_shares(values: &[f64]) -> Option<Vec<f64>> {
    let largest = values.iter().fold(0.0, |max: f64, value| max.max(value.abs()));
    if largest <= 0.0 {
        return None;
    }
    let mut shares: Vec<f64> = values.iter().map(|value| (value / largest).powi(2)).collect();
    let sum: f64 = shares.iter().sum();
    for share in &mut shares {
        *share /= sum;
    }
    Some(shares)
}

impl Samples {
    fn lengths(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let speed_errors = Some(self.speed_error.len()).filter(|length| *length > 0);
        let columns = [
            ("input", self.input.len()),
            ("output", self.output.len()),
            ("speed", self.speed.len()),
            ("time_s", self.time_s.len()),
            ("since_step_s", self.since_step_s.len()),
            ("hold_s", self.hold_s.len()),
            ("trial", self.trial.len()),
        ];
        columns.into_iter().chain(speed_errors.map(|length| ("speed_error", length)))
    }
}

/// The index of the first segment that is not after the one before it.
fn misplaced(segments: &[Range<usize>], samples: usize) -> Option<usize> {
    let mut end = 0;
    for (index, segment) in segments.iter().enumerate() {
        if segment.start < end || segment.is_empty() || segment.end > samples {
            return Some(index);
        }
        end = segment.end;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(count: usize) -> Samples {
        let zeros = vec![0.0; count];
        Samples {
            residual: zeros.clone(),
            input: zeros.clone(),
            output: zeros.clone(),
            speed: zeros.clone(),
            time_s: zeros.clone(),
            since_step_s: zeros.clone(),
            hold_s: zeros,
            trial: vec![0; count],
            speed_error: Vec::new(),
        }
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let record = |samples, segments| ResidualRecord::new(samples, vec!["a".into()], segments);
        assert!(record(samples(4), vec![0..2, 2..4]).is_ok());
        let error = |what, index, samples| Err(RecordError { what, index, samples });
        let short = Samples { speed: vec![0.0; 3], ..samples(4) };
        assert_eq!(record(short, vec![]), error("speed", 3, 4));
        let infinite = Samples { residual: vec![0.0, f64::INFINITY], ..samples(2) };
        assert_eq!(record(infinite, vec![]), error("residual", 1, 2));
        let strange = Samples { trial: vec![0, 1], ..samples(2) };
        assert_eq!(record(strange, vec![]), error("trial", 1, 2));
        for segments in [vec![0..2, 1..3], vec![0..1, 3..5], vec![0..1, 2..2]] {
            assert_eq!(record(samples(4), segments), error("segments", 1, 4));
        }
    }

    #[test]
    fn shares_of_a_tiny_error_still_sum_to_one() {
        let tiny = Samples { residual: vec![1e-200, 3e-200], ..samples(2) };
        let record = ResidualRecord::new(tiny, vec!["a".into()], vec![]).unwrap();
        let shares = record.shares_of_what_arises().unwrap();
        assert!((shares[0] - 0.1).abs() < 1e-15 && (shares[1] - 0.9).abs() < 1e-15);
        let none = ResidualRecord::new(samples(2), vec!["a".into()], vec![]).unwrap();
        assert_eq!(none.shares_of_what_arises(), None);
    }
}
