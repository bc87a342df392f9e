//! The experiment that would separate two effects.
//!
//! Two fitted models are simulated on a number of inputs that suit the record: levels near
//! the fitted thresholds, below the smallest and up to the largest level, in ladders, pulses
//! and reversals, with short and long holds, at several angles. The input is proposed that
//! brings the most evidence per second of experiment.

mod candidates;
mod contrast;
mod levels;
mod space;

pub(super) use candidates::separate;
pub(crate) use levels::{level_sets, thresholds, two_digits};
