//! Whether the output follows its input at all: sizes of onsets against the steps of the input.
//!
//! An onset changes the speed by `a_i`, and a joint's speed is a curve of its delayed input. With a
//! line for each sign of the input the curve is
//!
//! ```text
//! a_i = g₊ (max(u_i, 0) − max(u_(i−1), 0)) + g₋ (min(u_i, 0) − min(u_(i−1), 0)) + e_i
//! ```
//!
//! Onsets are found one by one, whatever the sizes of their steps, so that the part of `Σ w a²` that
//! is explained says whether they answer the input. An output that answers nothing has as good
//! onsets, of other sizes. The weight `w` of a size is as well as it is known, at most what is usual:
//! of onsets that are near each other only the sum of their sizes is.

use super::windows::{Onset, Run};
use crate::numerics::{fisher_tail, median};

/// What a step of the input changes on each side of zero, and the size of its onset, both times the root
/// of the weight.
type Row = ([f64; 2], f64);

/// How far the sizes of onsets go with the steps of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Follows {
    /// The part of `Σ a²` that is explained.
    pub(super) r2: f64,
    /// How often sizes that have nothing to do with the input show as much.
    pub(super) p_value: f64,
    /// Onsets.
    pub(super) steps: usize,
}

impl Follows {
    /// Gains.
    const GAINS: usize = 2;

    pub(super) fn of(runs: &[Run], found: &[Vec<Option<Onset>>]) -> Self {
        let onsets = runs.iter().zip(found).flat_map(|(run, found)| run.steps.iter().zip(found));
        let known = found.iter().flatten().flatten().map(|onset| onset.information);
        let usual = median(&known.collect::<Vec<f64>>()).unwrap_or(1.0).max(f64::MIN_POSITIVE);
        let rows: Vec<Row> = onsets
            .filter(|(step, _)| !step.rests)
            .filter_map(|(step, found)| {
                let onset = found.as_ref()?;
                let root = (onset.information / usual).min(1.0).sqrt();
                let part = |of: fn(f64) -> f64| root * (of(step.after) - of(step.before));
                Some(([part(|u| u.max(0.0)), part(|u| u.min(0.0))], root * onset.size))
            })
            .collect();
        let sum = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).sum::<f64>();
        let total = sum(&|(_, a)| a * a);
        let [aa, ab, bb] = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| sum(&|(x, _)| x[i] * x[j]));
        let [ay, by] = [0, 1].map(|i| sum(&|(x, a)| x[i] * a));
        let det = aa * bb - ab * ab;
        let explained = if det > 1e-9 * aa * bb {
            (ay * (bb * ay - ab * by) + by * (aa * by - ab * ay)) / det
        } else if aa > 0.0 {
            ay * ay / aa
        } else {
            by * by / bb.max(f64::MIN_POSITIVE)
        };
        let r2 = (explained / total.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let freedom = rows.len().saturating_sub(Self::GAINS);
        let ratio = r2 / Self::GAINS as f64 * freedom as f64 / (1.0 - r2).max(f64::EPSILON);
        let p_value = fisher_tail(ratio, Self::GAINS, freedom).filter(|_| freedom > 0);
        Self { r2, p_value: p_value.unwrap_or(1.0), steps: rows.len() }
    }

    /// Whether the onsets answer something else: their sizes are hardly explained, or no better than
    /// by chance.
    ///
    /// Over 400 simulated records of joints that follow, none is taken for one that doesn't; of 200
    /// outputs of other joints, random walks, sines, drifts and noise two are not noticed.
    pub(super) fn is_unrelated(&self) -> bool {
        /// Steps from which something can be said.
        const FEWEST: usize = 6;
        /// Of records with few steps nearly all must be explained, of others the more of it that
        /// chance explains so much once in ten thousand.
        const NEARLY_ALL: f64 = 0.95;
        const PLAIN: f64 = 0.7;
        const CHANCE: f64 = 1e-4;
        let follows = self.r2 >= NEARLY_ALL || (self.r2 >= PLAIN && self.p_value <= CHANCE);
        self.steps >= FEWEST && !follows
    }
}
