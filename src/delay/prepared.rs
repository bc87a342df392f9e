//! A trial as a method sees it: its steps, and its output smoothed as asked.

use super::input_motion::InputKind;
use super::motion::{StepMotion, motions};
use super::settings::Settings;
use super::steps::{InputStep, trial_steps};
use crate::experiment::Trial;
use crate::numerics::{FilterError, LowPass};
use crate::units::SamplePeriod;

/// A trial as a method sees it.
pub(super) struct Prepared<'a> {
    pub(super) raw: &'a [f64],
    pub(super) smoothed: Option<Vec<f64>>,
    pub(super) period: SamplePeriod,
    pub(super) steps: Vec<InputStep>,
    /// What the output does about each step, where rest or a stop is shown.
    pub(super) motions: Vec<Option<StepMotion>>,
    /// Whether the output comes to rest where the input says.
    pub(super) tracks: bool,
}

impl<'a> Prepared<'a> {
    pub(super) fn of(trial: &'a Trial, settings: &Settings) -> Result<Self, FilterError> {
        let smooth = |filter: LowPass| filter.smooth(trial.output(), trial.period());
        let smoothed = settings.low_pass_at(trial.period()).map(smooth).transpose()?;
        let steps = match settings.input {
            InputKind::Continuous => Vec::new(),
            InputKind::Auto | InputKind::Steps => trial_steps(trial, settings),
        };
        let (raw, period) = (trial.output(), trial.period());
        let motions = motions(raw, &steps, period, &settings.at(period));
        Ok(Self { raw, smoothed, period, steps, motions, tracks: false })
    }

    /// What the method is to look at.
    pub(super) fn output(&self) -> &[f64] {
        self.smoothed.as_deref().unwrap_or(self.raw)
    }
}
