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
    /// `None` where a residual or an error of the speed is no finite number, or columns differ in
    /// length.
    pub fn new(samples: Samples, trials: Vec<String>, segments: Vec<Range<usize>>) -> Option<Self> {
        let Samples { residual, speed_error, .. } = &samples;
        let count = residual.len();
        let has_errors = speed_error.is_empty() || speed_error.len() == count;
        let are_finite = residual.iter().chain(speed_error).all(|value| value.is_finite());
        let is_whole = samples.lengths().iter().all(|length| *length == count) && has_errors;
        let fits = is_whole && are_finite && Row::try_from(count).is_ok();
        fits.then_some(Self { samples, trials, segments })
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
    fn lengths(&self) -> [usize; 7] {
        let Self { input, output, speed, time_s, since_step_s, hold_s, trial, .. } = self;
        let [a, b, c, d, e, f] = [input, output, speed, time_s, since_step_s, hold_s].map(Vec::len);
        [a, b, c, d, e, f, trial.len()]
    }
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
    fn what_does_not_fit_is_no_record() {
        let record = |samples| ResidualRecord::new(samples, vec!["a".into()], vec![0..2]);
        assert!(record(samples(4)).is_some());
        assert!(record(Samples { speed: vec![0.0; 3], ..samples(4) }).is_none());
        assert!(record(Samples { residual: vec![0.0, f64::INFINITY], ..samples(2) }).is_none());
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
