//! Noise for the tests of the diagnosis.

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

/// Normal noise of first order with variance 1.
pub(crate) fn noise(seed: u64, rho: f64, count: usize) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut value = 0.0;
    let mut next = || {
        let e: f64 = StandardNormal.sample(&mut random);
        value = rho * value + (1.0 - rho * rho).sqrt() * e;
        value
    };
    (0..count + 200).map(|_| next()).skip(200).collect()
}
