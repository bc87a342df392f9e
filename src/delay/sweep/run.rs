//! A run of one combination of settings, and the values of a setting, over all steps.

use serde::Serialize;

use super::agreement::ReportedDelay;
use super::grid::Combination;
use super::step::{SweptStep, mean};
use crate::delay::{DelayTable, KindDelay, Settings, TrialEstimate, joint_steps};
use crate::experiment::Joint;
use crate::numerics::median;

/// What one run reports of all steps of a joint.
#[derive(Clone, Debug)]
pub struct RunDelays {
    /// A place for each step of all trials, in order.
    pub steps: Vec<Option<ReportedDelay>>,
    /// The lag after the dead time that it found, seconds.
    pub lag_s: Option<f64>,
    /// Whether the medians of its kinds of steps differ by more than is uncertain.
    pub kinds_differ: bool,
}

impl RunDelays {
    /// Collects what a run reports of `joint`; `None` stands for a trial that failed.
    pub fn of<'a>(
        joint: &'a Joint,
        estimates: impl IntoIterator<Item = Option<&'a TrialEstimate>> + Clone,
        settings: &Settings,
    ) -> Self {
        let trials = &joint.trials;
        let kinds = DelayTable::of(joint, estimates.clone()).kinds;
        let kinds_differ = KindDelay::differ(&kinds);
        let mut found = Self { steps: Vec::new(), lag_s: None, kinds_differ };
        let steps = joint_steps(trials, settings);
        for ((trial, steps), estimate) in trials.iter().zip(&steps).zip(estimates) {
            if let Some(estimate) = estimate {
                let (decisions, settings) =
                    (estimate.decisions.iter(), settings.at(trial.period()));
                let reported = decisions.map(|decision| ReportedDelay::of(decision, &settings));
                found.steps.extend(reported);
                let model = estimate.onset_model.as_deref();
                found.lag_s = found.lag_s.or_else(|| model?.lag_s());
            } else {
                found.steps.resize(found.steps.len() + steps.len(), None);
            }
        }
        found
    }
}

/// A run over all steps of a joint.
#[derive(Clone, Debug, Serialize)]
pub struct RunSummary {
    /// Steps that it accepted.
    pub accepted: usize,
    /// The median of its delays, seconds.
    #[serde(rename = "median_delay_s")]
    pub median_s: Option<f64>,
    /// Accepted steps of which it reports another delay than most.
    pub disagreements: usize,
    /// Of the steps that most agree on, the part where it agrees with them.
    pub agrees: Option<f64>,
    /// The lag after the dead time that it found, seconds.
    #[serde(rename = "lag_mean_s")]
    pub lag_s: Option<f64>,
}

/// All combinations with one value of a setting, over all steps of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelSummary {
    /// The part of the steps that is accepted.
    pub accepted: f64,
    /// The median of all delays, seconds.
    pub median_s: Option<f64>,
    /// The median distance from what most say, samples.
    pub shift_samples: Option<f64>,
    /// The part of the delays that disagrees with what most say.
    pub disagrees: Option<f64>,
}

impl RunSummary {
    pub(super) fn of(steps: &[SweptStep], run: usize, lag_s: Option<f64>) -> Self {
        let reported = |step: &SweptStep| step.delays.get(run).copied().flatten();
        let delays = steps.iter().filter_map(|step| Some(reported(step)?.delay * step.period_s));
        let delays: Vec<f64> = delays.collect();
        let disagrees = |step: &&SweptStep| {
            let agreed = step.agreement.zip(reported(step));
            agreed.is_some_and(|(agreement, reported)| !agreement.holds(&reported))
        };
        let agrees = steps.iter().filter_map(|step| {
            let agreement = step.majority()?;
            Some(f64::from(u8::from(
                reported(step).is_some_and(|reported| agreement.holds(&reported)),
            )))
        });
        Self {
            accepted: delays.len(),
            median_s: median(&delays),
            disagreements: steps.iter().filter(disagrees).count(),
            agrees: mean(agrees),
            lag_s,
        }
    }
}

impl LevelSummary {
    pub(super) fn of<'a>(
        steps: &[&SweptStep],
        combinations: impl Iterator<Item = &'a Combination>,
        ran: &[bool],
    ) -> Self {
        let (mut tried, mut delays, mut shifts, mut outside) = (0, Vec::new(), Vec::new(), 0);
        for one in combinations.filter(|one| ran.get(one.run) == Some(&true)) {
            tried += steps.iter().filter(|step| step.accepted > 0).count();
            for step in steps {
                let Some((reported, agreed)) = step.reported(one).zip(step.agreement) else {
                    continue;
                };
                delays.push(reported.delay * step.period_s);
                shifts.push(reported.delay - agreed.delay);
                outside += usize::from(!agreed.holds(&reported));
            }
        }
        let count = delays.len() as f64;
        Self {
            accepted: if tried > 0 { count / tried as f64 } else { 0.0 },
            median_s: median(&delays),
            shift_samples: median(&shifts),
            disagrees: (count > 0.0).then(|| outside as f64 / count),
        }
    }
}
