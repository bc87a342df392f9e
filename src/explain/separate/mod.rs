//! The experiment that would tell two effects apart.
//!
//! Two fitted models are simulated on a number of inputs that suit the record: levels about
//! the fitted thresholds, below the smallest and up to the largest level, in ladders, pulses
//! and reversals, with short and long holds, at several angles. The input is proposed that
//! brings the most evidence per second of experiment.

mod levels;
mod proposal;
mod setting;

use super::Workers;
use super::candidate::Candidate;
use crate::fit::FitRecord;

pub(crate) use levels::{level_sets, thresholds, two_digits};
pub use proposal::{Pattern, Proposal, Start};
use setting::Setting;

/// What would tell two effects apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Separation {
    /// Id of the other effect.
    pub other: &'static str,
    /// The best experiment of those that were tried.
    pub proposal: Proposal,
    /// The largest difference between the outputs of the two models in it, in times the
    /// noise of the measurement.
    pub times_noise: f64,
    /// Seconds from the start of a run to that.
    pub after_s: f64,
    /// Whether a change of gain and of starts would leave so much of the difference that the
    /// two are told apart.
    pub is_clear: bool,
}

/// Tells each candidate that is worth a name by what it is told from those it cannot be
/// told from.
pub(super) fn separate(record: &FitRecord<'_>, ranking: &mut [Candidate], workers: &impl Workers) {
    let place = |id: &str| ranking.iter().position(|c| c.effects == [id]);
    let of_one = |(one, candidate): (usize, &Candidate)| {
        let worthy = candidate.is_significant();
        let others = candidate.indistinguishable_from.iter().filter_map(|id| place(id));
        others.filter(move |_| worthy).map(move |other| (one, other)).collect::<Vec<_>>()
    };
    let pairs: Vec<_> = ranking.iter().enumerate().flat_map(of_one).collect();
    let setting = Setting::of(record);
    let apart = |(one, other): &(usize, usize)| {
        Some((*one, setting.apart(ranking.get(*one)?, ranking.get(*other)?)?))
    };
    let found = workers.map(&pairs, apart);
    for (one, separation) in found.into_iter().flatten() {
        if let Some(candidate) = ranking.get_mut(one) {
            candidate.separated_by.push(separation);
        }
    }
}
