//! The lag that all steps of a joint share.
//!
//! Windows of some onsets each are fitted together: the lag's one to three parameters are
//! common, all else belongs to one window and is eliminated there (Golub and Pereyra's variable
//! projection), so that a step of Gauss and Newton costs one pass. Which poles the lag has is
//! chosen by Schwarz's criterion, with the noise of the richest lag's residuals.
//!
//! # References
//! G. Schwarz, "Estimating the dimension of a model", Ann. Statist. 6 (1978).

use super::basis::Basis;
use super::fit_window::{FINE, FitWindow};
use super::information::Information;
use super::linearised::Linearised;
use super::model::{LagModel, MAX_PARAMETERS, Poles};
use super::response::Response;
use super::starts::{behind_poles, pairs, reals};
use crate::numerics::{NoiseModel, median, robust_scale};

/// Squared errors below this part of the output's are rounding.
const ROUNDING: f64 = 1e-14;

/// Steps of Gauss and Newton, at most; chosen, a search that converges takes fewer.
const STEPS: usize = 12;

/// The windows of a joint under one lag.
#[derive(Clone, Debug)]
pub(crate) struct LagSearch<'a> {
    pub(crate) windows: Vec<FitWindow<'a>>,
    pub(crate) noise: NoiseModel,
    pub(crate) model: LagModel,
    /// The longest time that can be distinguished from a drift, samples.
    longest: f64,
    /// Sum of squares about the mean of each window.
    power: f64,
    found: Vec<Linearised>,
}

impl<'a> LagSearch<'a> {
    /// For `windows` whose onsets were found without a lag.
    pub(crate) fn new(windows: Vec<FitWindow<'a>>) -> Self {
        let power = windows.iter().map(|window| power(window.values)).sum();
        let gaps = windows.iter().map(|s| s.values.len() / (s.onsets.len() + 1));
        let longest = gaps.max().unwrap_or(1) as f64;
        let (noise, model, found) = (NoiseModel::white(), LagModel::NONE, Vec::new());
        Self { windows, noise, model, longest, power, found }
    }

    fn sse(&self) -> f64 {
        self.found.iter().map(|found| found.sse).sum()
    }

    fn samples(&self) -> f64 {
        self.windows.iter().map(FitWindow::weight).sum()
    }

    /// Moves the onsets of every window to where its squared error is least, until a step is no
    /// longer than `fine` samples.
    fn regress(&mut self, fine: f64) {
        let longest = self.windows.iter().map(|window| window.values.len()).max();
        let (basis, noise) = (Basis::of(&self.model, longest.unwrap_or(0)), &self.noise);
        let one = |window: &mut FitWindow<'_>| {
            let limits = window.halfway();
            window.minimise(&basis, noise, &limits, fine)
        };
        self.found = self.windows.iter_mut().map(one).collect();
    }

    /// Leaves out windows with an error far beyond that of most: something else happened
    /// there.
    fn trim_outliers(&self) -> Self {
        /// Times the median of the squared error per degree of freedom: with eight degrees
        /// noise alone exceeds it in one of two million windows (χ² tail).
        const OUTLYING: f64 = 6.0;
        self.trim_beyond(OUTLYING)
    }

    /// Leaves out, before the lag is moved, windows in which plainly something else happened, as a joint
    /// that is moved by hand: one of them draws the lag of all to itself.
    fn trim_events(mut self) -> Self {
        /// Times the median (chosen): behind a lag that is not known yet the errors are as the squares of
        /// the changes of speed, a change three times that of most ten times theirs.
        const EVENT: f64 = 100.0;
        self.regress(FINE);
        self.trim_beyond(EVENT)
    }

    /// Leaves out windows whose squared error per degree of freedom is beyond so many times the median;
    /// rounding is none.
    fn trim_beyond(&self, times: f64) -> Self {
        let levels = self.levels();
        let rounding = ROUNDING * self.power / self.samples().max(1.0);
        let most = (times * median(&levels).unwrap_or(0.0)).max(rounding);
        self.subset(&levels.iter().map(|level| *level <= most).collect::<Vec<_>>())
    }

    /// Which windows have an error within what noise makes of that of most: where holds
    /// are short, onsets are easily mistaken for others.
    fn plausible(&self) -> Vec<bool> {
        const STANDARD_DEVIATIONS: f64 = 3.0;
        let levels = self.levels();
        let middle = median(&levels).unwrap_or(0.0);
        let centred: Vec<f64> = levels.iter().map(|level| level - middle).collect();
        let most = middle + STANDARD_DEVIATIONS * robust_scale(&centred);
        levels.iter().map(|level| *level <= most).collect()
    }

    /// The squared error of each window per degree of freedom.
    fn levels(&self) -> Vec<f64> {
        let pairs = self.windows.iter().zip(&self.found);
        let level = |(window, found): (&FitWindow<'_>, &Linearised)| {
            found.sse / (window.weight() - found.parameters() as f64).max(1.0)
        };
        pairs.map(level).collect()
    }

    /// The search over the windows that are `kept` alone.
    fn subset(&self, kept: &[bool]) -> Self {
        let windows = self.windows.iter().zip(kept).filter(|(_, kept)| **kept);
        let found = self.found.iter().zip(kept).filter(|(_, kept)| **kept);
        Self {
            windows: windows.map(|(window, _)| window.clone()).collect(),
            found: found.map(|(found, _)| found.clone()).collect(),
            noise: self.noise.clone(),
            ..*self
        }
    }

    /// Behind another lag, with the onsets earlier by as much as it is later.
    fn with_lag(&self, model: LagModel) -> Self {
        let mut joint = self.shift_onsets(model);
        joint.regress(FINE);
        joint
    }

    /// Behind another lag, with the onsets where the output would begin as late as before.
    fn shift_onsets(&self, model: LagModel) -> Self {
        let mut joint = Self { model, ..self.clone() };
        // G is late by its mean: as much is taken off the dead time.
        let earlier = Response::of(&model).mean - Response::of(&self.model).mean;
        for onset in joint.windows.iter_mut().flat_map(|window| &mut window.onsets) {
            *onset -= earlier;
        }
        joint
    }

    /// Whether a sensor with steps of `quantum` sees the lag: how far reactions are behind because
    /// of it is several of its steps. Else the stairs of the sensor pass for a lag.
    pub(crate) fn is_seen_by(&self, quantum: f64) -> bool {
        /// Steps (chosen).
        const STEPS: f64 = 4.0;
        let changes: Vec<f64> = self.found.iter().map(|found| found.change().abs()).collect();
        let behind = median(&changes).unwrap_or(0.0) * Response::of(&self.model).mean;
        behind >= STEPS * quantum
    }

    /// Whether reactions are so small beside the noise that it takes many to see a lag.
    pub(crate) fn is_faint(&self) -> bool {
        /// Standard deviations of the noise by which the speed changes, per sample.
        const CLEAR: f64 = 1.0;
        let mut changes: Vec<f64> = self.found.iter().map(|found| found.change().abs()).collect();
        changes.sort_by(f64::total_cmp);
        // The upper one of two in the middle.
        let median = changes.get(changes.len() / 2).copied().unwrap_or(0.0);
        let noise = (self.sse() / self.samples().max(1.0)).sqrt();
        median < CLEAR * noise
    }

    /// These onsets behind another lag, in another noise.
    pub(crate) fn with_model(self, model: LagModel, noise: NoiseModel) -> Self {
        Self { noise, model, ..self }
    }

    /// The least squared error near a lag that is almost right, without outliers; or a simpler
    /// lag, where onsets that are known better no longer speak for all of its poles.
    pub(crate) fn refit(self) -> Self {
        let usual = self.trim_events().minimise(1).trim_outliers().with_its_noise();
        let simpler = usual.model.simpler().into_iter();
        let rivals: Vec<_> = simpler.map(|model| usual.with_lag(model).minimise(STEPS)).collect();
        let better = |best: Self, rival: Self| {
            if rival.criterion() < best.criterion() { rival } else { best }
        };
        rivals.into_iter().fold(usual, better)
    }

    /// The least squared error near a lag that is almost right, in the noise of its own
    /// residuals.
    fn with_its_noise(self) -> Self {
        const STEPS: usize = 4;
        let found = self.minimise(STEPS);
        let noise = found.residual_noise();
        found.whitened(noise).minimise(STEPS)
    }

    /// These onsets and lag in another noise.
    fn whitened(&self, noise: NoiseModel) -> Self {
        let mut joint = Self { noise, ..self.clone() };
        joint.regress(FINE);
        joint
    }

    /// One step of Gauss and Newton for the onsets and for the lag; what the windows together
    /// say about the lag.
    fn step(&self) -> (Vec<Vec<f64>>, [f64; MAX_PARAMETERS], Information) {
        let pairs = self.windows.iter().zip(&self.found);
        let with_lag_columns = |(window, found): (&FitWindow<'_>, &Linearised)| {
            window.with_lag_columns(&self.model, &self.noise, &found.parts)
        };
        let found: Vec<_> = pairs.map(with_lag_columns).collect();
        let mut information = Information::default();
        for one in &found {
            one.inform(&mut information);
        }
        // All windows share the lag; their onsets follow from its step.
        let change = information.solve(self.model.order());
        (found.iter().map(|one| one.moves(&change)).collect(), change, information)
    }

    /// Moves onsets and lag until the squared error is least, in `steps` at most.
    fn minimise(mut self, steps: usize) -> Self {
        /// Part by which the squared error must fall to go on.
        const WORTH: f64 = 1e-6;
        if self.found.len() != self.windows.len() {
            self.regress(FINE);
        }
        for _ in 0..steps {
            let before = self.sse();
            let Some(better) = self.better() else { break };
            self = better;
            if before - self.sse() < WORTH * before {
                break;
            }
        }
        self
    }

    /// The search after a step that lowers the squared error; shorter ones are tried.
    fn better(&self) -> Option<Self> {
        /// Lengths of a step that are tried, each a part of the one before.
        const TRIED: i32 = 4;
        const SHORTENED: f64 = 0.4;
        let (moves, change, _) = self.step();
        for shortening in 0..TRIED {
            let factor = SHORTENED.powi(shortening);
            let mut there = self.clone();
            there.model = self.model.moved(&change.map(|by| factor * by), self.longest);
            for (window, moves) in there.windows.iter_mut().zip(&moves) {
                let last = window.values.len() as f64 - 2.0;
                for (onset, by) in window.onsets.iter_mut().zip(moves) {
                    *onset = (*onset + factor * by).clamp(-last, last);
                }
            }
            there.regress(FINE);
            if there.sse() < self.sse() {
                return Some(there);
            }
        }
        None
    }

    /// Schwarz's criterion, `n·ln σ² + p·ln n`. What belongs to one window only costs degrees of
    /// freedom, in `σ²`: it is no part of the lag that is chosen.
    fn criterion(&self) -> f64 {
        let samples = self.samples();
        // An exact output would have ln 0.
        let sse = self.sse().max(ROUNDING * self.power).max(f64::MIN_POSITIVE);
        let own: usize = self.found.iter().map(Linearised::parameters).sum();
        let freedom = (samples - own as f64).max(1.0);
        samples * (sse / freedom).ln() + penalty(self.model.poles) * samples.ln()
    }

    /// Covariance of the lag's parameters, `σ²·(XᵀX)⁻¹` with all else eliminated.
    pub(crate) fn covariance(&self) -> [[f64; MAX_PARAMETERS]; MAX_PARAMETERS] {
        let (_, _, information) = self.step();
        let used: usize = self.found.iter().map(Linearised::parameters).sum();
        let freedom = (self.samples() - (used + self.model.order()) as f64).max(1.0);
        let inverse = information.inverse(self.model.order());
        // σ² = SSE/(n − p).
        inverse.map(|row| row.map(|value| value * self.sse() / freedom))
    }

    /// The noise of the residuals.
    fn residual_noise(&self) -> NoiseModel {
        /// Windows that are enough to know the noise.
        const ENOUGH: usize = 50;
        let some = self.windows.iter().step_by(self.windows.len().div_ceil(ENOUGH).max(1));
        let projections = some.map(|window| window.projection(&self.model));
        NoiseModel::of_projections(&projections.collect::<Vec<_>>())
    }

    /// The best lag: no poles, a real one, a pair, or all three.
    pub(crate) fn select(self) -> Self {
        let joint = self.trim_events();
        let mut white = joint.of_each_order();
        let usual = richest(&white).map(Self::trim_outliers);
        if let Some(usual) = usual.filter(|usual| usual.windows.len() < joint.windows.len()) {
            // Each order was searched with the outliers among the windows.
            white = usual.with_lag(LagModel::NONE).of_each_order();
        }
        // What a lag lacks would pass for memory: the richest one lacks least.
        let noise = richest(&white).map_or_else(NoiseModel::white, Self::residual_noise);
        let all = if noise.order() > 0 {
            white.iter().map(|joint| joint.whitened(noise.clone()).minimise(STEPS)).collect()
        } else {
            white
        };
        let best = all.into_iter().min_by(|a, b| a.criterion().total_cmp(&b.criterion()));
        best.unwrap_or(joint)
    }

    /// The best lag of any kind from onsets that are about right behind the one at hand; a
    /// simpler one if it is worse by no more than the part `caution` of a squared error.
    pub(crate) fn reselected(self, caution: f64) -> Self {
        let usual = self.trim_events().minimise(1);
        let usual = usual.subset(&usual.plausible());
        let rivals = usual.whitened(usual.residual_noise()).rivals();
        let noise = richest(&rivals).map_or_else(NoiseModel::white, Self::residual_noise);
        let found = rivals.iter().map(|rival| rival.whitened(noise.clone()).minimise(STEPS));
        let all: Vec<_> = found.collect();
        let least = all.iter().map(Self::criterion).fold(f64::INFINITY, f64::min);
        // n ln((1 + caution) SSE) ≈ n ln SSE + caution·n.
        let enough = least + caution * usual.samples();
        let simplest = all.into_iter().find(|joint| joint.criterion() <= enough);
        simplest.unwrap_or(usual)
    }

    /// The lags of each order about as late as this one that explain most windows, over those
    /// that each of them fits: what one lag makes of a mistaken onset is no reason to prefer it.
    fn rivals(&self) -> Vec<Self> {
        /// Times the least squared error.
        const GOOD: f64 = 1.2;
        /// Steps after which a lag that fits is near its least squared error.
        const FEW: usize = 4;
        let starts = self.model.nearby();
        let started = starts.into_iter().map(|starts| self.started(&starts).minimise(FEW));
        let mut rivals: Vec<_> = started.collect();
        let least = rivals.iter().map(Self::sse).fold(f64::INFINITY, f64::min);
        rivals.retain(|joint| joint.sse() <= GOOD * least);
        let mut kept = vec![true; self.windows.len()];
        for rival in &rivals {
            for (kept, plausible) in kept.iter_mut().zip(rival.plausible()) {
                *kept &= plausible;
            }
        }
        rivals.iter().map(|rival| rival.subset(&kept)).collect()
    }

    /// The search with the best lag of each order: none, a real pole, a pair, and all three
    /// where the pair is one.
    fn of_each_order(&self) -> Vec<Self> {
        let none = self.clone().minimise(STEPS);
        let real = none.started(&reals(self.longest)).minimise(STEPS);
        let pair = none.started(&pairs(self.longest)).minimise(STEPS);
        // Onsets found behind a lag may suit none at all better than those found without.
        let again = |joint: &Self| joint.with_lag(LagModel::NONE).minimise(STEPS);
        let others = [again(&pair), none];
        let better = |best: Self, other: Self| if other.sse() < best.sse() { other } else { best };
        let none = others.into_iter().fold(again(&real), better);
        let mut all = vec![none, real, pair];
        if all[2].model.poles == Poles::Pair {
            let starts = behind_poles(all[2].model, self.longest);
            all.push(all[0].started(&starts).minimise(STEPS));
        }
        all
    }

    /// The search with the best of the `models`, after a rough look at each.
    fn started(&self, models: &[LagModel]) -> Self {
        /// Samples that are enough to know a good start.
        const ENOUGH: usize = 2000;
        /// Samples that an onset may still move: only the best start is searched further.
        const ROUGHLY: f64 = 1.0;
        let mut few = self.clone();
        let mut samples = 0;
        few.windows.retain(|window| {
            let keep = samples < ENOUGH;
            samples += window.values.len();
            keep
        });
        few.found.truncate(few.windows.len());
        let tried = models.iter().map(|model| {
            let mut there = few.shift_onsets(*model);
            there.regress(ROUGHLY);
            there
        });
        let best = tried.min_by(|a, b| a.sse().total_cmp(&b.sse()));
        self.with_lag(best.map_or(self.model, |best| best.model))
    }
}

/// The search with the least squared error.
fn richest<'a, 'b>(all: &'b [LagSearch<'a>]) -> Option<&'b LagSearch<'a>> {
    all.iter().min_by(|a, b| a.sse().total_cmp(&b.sse()))
}

/// How often Schwarz's penalty for one parameter counts; chosen, and fixed by
/// `tests/delays/delay_methods.rs` (a joint without a lag has none, one with a lag or ringing has that). A lag shorter than a sample is at
/// the border of all lags, and a pair that hardly decays looks for one period among many:
/// there noise explains more than its number of parameters.
fn penalty(poles: Poles) -> f64 {
    match poles {
        Poles::None => 0.0,
        Poles::Real => 1.5,
        Poles::Pair => 6.0,
        Poles::RealAndPair => 8.0,
    }
}

/// Sum of squares about the mean.
fn power(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|y| (y - mean) * (y - mean)).sum()
}
