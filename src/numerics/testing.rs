//! Noise for tests.

use rand::{Rng as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

/// Normal noise of first order with variance 1.
pub(crate) fn noise(seed: u64, rho: f64, count: usize) -> Vec<f64> {
    let mut normal = normals(seed);
    let mut value = 0.0;
    let mut next = || {
        value = rho * value + (1.0 - rho * rho).sqrt() * normal();
        value
    };
    (0..count + 200).map(|_| next()).skip(200).collect()
}

/// Normal numbers with variance 1.
pub(crate) fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move || StandardNormal.sample(&mut random)
}

/// Numbers that are spread evenly between −½ and ½.
pub(crate) fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    move || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5
}
