//! Independent random numbers for each purpose.

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

/// What random numbers are drawn for: the number of their stream.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Purpose {
    /// Levels and holds.
    Input,
    /// Delays.
    Delay,
    /// Noise of the sensor.
    Noise,
    /// Spikes of the sensor.
    Spikes,
    /// What a scenario hides.
    Scenario,
}

/// The random numbers of joint number `joint`, from 0, for one purpose.
///
/// Key and stream are set bit by bit, so that they mean the same on every platform.
pub(crate) fn stream(seed: u64, joint: usize, purpose: Purpose) -> ChaCha8Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&(joint as u64).to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(purpose as u64);
    rng
}

#[cfg(test)]
mod tests {
    use rand::Rng as _;

    use super::*;

    #[test]
    fn seed_joint_and_purpose_each_give_other_numbers() {
        let draw = |seed, joint, purpose| stream(seed, joint, purpose).next_u64();
        let base = draw(1, 0, Purpose::Input);
        assert_eq!(base, draw(1, 0, Purpose::Input));
        for other in [draw(2, 0, Purpose::Input), draw(1, 1, Purpose::Input)] {
            assert_ne!(base, other);
        }
        for other in [draw(1, 0, Purpose::Delay), draw(1, 0, Purpose::Noise)] {
            assert_ne!(base, other);
        }
    }
}
