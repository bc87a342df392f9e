//! What is asked of random steps, and the result.

use super::predict::Prediction;
use super::schedule::Schedule;

/// What is asked of random steps; what is left open suits the joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanRequest {
    /// The levels, as differences to rest.
    pub levels: Option<Vec<f64>>,
    /// The largest magnitude of a level.
    pub largest: Option<f64>,
    /// Shortest and longest hold, seconds.
    pub hold_s: Option<(f64, f64)>,
    /// Length of all trials together, seconds.
    pub duration_s: Option<f64>,
    /// Most trials; as many as the range needs where none are given.
    pub trials: Option<usize>,
    /// Where random numbers come from.
    pub seed: u64,
}

/// Random steps, and what is expected of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The input.
    pub schedule: Schedule,
    /// What the joint will do, where a model says so.
    pub prediction: Option<Prediction>,
    /// Shortest and longest hold that were asked for, seconds.
    pub hold_s: (f64, f64),
    /// The largest magnitude of a level.
    pub largest: f64,
    /// Levels that a wider range would allow.
    pub left_out: Vec<f64>,
    /// The length that a surer prediction would allow, seconds, where this one is shorter.
    pub shortened_from_s: Option<f64>,
    /// How far the joint may be from its start when a trial begins, output units, where a range is
    /// kept by what a log shows.
    pub start_tolerance: Option<f64>,
}

impl Plan {
    /// `schedule` with holds of `hold_s`.
    pub(super) fn new(
        schedule: Schedule,
        prediction: Option<Prediction>,
        hold_s: (f64, f64),
    ) -> Self {
        let largest = schedule.levels().iter().fold(0.0, |most: f64, level| most.max(level.abs()));
        Self {
            schedule,
            prediction,
            hold_s,
            largest,
            left_out: Vec::new(),
            shortened_from_s: None,
            start_tolerance: None,
        }
    }

    /// This plan, where `all` levels would be played in a wide range.
    #[must_use]
    pub(super) fn leaving_out(self, all: &[f64]) -> Self {
        let played = self.schedule.levels();
        let left_out = all.iter().copied().filter(|level| !played.contains(level)).collect();
        Self { left_out, ..self }
    }
}
