//! A joint's trials as a fit sees them: windows, restarts, residuals.

use crate::effect::RecordRange;
use crate::experiment::{Joint, Trial};
use crate::model::{JointModel, Restart, Simulated, Surroundings, arrivals, simulate};

/// How long a simulation runs before its angle is set to the measured one again.
///
/// An integrator keeps every error it made; a short horizon shows where errors are made,
/// the free run what becomes of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Horizon {
    /// Never: each part of a trial is one run.
    #[default]
    FreeRun,
    /// At every step of the input.
    Steps,
    /// Every so many seconds.
    Seconds(f64),
}

/// How training and validation are told apart; never sample by sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Split {
    /// The first part of each trial is for training: its share, 0 to 1.
    Time(f64),
    /// Every third trial is for validation.
    Trials,
}

impl Split {
    /// By trial where there are enough of them, else 70 % of the time of each.
    pub fn of(joint: &Joint) -> Self {
        /// Trials from which a third of them is a fair sample.
        const ENOUGH: usize = 6;
        if joint.trials.len() >= ENOUGH { Self::Trials } else { Self::Time(0.7) }
    }
}

/// What a window is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Parameters are fitted to it.
    Training,
    /// The error is judged on it.
    Validation,
}

/// Samples `start .. end` of a trial (from 0), simulated without a restart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Index of the trial.
    pub trial: usize,
    /// Index of its first sample.
    pub start: usize,
    /// Index behind its last sample.
    pub end: usize,
    /// What it is for.
    pub part: Part,
}

/// Fewest samples of a window: its offset is taken from them.
const SHORTEST_WINDOW: usize = 10;

/// A joint's trials, cut into windows.
#[derive(Clone, Debug)]
pub struct Record<'a> {
    joint: &'a Joint,
    split: Split,
    windows: Vec<Window>,
    /// Activity of the other joints, per trial; empty where there are none.
    others: Vec<Vec<f64>>,
    /// Delay of each change of the input in seconds, per trial, where it is known.
    delays: Option<Vec<Vec<Option<f64>>>>,
    radians_per_output_unit: f64,
}

/// A model on a record: what it simulates, and what is left.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// One simulation per trial.
    pub simulated: Vec<Simulated>,
    /// Measured minus simulated, per trial and sample, output units. In each window the
    /// mean is taken off: it is the window's own starting angle.
    pub residuals: Vec<Vec<f64>>,
}

impl<'a> Record<'a> {
    /// The trials of `joint`, cut by `split` and `horizon`.
    pub fn new(joint: &'a Joint, split: Split, horizon: Horizon) -> Self {
        let windows = joint.trials.iter().enumerate();
        let windows = windows.flat_map(|(index, trial)| cut(trial, index, split, horizon));
        let others = vec![Vec::new(); joint.trials.len()];
        let radians_per_output_unit = radians(joint.output_unit.as_deref());
        Self {
            joint,
            split,
            windows: windows.collect(),
            others,
            delays: None,
            radians_per_output_unit,
        }
    }

    /// The same with the activity of the other joints, per trial and sample.
    #[must_use]
    pub fn with_others(mut self, others: Vec<Vec<f64>>) -> Self {
        self.others = others;
        self.others.resize(self.joint.trials.len(), Vec::new());
        self
    }

    /// The same with each change's own delay in seconds, per trial.
    #[must_use]
    pub fn with_delays(mut self, delays: Vec<Vec<Option<f64>>>) -> Self {
        self.delays = Some(delays);
        self
    }

    /// The same trials and surroundings with another horizon.
    #[must_use]
    pub fn with_horizon(&self, horizon: Horizon) -> Self {
        let mut record = self.clone();
        let windows = self.joint.trials.iter().enumerate();
        let windows = windows.flat_map(|(index, trial)| cut(trial, index, self.split, horizon));
        record.windows = windows.collect();
        record
    }

    /// The joint.
    pub fn joint(&self) -> &'a Joint {
        self.joint
    }

    /// All windows, in the order of the record.
    pub fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// Windows of one part.
    pub fn part(&self, part: Part) -> impl Iterator<Item = &Window> {
        self.windows.iter().filter(move |window| window.part == part)
    }

    /// Simulates `model` on all trials.
    pub fn evaluate(&self, model: &JointModel) -> Evaluation {
        let indices = 0..self.joint.trials.len();
        let simulated: Vec<_> = indices.map(|index| self.simulate(model, index)).collect();
        let pairs = self.joint.trials.iter().zip(&simulated);
        let mut residuals: Vec<Vec<f64>> = pairs
            .map(|(trial, simulated)| differences(trial.output(), &simulated.output))
            .collect();
        for window in &self.windows {
            let trial = residuals.get_mut(window.trial);
            if let Some(values) = trial.and_then(|trial| trial.get_mut(window.start..window.end)) {
                take_mean_off(values);
            }
        }
        Evaluation { simulated, residuals }
    }

    fn simulate(&self, model: &JointModel, index: usize) -> Simulated {
        let Some(trial) = self.joint.trials.get(index) else { return Simulated::default() };
        let delays = self.delays.as_ref().and_then(|delays| delays.get(index));
        let arrivals = arrivals(model, trial, delays.map(Vec::as_slice));
        let surroundings = Surroundings {
            others: self.others.get(index).map_or(&[], Vec::as_slice),
            radians_per_output_unit: self.radians_per_output_unit,
            start_s: trial.time_s(1),
        };
        let restart = |window: &Window| Restart {
            sample: window.start,
            output: trial.output().get(window.start).copied().unwrap_or_default(),
        };
        let own = self.windows.iter().filter(|window| window.trial == index);
        let restarts: Vec<_> = own.map(restart).collect();
        let period_s = trial.period().seconds();
        simulate(model, &arrivals, trial.len(), period_s, &restarts, &surroundings)
    }

    /// How large the signals are; `levels` are the input's magnitudes, see
    /// [`input_levels`](Self::input_levels).
    pub fn range<'l>(&self, levels: &'l [f64], speed_abs_max: f64) -> RecordRange<'l> {
        let outputs = || self.joint.trials.iter().flat_map(|trial| trial.output().iter().copied());
        let durations = self.joint.trials.iter().map(|t| t.len() as f64 * t.period().seconds());
        let periods = self.joint.trials.iter().map(|trial| trial.period().seconds());
        RecordRange {
            input_abs_max: levels.last().copied().unwrap_or(1.0),
            input_levels: levels,
            output_min: outputs().fold(f64::INFINITY, f64::min),
            output_max: outputs().fold(f64::NEG_INFINITY, f64::max),
            speed_abs_max,
            duration_s: durations.sum(),
            sample_period_s: periods.fold(f64::INFINITY, f64::min),
            radians_per_output_unit: self.radians_per_output_unit,
        }
    }

    /// The distinct magnitudes of the input, ascending.
    pub fn input_levels(&self) -> Vec<f64> {
        let inputs = self.joint.trials.iter().flat_map(Trial::input);
        let mut levels: Vec<f64> = inputs.map(|input| input.abs()).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels
    }
}

/// Radians in one unit of the output; degrees unless the log says otherwise.
fn radians(unit: Option<&str>) -> f64 {
    match unit {
        Some("rad") => 1.0,
        Some("mrad") => 1e-3,
        Some("rev" | "turn") => std::f64::consts::TAU,
        _ => 1f64.to_radians(),
    }
}

fn differences(measured: &[f64], simulated: &[f64]) -> Vec<f64> {
    measured.iter().zip(simulated).map(|(y, s)| y - s).collect()
}

fn take_mean_off(values: &mut [f64]) {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    for value in values {
        *value -= mean;
    }
}

/// The windows of one trial.
fn cut(trial: &Trial, index: usize, split: Split, horizon: Horizon) -> Vec<Window> {
    let samples = trial.len();
    let border = match split {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1")]
        Split::Time(share) => (samples as f64 * share.clamp(0.0, 1.0)) as usize,
        Split::Trials if index % 3 == 2 => 0,
        Split::Trials => samples,
    };
    let mut borders = vec![0, border, samples];
    match horizon {
        Horizon::FreeRun => {}
        Horizon::Steps => borders.extend(changes(trial.input())),
        Horizon::Seconds(seconds) => {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 1")]
            let every = (seconds / trial.period().seconds()).round().max(1.0) as usize;
            borders.extend((0..samples).step_by(every));
        }
    }
    borders.sort_unstable();
    let mut windows: Vec<Window> = Vec::new();
    let mut start = 0;
    for end in borders {
        let must_end = end == border || end == samples;
        if end - start >= SHORTEST_WINDOW || must_end && end > start {
            let part = if start < border { Part::Training } else { Part::Validation };
            windows.push(Window { trial: index, start, end, part });
            start = end;
        }
    }
    windows
}

/// Indices of samples whose input differs from the one before.
fn changes(input: &[f64]) -> impl Iterator<Item = usize> {
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let changed = |pair: &[f64]| matches!(pair, [a, b] if a != b);
    let pairs = input.windows(2).zip(1..);
    pairs.filter(move |(pair, _)| changed(pair)).map(|(_, index)| index)
}
