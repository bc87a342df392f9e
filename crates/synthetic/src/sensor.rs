//! What the log shows of the angle: noise, then the steps of an encoder.

use rand::{Rng, RngExt as _};
use rand_distr::{Distribution as _, StandardNormal};

use crate::spec::{JointSpec, Spikes};

/// The measured output of `joint` for each of its `angles`.
///
/// ```text
/// e_1 = σ w_1,  e_k = φ e_(k-1) + σ sqrt(1 - φ²) w_k      w: standard normal
/// y_k = resolution × round((angle_k + e_k) / resolution)
/// ```
///
/// with σ the `noise` and φ the `noise_correlation`: σ is the standard deviation of
/// the noise, whatever φ is.
pub(crate) fn measure(joint: &JointSpec, angles: Vec<f64>, rng: &mut impl Rng) -> Vec<f64> {
    let phi = joint.noise_correlation;
    let (mut keep, mut fresh) = (0.0, 1.0);
    let mut noise = 0.0;
    let noisy = angles.into_iter().map(|angle| {
        let drawn: f64 = StandardNormal.sample(rng);
        noise = keep * noise + fresh * joint.noise * drawn;
        (keep, fresh) = (phi, (1.0 - phi * phi).sqrt());
        quantised(angle + noise, joint.resolution)
    });
    noisy.collect()
}

/// Puts the spikes of `joint` on its measured `output`.
pub(crate) fn spike(joint: &JointSpec, output: &mut [f64], rng: &mut impl Rng) {
    let Some(Spikes { share, size }) = joint.spikes else { return };
    for value in output {
        let [chance, side]: [f64; 2] = rng.random();
        if chance < share {
            *value += if side < 0.5 { size } else { -size };
        }
    }
}

fn quantised(value: f64, resolution: Option<f64>) -> f64 {
    resolution.map_or(value, |step| (value / step).round() * step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, stream};
    use crate::{DelayLaw, InputSpec};

    const SAMPLES: usize = 40_000;

    /// What `noise` and `noise_correlation` make of an angle of zero.
    fn noise_of(noise: f64, noise_correlation: f64) -> Vec<f64> {
        let input = InputSpec::Steps { steps: Vec::new(), initial: 0.0 };
        let law = DelayLaw::Constant { seconds: 0.0 };
        let joint = JointSpec { noise, noise_correlation, ..JointSpec::new("a", input, law) };
        measure(&joint, vec![0.0; SAMPLES], &mut stream(7, 0, Purpose::Noise))
    }

    /// Standard deviation, and correlation of neighbours.
    fn moments(values: &[f64]) -> (f64, f64) {
        let power: f64 = values.iter().map(|v| v * v).sum();
        let product: f64 = values.windows(2).map(|w| w[0] * w[1]).sum();
        ((power / values.len() as f64).sqrt(), product / power)
    }

    #[test]
    fn white_noise_has_its_deviation_and_no_correlation() {
        let (deviation, correlation) = moments(&noise_of(0.05, 0.0));
        // Standard errors at 40 000 samples: 0.35 % and 0.005; four of each.
        assert!((deviation / 0.05 - 1.0).abs() < 0.014, "deviation {deviation}");
        assert!(correlation.abs() < 0.02, "correlation {correlation}");
    }

    #[test]
    fn correlated_noise_keeps_its_deviation() {
        let (deviation, correlation) = moments(&noise_of(0.05, 0.8));
        // Standard errors: 0.35 % × sqrt((1 + φ²) / (1 - φ²)) = 0.75 %, and 0.003.
        assert!((deviation / 0.05 - 1.0).abs() < 0.03, "deviation {deviation}");
        assert!((correlation - 0.8).abs() < 0.012, "correlation {correlation}");
    }

    #[test]
    fn an_encoder_shows_its_own_steps() {
        assert!((quantised(1.26, Some(0.1)) - 1.3).abs() < 1e-12);
        assert!((quantised(1.26, None) - 1.26).abs() < 1e-12);
    }
}
