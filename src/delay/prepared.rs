//! A trial as a method sees it: its steps, and its output smoothed as asked.

use std::borrow::Cow;
use std::ops::Range;

use super::input_motion::InputKind;
use super::motion::{StepMotion, motions};
use super::settings::Settings;
use super::steps::{InputStep, trial_steps};
use crate::experiment::{Trial, without_spikes};
use crate::numerics::FilterError;
use crate::units::SamplePeriod;

/// A trial as a method sees it.
pub(super) struct Prepared<'a> {
    /// The output as it was measured, without isolated spikes of the sensor.
    pub(super) raw: Cow<'a, [f64]>,
    pub(super) smoothed: Option<Vec<f64>>,
    pub(super) period: SamplePeriod,
    pub(super) steps: Vec<InputStep>,
    /// Samples that were filled in while nothing was logged, in order.
    pub(super) unlogged: &'a [Range<usize>],
    /// What the output does about each step, where rest or a stop is shown.
    pub(super) motions: Vec<Option<Box<StepMotion>>>,
    /// Whether the output comes to rest between steps, so that some of them change nothing: each
    /// reaction is then tested against noise.
    pub(super) is_tested: bool,
}

impl<'a> Prepared<'a> {
    pub(super) fn of(trial: &'a Trial, settings: &Settings) -> Result<Self, FilterError> {
        let mended = if settings.paper || settings.grows { None } else { without_spikes(trial) };
        let raw = mended.map_or(Cow::Borrowed(trial.output()), Cow::Owned);
        let period = trial.period();
        let low_pass = settings.low_pass_at(period);
        let smoothed = low_pass.map(|filter| filter.smooth(&raw, period)).transpose()?;
        let steps = match settings.input {
            InputKind::Continuous => Vec::new(),
            InputKind::Auto | InputKind::Steps => trial_steps(trial, settings),
        };
        let motions = motions(&raw, &steps, period, &settings.at(period));
        let unlogged = trial.unlogged();
        Ok(Self { raw, smoothed, period, steps, unlogged, motions, is_tested: false })
    }

    /// The `trials` that can be prepared.
    pub(super) fn all(trials: &'a [Trial], settings: &Settings) -> Vec<Self> {
        trials.iter().filter_map(|trial| Self::of(trial, settings).ok()).collect()
    }

    /// What the method is to look at.
    pub(super) fn output(&self) -> &[f64] {
        self.smoothed.as_deref().unwrap_or(&self.raw)
    }
}
