//! The residual of one joint, and what happened at each of its samples.

use std::ops::Range;

use super::column::EvenColumn;

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
    pub time_s: EvenColumn,
    /// Seconds since the step that acts.
    pub since_step_s: EvenColumn,
    /// How long its level is held, seconds.
    pub hold_s: EvenColumn,
    /// Index of the trial in [`ResidualRecord::trials`].
    pub trial: Vec<u32>,
    /// Measured minus simulated speed, output units per second: where an error arises. Empty
    /// where it is not known.
    pub speed_error: Vec<f64>,
}

impl Samples {
    /// None yet, with room for so many.
    pub(crate) fn with_capacity(samples: usize) -> Self {
        let room = || Vec::with_capacity(samples);
        Self {
            residual: room(),
            input: room(),
            output: room(),
            speed: room(),
            time_s: EvenColumn::default(),
            since_step_s: EvenColumn::default(),
            hold_s: EvenColumn::default(),
            trial: Vec::with_capacity(samples),
            speed_error: room(),
        }
    }
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
#[non_exhaustive]
pub enum RecordError {
    /// A column is not as long as the residual.
    #[error("`{column}` has {found} samples, the residual {expected}")]
    UnequalLengths {
        /// Name of the column.
        column: &'static str,
        /// Its samples.
        found: usize,
        /// Samples of the residual.
        expected: usize,
    },
    /// A residual, or an error of the speed, is NaN or infinite.
    #[error("residual {index} is not a finite number")]
    NotFinite {
        /// Its index, from 0.
        index: usize,
    },
    /// There are more samples than are counted.
    #[error("there are {samples} samples, which is more than {}", u32::MAX)]
    TooMany {
        /// Number of samples.
        samples: usize,
    },
    /// A sample belongs to a trial that has no label.
    #[error("sample {index} is of trial {trial}, but there are {trials} trials")]
    UnknownTrial {
        /// Index of the sample, from 0.
        index: usize,
        /// The trial's index, from 0.
        trial: usize,
        /// Number of trials.
        trials: usize,
    },
    /// A segment is empty, out of order, or reaches beyond the samples.
    #[error("segment {number} is not a part of the {samples} samples behind the one before it")]
    Segment {
        /// Number of the segment, from 1.
        number: usize,
        /// Number of samples.
        samples: usize,
    },
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
        let expected = samples.residual.len();
        if Row::try_from(expected).is_err() {
            return Err(RecordError::TooMany { samples: expected });
        }
        let odd = samples.lengths().find(|(_, found)| *found != expected);
        if let Some((column, found)) = odd {
            return Err(RecordError::UnequalLengths { column, found, expected });
        }
        let mut residuals = samples.residual.iter().chain(&samples.speed_error);
        if let Some(index) = residuals.position(|value| !value.is_finite()) {
            return Err(RecordError::NotFinite { index: index % expected });
        }
        let is_unknown = |trial: &u32| *trial as usize >= trials.len();
        let unknown = samples.trial.iter().position(is_unknown);
        if let Some((index, trial)) = unknown.and_then(|at| Some((at, *samples.trial.get(at)?))) {
            let trial = trial as usize;
            return Err(RecordError::UnknownTrial { index, trial, trials: trials.len() });
        }
        if let Some(number) = misplaced(&segments, expected) {
            return Err(RecordError::Segment { number, samples: expected });
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

/// The number, from 1, of the first segment that is not behind the one before it.
fn misplaced(segments: &[Range<usize>], samples: usize) -> Option<usize> {
    let mut end = 0;
    for (segment, number) in segments.iter().zip(1..) {
        if segment.start < end || segment.is_empty() || segment.end > samples {
            return Some(number);
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
            time_s: zeros.clone().into(),
            since_step_s: zeros.clone().into(),
            hold_s: zeros.into(),
            trial: vec![0; count],
            speed_error: Vec::new(),
        }
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let record = |samples, segments| ResidualRecord::new(samples, vec!["a".into()], segments);
        assert!(record(samples(4), vec![0..2, 2..4]).is_ok());
        let short = Samples { speed: vec![0.0; 3], ..samples(4) };
        let expected = RecordError::UnequalLengths { column: "speed", found: 3, expected: 4 };
        assert_eq!(record(short, vec![]), Err(expected));
        let infinite = Samples { residual: vec![0.0, f64::INFINITY], ..samples(2) };
        assert_eq!(record(infinite, vec![]), Err(RecordError::NotFinite { index: 1 }));
        let strange = Samples { trial: vec![0, 1], ..samples(2) };
        let expected = RecordError::UnknownTrial { index: 1, trial: 1, trials: 1 };
        assert_eq!(record(strange, vec![]), Err(expected));
        for segments in [vec![0..2, 1..3], vec![0..1, 3..5], vec![0..1, 2..2]] {
            let number = segments.len();
            let expected = RecordError::Segment { number, samples: 4 };
            assert_eq!(record(samples(4), segments), Err(expected));
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
