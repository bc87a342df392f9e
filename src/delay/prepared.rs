//! A trial as a method sees it: its steps, and its output smoothed as asked.

use std::borrow::Cow;
use std::ops::Range;

use super::input_motion::InputKind;
use super::motion::{StepMotion, motions};
use super::settings::Settings;
use super::steps::{InputStep, trial_steps};
use crate::experiment::{Trial, without_spikes};
use crate::numerics::{FilterError, LowPass};
use crate::units::SamplePeriod;

/// A trial as a method sees it.
pub(super) struct Prepared<'a> {
    /// The output as it was measured, without isolated spikes of the sensor; with those in
    /// `mended` where there are any.
    pub(super) raw: Cow<'a, [f64]>,
    /// Samples that are not as in `raw`, in their order: their indices and their values.
    mended: Vec<(usize, f64)>,
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
        let smooth = |filter: LowPass| filter.smooth(&raw, trial.period());
        let smoothed = settings.low_pass_at(trial.period()).map(smooth).transpose()?;
        let steps = match settings.input {
            InputKind::Continuous => Vec::new(),
            InputKind::Auto | InputKind::Steps => trial_steps(trial, settings),
        };
        let period = trial.period();
        let motions = motions(&raw, &steps, period, &settings.at(period));
        let (mended, unlogged) = (Vec::new(), trial.unlogged());
        Ok(Self { raw, mended, smoothed, period, steps, unlogged, motions, is_tested: false })
    }

    /// A trial prepared in less memory where its output is smoothed: of what was mended, the
    /// samples alone.
    pub(super) fn lean(trial: &'a Trial, settings: &Settings) -> Result<Self, FilterError> {
        let Some(filter) = settings.low_pass_at(trial.period()) else {
            return Self::of(trial, settings);
        };
        // What does not fit is not found out after the work.
        filter.reach(trial.period())?;
        let mut prepared = Self::of(trial, &Settings { low_pass: None, ..settings.clone() })?;
        let raw = std::mem::replace(&mut prepared.raw, Cow::Borrowed(trial.output()));
        let raw = match raw {
            Cow::Borrowed(raw) => raw.to_vec(),
            Cow::Owned(raw) => {
                let pairs = raw.iter().zip(trial.output()).enumerate();
                let differ = pairs.filter(|(_, (now, was))| now.to_bits() != was.to_bits());
                prepared.mended = differ.map(|(index, (now, _))| (index, *now)).collect();
                raw
            }
        };
        prepared.smoothed = Some(filter.smooth_in_place(raw, trial.period())?);
        Ok(prepared)
    }

    /// The `trials` that can be prepared.
    pub(super) fn all(trials: &'a [Trial], settings: &Settings) -> Vec<Self> {
        trials.iter().filter_map(|trial| Self::of(trial, settings).ok()).collect()
    }

    /// What was measured over `range`, without spikes.
    pub(super) fn measured(&self, range: Range<usize>) -> Cow<'_, [f64]> {
        let values = self.raw.get(range.clone()).unwrap_or_default();
        let from = self.mended.partition_point(|(index, _)| *index < range.start);
        let mended = self.mended[from..].iter().take_while(|(index, _)| *index < range.end);
        let mut values = Cow::Borrowed(values);
        for (index, value) in mended {
            values.to_mut()[index - range.start] = *value;
        }
        values
    }

    /// What the method is to look at.
    pub(super) fn output(&self) -> &[f64] {
        self.smoothed.as_deref().unwrap_or(&self.raw)
    }
}
