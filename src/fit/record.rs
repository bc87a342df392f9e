//! A joint's trials as a fit sees them: windows, surroundings, residuals.

use std::sync::{Arc, OnceLock};

use nalgebra::DVector;

use super::coarse::Coarse;
use super::evaluation::Evaluation;
use super::excerpt::Excerpt;
use super::extent::Extent;
use super::first_order::Follower;
use super::mended::Mended;
use super::ripple::RipplePeriod;
use super::run::{Run, Speeds, best_starts, raw_residuals, residuals_from, simulated_from};
use super::speed;
use super::unlogged::commands;
use super::window::{Horizon, Part, Split, Window, changes, cut, places, shorter};
use crate::delay::step_delays;
use crate::effect::{RecordRange, SignalRange};
use crate::experiment::{Joint, Trial, has_word};
use crate::model::{Arrivals, Commands, JointModel, Signals, Surroundings};
use crate::units::{floor_to_index, radians_in};

/// A joint's trials, cut into windows.
#[derive(Clone, Debug)]
pub struct FitRecord<'a> {
    measured: &'a Joint,
    /// The joint without spikes and without noise of its input, where it has any.
    mended: Option<Joint>,
    /// The joint with fewer samples, where that will do.
    coarse: Option<Coarse>,
    split: Split,
    horizon: Horizon,
    windows: Vec<Window>,
    /// Activity of the other joints, per trial; empty where there are none.
    others: Arc<Vec<Vec<f64>>>,
    /// Delay of each change of the input in seconds, per trial, where it is known; measured
    /// when a model first asks for it.
    delays: Arc<OnceLock<Delays>>,
    radians_per_output_unit: f64,
    /// Windows start at the measured speed.
    speeds_measured: bool,
    /// Changes of the input, per trial.
    commands: Arc<Vec<Commands>>,
    extent: Arc<Extent>,
    /// Ranges of the further signals that were measured.
    signals: Arc<Vec<SignalRange<'a>>>,
    /// Which samples count.
    seen: Arc<Mended>,
}

/// Delay of each change of the input in seconds, per trial, where it is known.
type Delays = Vec<Vec<Option<f64>>>;

/// Whether a residual of `size` is no more than what the outputs of `trials` are rounded by.
pub(crate) fn is_rounding(trials: &[Trial], size: f64) -> bool {
    /// Part of the largest output, some thousand times what a double is rounded by (chosen).
    const ROUNDING: f64 = 1e-12;
    let outputs = trials.iter().flat_map(|trial| trial.output().iter());
    let largest = outputs.fold(0.0_f64, |largest, output| largest.max(output.abs()));
    size <= ROUNDING * largest
}

impl<'a> FitRecord<'a> {
    /// The trials of `joint`, cut by `split` and `horizon`.
    ///
    /// Each window starts from the output that makes its error least. Its speed is the
    /// measured one where noise leaves it well known (to 1 % of the speeds in the record);
    /// else the simulation goes on with its own, and is steady where a trial begins.
    pub fn new(joint: &'a Joint, split: Split, horizon: Horizon) -> Self {
        let (measured, seen) = (joint, joint.trials.property::<Mended>());
        let mended = seen.record.clone().map(|trials| Joint { trials, ..joint.clone() });
        let joint = mended.as_ref().unwrap_or(measured);
        let extent = joint.trials.property::<Extent>();
        let horizon = horizon.of(joint);
        let windows = windows(joint, split, horizon);
        let speeds_measured = speed::are_measured(&joint.trials, &windows);
        let others = Arc::new(vec![Vec::new(); joint.trials.len()]);
        let radians_per_output_unit = radians_in(joint.output_unit.as_deref());
        let commands = Arc::new(commands(&joint.trials, extent.neutral));
        let ends = measured.covariates.iter().zip(&extent.covariates);
        let signals = ends.map(|(signal, (min, max))| SignalRange {
            name: &signal.name,
            min: *min,
            max: *max,
        });
        let signals = Arc::new(signals.filter(|range| range.min <= range.max).collect());
        Self {
            measured,
            mended,
            coarse: None,
            split,
            horizon,
            windows,
            others,
            delays: Arc::default(),
            radians_per_output_unit,
            speeds_measured,
            commands,
            extent,
            signals,
            seen,
        }
    }

    /// This record with the activity of the other joints, per trial and sample.
    #[must_use]
    pub fn with_others(self, mut others: Vec<Vec<f64>>) -> Self {
        others.resize(self.joint().trials.len(), Vec::new());
        Self { others: Arc::new(others), ..self }
    }

    /// This record with each change's own delay in seconds, per trial, for models that take
    /// measured delays. Without it they are measured, by [`step_delays`].
    #[must_use]
    pub fn with_delays(mut self, delays: Vec<Vec<Option<f64>>>) -> Self {
        self.delays = Arc::new(OnceLock::from(delays));
        self
    }

    /// The delay of each change of the input, per trial.
    fn delays(&self) -> &Delays {
        self.delays.get_or_init(|| step_delays(&self.joint().trials).unwrap_or_default())
    }

    /// How many delays `model` takes from the record: as many numbers that are not its own.
    pub(crate) fn measured_delays(&self, model: &JointModel) -> usize {
        let known = |delays: &Delays| delays.iter().flatten().flatten().count();
        if model.takes_measured_delays() { known(self.delays()) } else { 0 }
    }

    /// Whether the measured delays differ by more than a sample period: a step of the input falls
    /// between two samples, and is logged with the second.
    pub(crate) fn delays_differ(&self) -> bool {
        /// Delays on each side that may be off.
        const OUTSIDE: f64 = 0.1;
        let mut delays: Vec<f64> = self.delays().iter().flatten().flatten().copied().collect();
        delays.sort_by(f64::total_cmp);
        let at = |part: f64| delays.get(floor_to_index(part * delays.len() as f64)).copied();
        let spread = at(OUTSIDE).zip(at(1.0 - OUTSIDE)).map_or(0.0, |(low, high)| high - low);
        let periods = self.joint().trials.iter().map(|trial| trial.period().seconds());
        spread > periods.fold(0.0, f64::max)
    }

    /// The trials and surroundings with another horizon.
    #[must_use]
    pub fn with_horizon(&self, horizon: Horizon) -> Self {
        let horizon = horizon.of(self.joint());
        let windows = windows(self.joint(), self.split, horizon);
        let speeds_measured = speed::are_measured(&self.joint().trials, &windows);
        Self { horizon, windows, speeds_measured, ..self.clone() }
    }

    /// Whether it is known what other joints did.
    pub fn has_others(&self) -> bool {
        self.others.iter().flatten().any(|activity| *activity > 0.0)
    }

    /// Whether the further signal with this name was measured.
    pub fn has_signal(&self, name: &str) -> bool {
        self.signals.iter().any(|signal| signal.name == name)
    }

    /// Whether each part has trials with `word` in their labels, and without.
    pub(crate) fn shows_condition(&self, word: &str) -> bool {
        let has = |window: &Window| has_word(self.joint().trials[window.trial].label(), word);
        let shows = |part| {
            let with = self.part(part).filter(|window| has(window)).count();
            let all = self.part(part).count();
            all == 0 || (0 < with && with < all)
        };
        shows(Part::Training) && shows(Part::Validation)
    }

    /// The joint as it was measured.
    pub(crate) fn measured(&self) -> &Joint {
        self.measured
    }

    /// The joint, with lines in the place of spikes of its output, and the levels that its input holds where
    /// that was measured with noise.
    pub fn joint(&self) -> &Joint {
        self.coarse.as_ref().map_or(self.fine(), |coarse| &coarse.joint)
    }

    /// The joint with all its samples.
    fn fine(&self) -> &Joint {
        self.mended.as_ref().unwrap_or(self.measured)
    }

    /// All windows, in the order of the record.
    pub fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// Windows of one part.
    pub fn part(&self, part: Part) -> impl Iterator<Item = &Window> {
        self.windows.iter().filter(move |window| window.part == part)
    }

    /// `values`, one per trial and sample, of the windows of one part, at the samples that count: see
    /// [`weights_of`](Self::weights_of).
    pub(crate) fn cut(&self, values: &[Vec<f64>], part: Part) -> Vec<Vec<f64>> {
        let cut = |w: &Window| {
            let own = values.get(w.trial)?.get(w.start..w.end)?;
            let weights = self.weights_of(w.trial).and_then(|all| all.get(w.start..w.end));
            Some(match weights {
                Some(weights) => {
                    let counts = own.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
                    counts.map(|(value, _)| *value).collect()
                }
                None => own.to_vec(),
            })
        };
        self.part(part).filter_map(cut).collect()
    }

    /// Simulates `model` on all trials, each to the end of its last window.
    pub fn evaluate(&self, model: &JointModel) -> Evaluation {
        let runs = self.runs(model);
        let starts = best_starts(&runs);
        let (simulated, residuals) = simulated_from(runs.iter().zip(&starts)).into_iter().unzip();
        Evaluation { horizon: self.horizon, simulated, residuals, starts: Vec::new() }
    }

    /// The residuals of `model` alone, without the outputs: a quarter of the memory.
    pub(crate) fn evaluate_residuals(&self, model: &JointModel) -> Evaluation {
        let runs = self.runs(model);
        let starts = best_starts(&runs);
        let residuals = residuals_from(runs.iter().zip(&starts));
        Evaluation { horizon: self.horizon, simulated: Vec::new(), residuals, starts }
    }

    /// Measured minus simulated, per trial and sample: each run starts at the smoothed measured
    /// output, and nothing is removed.
    pub(crate) fn raw_residuals(&self, model: &JointModel) -> Vec<Vec<f64>> {
        raw_residuals(&self.runs(model))
    }

    /// What [`raw_residuals`](Self::raw_residuals) are in a free run: each trial is simulated from its
    /// start to its end, at first steady.
    pub(crate) fn free_residuals(&self, model: &JointModel) -> Vec<Vec<f64>> {
        let trials = self.joint().trials.iter().enumerate();
        let whole = trials.filter(|(_, trial)| trial.len() > 0).map(|(index, trial)| Window {
            trial: index,
            start: 0,
            end: trial.len(),
            part: Part::Training,
            restarts: true,
        });
        let free = Self { windows: whole.collect(), speeds_measured: false, ..self.clone() };
        raw_residuals(&free.runs(model))
    }

    /// The residuals of the training windows, as [`training`](Self::training) has them, of each of
    /// `models`, which are near to the one of `near`, whose starts are taken.
    pub(super) fn training_near(
        &self,
        models: &[JointModel],
        near: &Evaluation,
    ) -> Vec<DVector<f64>> {
        let runs: Vec<Vec<Run<'_>>> = models.iter().map(|model| self.runs(model)).collect();
        // Runs of one trial take as long as one another.
        let all = near.starts.iter().enumerate().flat_map(|(trial, starts)| {
            runs.iter().filter_map(move |runs| Some((runs.get(trial)?, starts)))
        });
        let mut residuals = vec![Vec::new(); models.len()];
        for (index, own) in residuals_from(all).into_iter().enumerate() {
            residuals[index % models.len()].push(own);
        }
        residuals.iter().map(|residuals| self.training(residuals)).collect()
    }

    /// This record with one of some samples of each trial, for fits of `model`.
    pub(super) fn coarser_for(&self, model: &JointModel) -> Self {
        // Delays that were measured are those of steps in all samples.
        let coarse = if model.takes_measured_delays() { None } else { Coarse::of(self.joint()) };
        let Some(coarse) = coarse else { return self.clone() };
        let weights = self.seen.weights.as_ref().map(|weights| coarse.kept(weights));
        let seen = Mended { record: None, weights, has_noisy_input: self.seen.has_noisy_input };
        Self {
            windows: coarse.windows(&self.windows),
            others: Arc::new(coarse.kept(&self.others)),
            commands: Arc::new(coarse.commands(&self.commands)),
            seen: Arc::new(seen),
            coarse: Some(coarse),
            ..self.clone()
        }
    }

    /// This record with all windows for training.
    pub(super) fn unsplit(&self) -> Self {
        let fitted = |window: &Window| Window { part: Part::Training, ..*window };
        Self { windows: self.windows.iter().map(fitted).collect(), ..self.clone() }
    }

    /// This record with training windows of no more than a few steps of the input.
    pub(super) fn shortened(&self) -> Self {
        let windows = self.part(Part::Training).flat_map(|window| {
            let input = self.joint().trials.get(window.trial).map_or(&[][..], Trial::input);
            let input = input.get(window.start..window.end).unwrap_or_default();
            shorter(*window, changes(input).count())
        });
        Self { windows: windows.collect(), ..self.clone() }
    }

    /// This record without what lies after the last training window of a trial, which is not
    /// simulated.
    pub(crate) fn for_training(&self) -> Self {
        let is_followed = |window: &&Window| {
            let later = self.windows_of(window.trial).iter().rev();
            let mut later = later.take_while(|other| other.start >= window.start);
            later.any(|other| other.part == Part::Training)
        };
        Self { windows: self.windows.iter().filter(is_followed).copied().collect(), ..self.clone() }
    }

    /// The training windows, or parts of them where they are very long.
    pub(crate) fn excerpt(&self) -> Excerpt {
        Excerpt::of(self.part(Part::Training).copied().collect())
    }

    /// Samples that are for training.
    pub(super) fn training_samples(&self) -> usize {
        self.part(Part::Training).map(|window| window.end - window.start).sum()
    }

    /// The values of the training windows, one after the other, times their weights.
    pub(super) fn training(&self, values: &[Vec<f64>]) -> DVector<f64> {
        let mut all = Vec::with_capacity(self.training_samples());
        for window in self.part(Part::Training) {
            let own = values.get(window.trial).and_then(|own| own.get(window.start..window.end));
            let own = own.unwrap_or_default();
            match self.weights_of(window.trial).and_then(|all| all.get(window.start..window.end)) {
                Some(weights) => all.extend(own.iter().zip(weights).map(|(value, w)| value * w)),
                None => all.extend_from_slice(own),
            }
        }
        DVector::from_vec(all)
    }

    /// The weights of the samples of a trial: 0 for isolated spikes of the sensor and for gaps that
    /// were filled, which no error counts, and 1 for all others; `None` where all of the record are
    /// 1.
    pub fn weights_of(&self, trial: usize) -> Option<&[f64]> {
        self.seen.weights.as_ref()?.get(trial).map(Vec::as_slice)
    }

    /// The model on each trial.
    fn runs<'m>(&'m self, model: &'m JointModel) -> Vec<Run<'m>> {
        (0..self.joint().trials.len()).filter_map(|index| self.run(model, index)).collect()
    }

    /// The model on one trial.
    fn run<'m>(&'m self, model: &'m JointModel, index: usize) -> Option<Run<'m>> {
        let trial = self.joint().trials.get(index)?;
        let stride = self.coarse.as_ref().map_or(1, |coarse| coarse.stride);
        let speeds = self.fine().trials.get(index).map(|trial| Speeds { trial, stride });
        let surroundings = Surroundings {
            others: self.others.get(index).map_or(&[], Vec::as_slice),
            radians_per_output_unit: self.radians_per_output_unit,
            start_s: self.start_s(index),
            signals: Signals {
                signals: &self.joint().covariates,
                values: trial.covariates(),
                from: 0,
            },
        };
        let model = model.in_trial(trial.label());
        let windows = self.windows_of(index).to_vec();
        // Nothing of a trial without windows is simulated.
        let arrivals =
            if windows.is_empty() { Arrivals::default() } else { self.arrivals(&model, index) };
        Some(Run {
            trial,
            arrivals,
            surroundings,
            windows,
            weights: self.weights_of(index),
            span: self.extent.spans[index],
            speeds: speeds.filter(|_| self.speeds_measured && model.has_dynamics()),
            model,
        })
    }

    /// The windows of a trial, which are in the order of the record.
    pub(crate) fn windows_of(&self, trial: usize) -> &[Window] {
        let first = self.windows.partition_point(|window| window.trial < trial);
        let end = self.windows.partition_point(|window| window.trial <= trial);
        &self.windows[first..end]
    }

    /// When each level of the input of a trial begins to act.
    pub fn arrivals(&self, model: &JointModel, trial: usize) -> Arrivals {
        let Some(commands) = self.commands.get(trial) else { return Arrivals::default() };
        let model = &*model.in_trial(self.joint().trials[trial].label());
        let delays = model.takes_measured_delays().then(|| self.delays());
        let delays = delays.and_then(|delays| delays.get(trial));
        commands.arriving(model, self.start_s(trial), delays.map(Vec::as_slice))
    }

    /// Seconds from the start of the record to that of `trial`.
    pub(crate) fn start_s(&self, trial: usize) -> f64 {
        self.extent.starts_s[trial]
    }

    /// How large the signals are, for a joint whose largest speed is `speed_abs_max`.
    pub fn range(&self, speed_abs_max: f64) -> RecordRange<'_> {
        let extent = &*self.extent;
        RecordRange {
            input_neutral: extent.neutral,
            input_abs_max: extent.levels.last().copied().unwrap_or(1.0),
            input_span: extent.input_span,
            input_levels: &extent.levels,
            output_min: extent.output.0,
            output_max: extent.output.1,
            speed_abs_max,
            duration_s: extent.duration_s,
            sample_period_s: extent.sample_period_s,
            radians_per_output_unit: self.radians_per_output_unit,
            ripple_period: self.joint().trials.property::<RipplePeriod>().0,
            signals: &self.signals,
        }
    }

    /// How large the signals are, for a joint with about the gain of `model`.
    pub fn range_for(&self, model: &JointModel) -> RecordRange<'_> {
        let largest = self.extent.levels.last().copied().unwrap_or(1.0);
        self.range(model.gain.value.abs() * largest)
    }

    /// Whether the residuals of `evaluation` are no more than rounding: there is nothing to explain.
    pub(crate) fn is_exact(&self, evaluation: &Evaluation) -> bool {
        let residuals = evaluation.residuals.iter().flatten();
        let most = residuals.fold(0.0_f64, |most, residual| most.max(residual.abs()));
        is_rounding(&self.joint().trials, most)
    }

    /// How the output follows the input, where it does or is likely to follow the input itself.
    pub(crate) fn follower(&self) -> Option<Follower> {
        Follower::of(&self.joint().trials)
    }

    /// The distinct magnitudes of the input, ascending; those from its neutral where it is coded.
    pub fn input_levels(&self) -> &[f64] {
        &self.extent.levels
    }
}

/// All windows of a joint.
fn windows(joint: &Joint, split: Split, horizon: Horizon) -> Vec<Window> {
    let trials = joint.trials.iter().enumerate().zip(places(&joint.trials));
    let cut = |((index, trial), place)| cut(trial, index, (split, place), horizon);
    trials.flat_map(cut).collect()
}
