//! Trials: one uninterrupted, uniformly sampled run of a joint.

use std::ops::Range;

use crate::numerics::to_digits_by;
use crate::units::SamplePeriod;

/// One uninterrupted, uniformly sampled run of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    label: String,
    start_s: f64,
    origin_s: f64,
    period: SamplePeriod,
    input: Vec<f64>,
    output: Vec<f64>,
    covariates: Vec<Vec<f64>>,
    unlogged: Vec<Range<usize>>,
    interpolated: Vec<Range<usize>>,
}

/// Why samples do not make a [`Trial`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TrialError {
    /// There is not one sample.
    #[error("trial `{label}` has no samples")]
    Empty {
        /// The trial's label.
        label: String,
    },
    /// Input and output differ in length.
    #[error("trial `{label}` has {input} input samples and {output} output samples")]
    UnequalLengths {
        /// The trial's label.
        label: String,
        /// Samples of the input.
        input: usize,
        /// Samples of the output.
        output: usize,
    },
    /// A sample is NaN or infinite.
    #[error("trial `{label}` has a sample that is not finite: number {sample}")]
    NotFinite {
        /// The trial's label.
        label: String,
        /// Its 1-based number in the trial.
        sample: usize,
    },
}

impl Trial {
    /// A trial of `input` and `output`, sample for sample, from `start_s` on.
    ///
    /// # Errors
    /// [`TrialError`] when there is no sample, when the lengths differ, or when a
    /// sample is not finite.
    pub fn new(
        label: impl Into<String>,
        start_s: f64,
        period: SamplePeriod,
        input: Vec<f64>,
        output: Vec<f64>,
    ) -> Result<Self, TrialError> {
        let label = label.into();
        if input.len() != output.len() {
            let (input, output) = (input.len(), output.len());
            return Err(TrialError::UnequalLengths { label, input, output });
        }
        if input.is_empty() {
            return Err(TrialError::Empty { label });
        }
        let is_odd = |(u, y): (&f64, &f64)| !u.is_finite() || !y.is_finite();
        if let Some(index) = input.iter().zip(&output).position(is_odd) {
            return Err(TrialError::NotFinite { label, sample: index + 1 });
        }
        Ok(Self {
            label,
            start_s,
            origin_s: 0.0,
            period,
            input,
            output,
            covariates: Vec::new(),
            unlogged: Vec::new(),
            interpolated: Vec::new(),
        })
    }

    /// This trial with times that count from when the clock of the log showed `origin_s` more than
    /// what they count from now.
    #[must_use]
    pub(crate) fn counted_from(self, origin_s: f64) -> Self {
        let (start_s, origin_s) = (self.start_s - origin_s, self.origin_s + origin_s);
        Self { start_s, origin_s, ..self }
    }

    /// This trial with further signals. Where one was not measured it holds NaN.
    ///
    /// # Errors
    /// [`TrialError::UnequalLengths`] when one is not as long as the output.
    pub fn with_covariates(mut self, covariates: Vec<Vec<f64>>) -> Result<Self, TrialError> {
        if let Some(odd) = covariates.iter().find(|signal| signal.len() != self.len()) {
            let (input, output) = (odd.len(), self.len());
            return Err(TrialError::UnequalLengths { label: self.label, input, output });
        }
        self.covariates = covariates;
        Ok(self)
    }

    /// This trial with another input of the same length.
    #[must_use]
    pub(crate) fn with_input(self, input: Vec<f64>) -> Self {
        debug_assert_eq!(input.len(), self.input.len(), "one value for each sample");
        Self { input, ..self }
    }

    /// This trial with another output of the same length.
    #[must_use]
    pub(super) fn with_output(self, output: Vec<f64>) -> Self {
        debug_assert_eq!(output.len(), self.output.len(), "one value for each sample");
        Self { output, ..self }
    }

    /// This trial with samples that were filled in while nothing was logged, in order.
    #[must_use]
    pub(crate) fn with_unlogged(self, unlogged: Vec<Range<usize>>) -> Self {
        Self { unlogged, ..self }
    }

    /// Samples that were filled in while nothing was logged, in order: what the input was there is
    /// not known.
    pub(crate) fn unlogged(&self) -> &[Range<usize>] {
        &self.unlogged
    }

    /// The samples that were logged, in runs between those that were filled in.
    pub(crate) fn logged(&self) -> impl Iterator<Item = Range<usize>> {
        let starts = std::iter::once(0).chain(self.unlogged.iter().map(|gap| gap.end));
        let ends = self.unlogged.iter().map(|gap| gap.start).chain([self.len()]);
        starts.zip(ends).map(|(start, end)| start..end).filter(|run| !run.is_empty())
    }

    /// This trial with samples, in order, at which the output was not measured, but is interpolated: its
    /// sensor is slower than the input is logged.
    #[must_use]
    pub(super) fn with_interpolated(self, interpolated: Vec<Range<usize>>) -> Self {
        Self { interpolated, ..self }
    }

    /// Samples at which the output is interpolated, in order.
    pub(crate) fn interpolated(&self) -> &[Range<usize>] {
        &self.interpolated
    }

    /// The samples `from..to` by themselves, at their time; `None` where that is no trial.
    pub(crate) fn part(&self, from: usize, to: usize) -> Option<Self> {
        let (input, output) = (self.input().get(from..to)?, self.output().get(from..to)?);
        let start_s = self.time_s(from + 1);
        let part = Self::new(self.label(), start_s, self.period(), input.to_vec(), output.to_vec());
        Some(Self { origin_s: self.origin_s, ..part.ok()? })
    }

    /// The first `samples` of it; none where there would be no sample.
    #[must_use]
    pub(crate) fn beginning(&self, samples: usize) -> Option<Self> {
        let within = |ranges: &[Range<usize>]| {
            ranges.iter().filter(|range| range.end < samples).cloned().collect::<Vec<_>>()
        };
        let (unlogged, interpolated) = (within(&self.unlogged), within(&self.interpolated));
        let cut = self.with_each(|signal| signal.iter().copied().take(samples).collect());
        (samples > 0).then_some(Self { unlogged, interpolated, ..cut })
    }

    /// One of so many samples of it, from the first on.
    pub(crate) fn every(&self, stride: usize) -> Option<Self> {
        let period = SamplePeriod::from_seconds(stride as f64 * self.period.seconds())?;
        let kept = self.with_each(|signal| signal.iter().step_by(stride).copied().collect());
        Some(Self { period, ..kept })
    }

    /// With samples that are made of those of each signal.
    fn with_each(&self, of: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        Self {
            label: self.label.clone(),
            input: of(&self.input),
            output: of(&self.output),
            covariates: self.covariates.iter().map(|signal| of(signal)).collect(),
            unlogged: Vec::new(),
            interpolated: Vec::new(),
            ..*self
        }
    }

    /// The name of the trial that a part of these is of, where it was split: `a` of `a#2`.
    pub(super) fn whole_label(label: &str) -> &str {
        label.split_once('#').map_or(label, |(whole, _)| whole)
    }

    /// Name of the trial.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Seconds between samples.
    pub fn period(&self) -> SamplePeriod {
        self.period
    }

    /// What drove the joint, a value per sample.
    pub fn input(&self) -> &[f64] {
        &self.input
    }

    /// What the joint did, a value per sample.
    pub fn output(&self) -> &[f64] {
        &self.output
    }

    /// Further signals, in the order of [`Joint::covariates`](super::Joint::covariates).
    pub fn covariates(&self) -> &[Vec<f64>] {
        &self.covariates
    }

    /// Number of samples; never zero.
    #[expect(clippy::len_without_is_empty, reason = "a trial is never empty")]
    pub fn len(&self) -> usize {
        self.output.len()
    }

    /// What the clock of the log shows where times count from, in seconds: zero, but for a clock that
    /// counts from 1970 or the like the first second of the log.
    pub fn origin_s(&self) -> f64 {
        self.origin_s
    }

    /// Time of the sample with the 1-based number `sample` by the clock of the log, in seconds.
    pub fn logged_time_s(&self, sample: usize) -> f64 {
        self.origin_s + self.time_s(sample)
    }

    /// Time of the sample with the 1-based number `sample`, in seconds since the
    /// [origin](Self::origin_s).
    pub fn time_s(&self, sample: usize) -> f64 {
        self.start_s + (sample as f64 - 1.0) * self.period.seconds()
    }
}

/// The longest gap between two parts of a trial that was split, with a period to spare, to three
/// digits, in seconds.
pub(crate) fn longest_gap_s(trials: &[Trial]) -> Option<f64> {
    let gap = |pair: &[Trial]| {
        let [before, behind] = pair else { return None };
        let whole = Trial::whole_label(before.label());
        let are_of_one = whole != before.label() && whole == Trial::whole_label(behind.label());
        let gap = behind.time_s(1) - before.time_s(before.len());
        (are_of_one && gap > 0.0).then(|| gap + before.period().seconds())
    };
    trials.windows(2).filter_map(gap).max_by(f64::total_cmp).map(no_shorter)
}

/// A length of time to three digits, rounding left aside no shorter: who fills gaps up to it fills this one.
pub(super) fn no_shorter(seconds: f64) -> f64 {
    to_digits_by(seconds, 3, |digits| (digits * (1.0 - 1e-9)).ceil())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn period() -> SamplePeriod {
        SamplePeriod::from_seconds(0.01).unwrap()
    }

    #[test]
    fn a_trial_is_finite_and_rectangular() {
        let trial = |u: &[f64], y: &[f64]| Trial::new("a", 0.0, period(), u.to_vec(), y.to_vec());
        assert!(trial(&[1.0, 2.0], &[1.0, 2.0]).is_ok());
        assert!(matches!(trial(&[], &[]), Err(TrialError::Empty { .. })));
        assert!(matches!(trial(&[1.0], &[]), Err(TrialError::UnequalLengths { .. })));
        let not_finite = trial(&[1.0, 1.0], &[0.0, f64::NAN]);
        assert!(matches!(not_finite, Err(TrialError::NotFinite { sample: 2, .. })));
    }

    #[test]
    fn sample_one_is_the_start() {
        let trial = Trial::new("a", 2.5, period(), vec![0.0; 3], vec![0.0; 3]).unwrap();
        assert!((trial.time_s(1) - 2.5).abs() < 1e-15);
        assert!((trial.time_s(3) - 2.52).abs() < 1e-12);
    }
}
