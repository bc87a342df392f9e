//! Autoregressions from autocovariances.

/// Coefficients `a` of `e_k = Σ a_i e_(k−i) + white noise` with these autocovariances,
/// estimated from so many samples; the order minimises Schwarz's criterion
/// `n ln σ² + p ln n`. Empty for white noise.
///
/// # References
/// J. Durbin, "The fitting of time-series models", 1960 (the recursion over orders).
/// G. Schwarz, "Estimating the dimension of a model", 1978.
pub(crate) fn autoregression(covariances: &[f64], samples: usize) -> Vec<f64> {
    let Some(&power) = covariances.first().filter(|power| **power > 0.0) else {
        return Vec::new();
    };
    let (mut current, mut variance): (Vec<f64>, f64) = (Vec::new(), power);
    let score = |variance: f64, order: usize| {
        samples as f64 * variance.ln() + order as f64 * (samples as f64).ln()
    };
    let mut best = (score(power, 0), Vec::new());
    for order in 1..covariances.len() {
        // Partial autocorrelation: φ_pp = (γ_p − Σ φ_(p−1,i) γ_(p−i)) / σ²_(p−1).
        let known = covariances[1..order].iter().rev();
        let predicted: f64 = current.iter().zip(known).map(|(a, c)| a * c).sum();
        let reflection = (covariances[order] - predicted) / variance;
        // φ_pi = φ_(p−1,i) − φ_pp φ_(p−1,p−i).
        let reversed: Vec<f64> = current.iter().rev().copied().collect();
        for (a, b) in current.iter_mut().zip(reversed) {
            *a -= reflection * b;
        }
        current.push(reflection);
        // σ²_p = σ²_(p−1) (1 − φ_pp²).
        variance *= 1.0 - reflection * reflection;
        if variance <= 0.0 {
            break;
        }
        if score(variance, order) < best.0 {
            best = (score(variance, order), current.clone());
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::super::moments::autocovariances;
    use super::super::testing::noise;
    use super::*;

    #[test]
    fn the_memory_of_a_signal_is_found() {
        let signal = noise(1, 0.7, 20_000);
        let found = autoregression(&autocovariances(&[signal], 8), 20_000);
        assert!((found[0] - 0.7).abs() < 0.02, "{found:?}");
        let silent = autocovariances(&[vec![0.0; 50]], 5);
        assert!(autoregression(&silent, 50).is_empty());
    }
}
