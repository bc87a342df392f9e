//! What an input may be, and how well it must do.

/// What an input may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest magnitude of the input, input units.
    pub largest: f64,
    /// Shortest and longest hold in seconds; as the models suggest without.
    pub hold_s: Option<(f64, f64)>,
    /// Longest input that is tried, seconds.
    pub longest_s: f64,
    /// The power that is wanted, 0 to 1.
    pub power: f64,
    /// How often the experiment is rehearsed with either suspect, with noise.
    pub rehearsals: usize,
}

/// Of the failures that the power allows, the part that is not granted to rehearsals: a model
/// is not the joint. Chosen; `examples/statistics/design_power.rs` shows what designed inputs do then.
const RESERVE: f64 = 0.5;

impl Limits {
    /// Rehearsals that may fail.
    pub(super) fn failures(&self) -> usize {
        let allowed = RESERVE * (1.0 - self.power).max(0.0) * self.rehearsals as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
        let allowed = (allowed + 1e-9) as usize;
        allowed
    }
}
