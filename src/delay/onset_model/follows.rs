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
//! is explained says whether they follow the input. An output that follows nothing has as good
//! onsets, of other sizes. The weight `w` of a size is as well as it is known, at most what is usual:
//! of onsets that are near each other only the sum of their sizes is.

use super::windows::{Onsets, Run, all};
use crate::numerics::{Regression, dot, fisher_tail, median};

/// Steps from which something can be said.
const FEWEST: usize = 6;

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

    pub(super) fn of(runs: &[Run], onsets: &[Onsets]) -> Self {
        let known = all(runs, onsets).map(|(.., onset)| onset.information);
        let usual = median(&known.collect::<Vec<f64>>()).unwrap_or(1.0).max(f64::MIN_POSITIVE);
        // Each times the root of its weight.
        let (mut sizes, mut above, mut below) = (Vec::new(), Vec::new(), Vec::new());
        for (run, index, onset) in all(runs, onsets) {
            let step = run.steps[index];
            if step.rests {
                continue;
            }
            let root = (onset.information / usual).min(1.0).sqrt();
            sizes.push(root * onset.size);
            above.push(root * (step.after.max(0.0) - step.before.max(0.0)));
            below.push(root * (step.after.min(0.0) - step.before.min(0.0)));
        }
        let (sizes, steps) = ([sizes], above.len());
        let error = Regression::of(&sizes, &[&vec![above], &vec![below]]).error;
        let total = dot(&sizes[0], &sizes[0]);
        let r2 = ((total - error) / total.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let freedom = steps.saturating_sub(Self::GAINS);
        let ratio = r2 / Self::GAINS as f64 * freedom as f64 / (1.0 - r2).max(f64::EPSILON);
        let p_value = fisher_tail(ratio, Self::GAINS, freedom).filter(|_| freedom > 0);
        Self { r2, p_value: p_value.unwrap_or(1.0), steps }
    }

    /// Whether the onsets answer something else: their sizes are hardly explained, or no better than
    /// by chance.
    ///
    /// Over 400 simulated records of joints that follow, none is taken for one that doesn't; of 200
    /// outputs of other joints, random walks, sines, drifts and noise two are not noticed.
    pub(super) fn is_unrelated(&self) -> bool {
        /// Of records with few steps nearly all must be explained, of others the more of it that
        /// chance explains so much once in ten thousand.
        const NEARLY_ALL: f64 = 0.95;
        const PLAIN: f64 = 0.7;
        const CHANCE: f64 = 1e-4;
        let follows = self.r2 >= NEARLY_ALL || (self.r2 >= PLAIN && self.p_value <= CHANCE);
        self.steps >= FEWEST && !follows
    }

    /// Whether so much is explained by chance: of an output that comes to rest where its input says,
    /// whose sizes need not go with its steps in parts.
    ///
    /// Chosen: the usual 1 %. Of 100 simulated servos that come to rest the least plain have 0.4 %, of
    /// 15 sines that seem to 14 have more than 4 %.
    pub(super) fn is_chance(&self) -> bool {
        const CHANCE: f64 = 0.01;
        self.steps >= FEWEST && self.p_value > CHANCE
    }
}
