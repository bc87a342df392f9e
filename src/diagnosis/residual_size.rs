//! How large a residual is: beside the noise, and beside itself on data not fitted to.

use serde::Serialize;

use crate::fit::{Evaluation, FitRecord, Part};
use crate::numerics::{fisher_tail, robust_scale};

/// A residual so many times the noise of the measurement is no noise, however well it
/// would pass for one that changes slowly.
pub(crate) const BEYOND_NOISE: f64 = 3.0;

/// A residual no more than so many times the noise is negligible, however significant.
pub(crate) const NEAR_NOISE: f64 = 1.15;

/// What shows that a model lacks something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ShownBy {
    /// Shapes that missing effects have explain more than noise would.
    Shapes,
    /// The residual is far beyond the noise of the measurement.
    Size,
    /// The residual is larger on the part that was not fitted.
    UnseenPart,
    /// The residual stands out in a few windows.
    FewWindows,
}

/// What the size of a residual says of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SizeVerdict {
    /// It is negligible.
    Noise,
    /// It is no noise.
    Misfit(ShownBy),
}

/// The root mean square residual on both parts of a record.
#[derive(Clone, Copy, Debug, Default)]
pub struct ResidualSize {
    /// Over the noise of the measurement, on the part that was fitted; `None` where the
    /// noise is not known.
    pub times_noise: Option<f64>,
    /// On the part that was not fitted, over that on the part that was.
    pub times_training: Option<f64>,
    /// Samples that were fitted, and that were not.
    samples: (usize, usize),
}

impl ResidualSize {
    /// The size of the residual of `evaluation`, with the noise `floor`.
    pub(crate) fn of(record: &FitRecord<'_>, evaluation: &Evaluation, floor: Option<f64>) -> Self {
        let part = |part| record.cut(&evaluation.residuals, part);
        let (training, validation) = (part(Part::Training), part(Part::Validation));
        let size = |windows: &[Vec<f64>]| without_spikes(windows);
        let ratio = |above: Option<f64>, below: Option<f64>| {
            above.zip(below).map(|(a, b)| a / b).filter(|ratio| ratio.is_finite())
        };
        let count = |windows: &[Vec<f64>]| windows.iter().map(Vec::len).sum();
        Self {
            times_noise: ratio(size(&training), floor),
            times_training: ratio(size(&validation), size(&training)),
            samples: (count(&training), count(&validation)),
        }
    }

    /// What it says by itself; `None` where it may be noise or not.
    pub(super) fn verdict(&self) -> Option<SizeVerdict> {
        match self.times_noise {
            Some(times) if times > BEYOND_NOISE => Some(SizeVerdict::Misfit(ShownBy::Size)),
            Some(times) if self.is_larger_unseen() && times > 0.0 => {
                Some(SizeVerdict::Misfit(ShownBy::UnseenPart))
            }
            Some(times) if times <= NEAR_NOISE => Some(SizeVerdict::Noise),
            _ => None,
        }
    }

    /// Whether the residual of the part that was not fitted is beyond the noise, and larger
    /// than that of the part that was.
    ///
    /// Noise is as large on both. A variance is Fisher's, of fewer samples than there are
    /// where noise has a memory: of `n (1 − ρ²) / (1 + ρ²)` at first order.
    fn is_larger_unseen(&self) -> bool {
        /// Probability of calling noise a misfit.
        const SIGNIFICANCE: f64 = 0.001;
        let Some((noise, training)) = self.times_noise.zip(self.times_training) else {
            return false;
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let freedom = |samples: usize| independent(samples) as usize;
        let (fitted, unseen) = (freedom(self.samples.0), freedom(self.samples.1));
        // The ratio of two variances of independent noise.
        let p_value = fisher_tail(training * training, unseen, fitted);
        noise * training > NEAR_NOISE && p_value.is_some_and(|p| p < SIGNIFICANCE)
    }
}

/// As many independent values as there are in `samples` of a noise with the longest memory:
/// `n (1 − ρ²) / (1 + ρ²)` for a variance, at first order.
pub(super) fn independent(samples: usize) -> f64 {
    /// The longest memory that noise is held to have.
    const RHO: f64 = 0.95;
    samples as f64 * (1.0 - RHO * RHO) / (1.0 + RHO * RHO)
}

/// Root mean square of residuals, without their spikes.
fn without_spikes(windows: &[Vec<f64>]) -> Option<f64> {
    let clipped = clipped(windows);
    let values = || clipped.iter().flatten();
    let count = values().count();
    (count > 0).then(|| (values().map(|r| r * r).sum::<f64>() / count as f64).sqrt())
}

/// Residuals whose spikes are as if they were just there: a sensor's say nothing of the
/// model. Up to two samples beside one another beyond six robust standard deviations are one.
pub(super) fn clipped(windows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    const SPIKE: f64 = 6.0;
    const LONGEST: usize = 2;
    let distances: Vec<f64> = windows.iter().flatten().map(|r| r.abs()).collect();
    // A spike must not widen the limit that it is measured by.
    let limit = SPIKE * robust_scale(&distances);
    let clip = |window: &Vec<f64>| -> Vec<f64> {
        let runs = window.chunk_by(|a, b| (a.abs() > limit) == (b.abs() > limit));
        let most = |run: &[f64]| if run.len() > LONGEST { f64::INFINITY } else { limit };
        runs.flat_map(|run| run.iter().map(move |r| r.clamp(-most(run), most(run)))).collect()
    };
    windows.iter().map(clip).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::testing::noise;

    #[test]
    fn a_spike_counts_little_and_a_burst_in_full() {
        let calm: Vec<f64> = (0..1000).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let mut spiked = calm.clone();
        spiked[500..502].fill(100.0);
        let mut burst = calm.clone();
        burst[500..510].fill(100.0);
        let size = |residuals| without_spikes(&[residuals]).unwrap();
        assert!((size(calm) - 1.0).abs() < 1e-12);
        assert!(size(spiked) < 1.1 && size(burst) > 9.0);
    }

    /// Noise of first order in training, and so many times it in validation.
    fn size(rho: f64, seed: u64, times: f64) -> ResidualSize {
        let values = noise(seed, rho, 12_000);
        let rmse = |values: &[f64]| {
            (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
        };
        let (training, validation) = values.split_at(8400);
        ResidualSize {
            times_noise: Some(2.0),
            times_training: Some(times * rmse(validation) / rmse(training)),
            samples: (8400, 3600),
        }
    }

    #[test]
    fn noise_is_as_large_where_it_was_not_fitted() {
        for rho in [0.0, 0.5, 0.95] {
            let found = (0..200).filter(|seed| size(rho, *seed, 1.0).is_larger_unseen()).count();
            assert!(found <= 4, "{found} of 200 at {rho}");
        }
    }

    #[test]
    fn what_is_larger_there_is_no_noise() {
        let unseen = Some(SizeVerdict::Misfit(ShownBy::UnseenPart));
        assert!((0..20).all(|seed| size(0.95, seed, 1.6).verdict() == unseen));
        // Near the noise it does not matter.
        let near = ResidualSize { times_noise: Some(0.7), ..size(0.0, 1, 1.6) };
        assert_eq!(near.verdict(), Some(SizeVerdict::Noise));
    }
}
