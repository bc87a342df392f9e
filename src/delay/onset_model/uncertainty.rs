//! What an onset's interval is made of.
//!
//! - *Its own error.* Positions whose squared error is within `σ² t²` of the least, with `σ²` from
//!   the window and from all windows of the joint, and `t` Student's quantile.
//! - *The memory of what is left*, and *its pattern*: see [`super::residual`].
//! - *The shared parameters*, by the delta method.
//! - *The choice of the shape.* Other shapes count by `e^(−ΔA/θ)`, with `ΔA` half the difference of
//!   their criteria by Akaike and `θ` the memory, by which the samples are fewer than they look.
//!
//! The last two move all onsets of a joint together.
//!
//! # References
//! K. P. Burnham and D. R. Anderson, "Model Selection and Multimodel Inference", 2002 (weights of
//! models by Akaike's criterion).

use super::search::{Candidate, Search};
use super::shape::Shape;

/// The shape that was chosen among some.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    pub(super) shape: Shape,
    /// By how much the variance of all onsets grows because its parameters are not known.
    variance: f64,
    /// Criteria and typical delays of all of them, the best one first.
    among: Vec<(f64, f64)>,
    /// By how much another shape that may be the right one moves all onsets, samples.
    apart: f64,
}

impl Choice {
    /// Of the `candidates` of a search, the best one first.
    pub(super) fn of(search: &Search, candidates: &[Candidate]) -> Option<Self> {
        let chosen = candidates.first()?;
        let among = candidates.iter().map(|it| (search.akaike(it), it.typical)).collect();
        let (shape, variance) = (chosen.shape, search.shared_variance(chosen));
        Some(Self { shape, variance, among, apart: 0.0 })
    }

    /// This choice where another shape may be the right one.
    pub(super) fn or_behind(mut self, other: Shape, search: &Search, chosen: &Candidate) -> Self {
        let later = chosen.shape.mean() - other.mean();
        let onsets = chosen.onsets.iter().map(|of_run| of_run.later(later)).collect();
        let behind = search.evaluate(other, onsets, chosen.typical + later, 2);
        self.apart = behind.typical - chosen.typical;
        self
    }

    /// The standard deviation by which all onsets may be moved together, samples: by the parameters of
    /// the shape, and by its choice, the others being weighted as their criteria say.
    pub(super) fn deviation(&self, memory: f64) -> f64 {
        let Some((best, chosen)) = self.among.first() else { return 0.0 };
        let weighted = self.among.iter().map(|(score, typical)| {
            let weight = (-(score - best) / memory).exp();
            (weight, weight * (typical - chosen).powi(2))
        });
        let known = weighted.filter(|(_, square)| square.is_finite());
        let (sum, squares) = known.fold((0.0, 0.0), |(a, b), (w, s)| (a + w, b + s));
        let choice = if sum > 0.0 { squares / sum } else { 0.0 };
        // Two standard deviations reach there.
        (self.variance * memory + choice + (self.apart / 2.0).powi(2)).sqrt()
    }
}
