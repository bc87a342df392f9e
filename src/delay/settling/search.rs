//! The time constants that explain all steps of a joint best.
//!
//! Gauss and Newton's method on the sum of squared errors of all windows: the linear parameters
//! of each window and its onset are eliminated, what remains is a normal equation of the few
//! logarithms of time constants. A further lag, and a time constant of its own for a falling
//! input, are taken where Schwarz's criterion asks for them.

use nalgebra::{DMatrix, DVector};

use super::constants::TimeConstants;
use super::trial::SettlingTrial;
use super::window::StepWindow;
use crate::delay::broken_line::Window;
use crate::numerics::{NoiseModel, NormalEquations, dot};
use crate::units::floor_to_index;

/// Samples of windows that are enough to know the time constants.
const ENOUGH: usize = 10_000;

/// A window of a step in one of the trials.
#[derive(Clone, Debug)]
struct Member<'a> {
    trial: usize,
    index: usize,
    window: StepWindow<'a>,
    /// Index of the window's first sample.
    start: f64,
    limits: (f64, f64),
    /// As an index of the window.
    onset: f64,
}

/// Time constants and the onsets behind which they are sought.
#[derive(Clone, Debug)]
pub(super) struct Search<'a> {
    trials: &'a [SettlingTrial<'a>],
    members: Vec<Member<'a>>,
    pub(super) constants: TimeConstants,
    /// Windows in which a sample is, on average.
    shared: f64,
    /// The sum of squared errors at the last step.
    pub(super) sse: f64,
    /// The inverse of the normal equations of the parameters.
    inverse: DMatrix<f64>,
}

/// The normal equations of a window.
struct Linearised {
    sse: f64,
    /// Of its onset, and then of the parameters, from which the onset is eliminated.
    equations: NormalEquations,
}

impl<'a> Search<'a> {
    /// From these time constants, with the onsets of `trials`.
    pub(super) fn of(
        trials: &'a [SettlingTrial<'a>],
        constants: TimeConstants,
        noise: &'a NoiseModel,
    ) -> Self {
        let members = |(number, trial): (usize, &'a SettlingTrial<'a>)| {
            let member = move |index: usize| member(number, trial, index, noise);
            (0..trial.path.onsets.len()).filter_map(member).collect::<Vec<_>>()
        };
        let mut members: Vec<_> = trials.iter().enumerate().flat_map(members).collect();
        let samples: usize = members.iter().map(|member| member.window.len()).sum();
        let every = samples.div_ceil(ENOUGH).max(1);
        members = members.into_iter().step_by(every).collect();
        // A window reaches over two holds: those of neighbours share one.
        let shared = if every > 1 { 1.0 } else { 2.0 };
        // Until a step is determined nothing is known of any parameter.
        let inverse = DMatrix::zeros(constants.parameters(), constants.parameters());
        Self { trials, members, constants, shared, sse: f64::INFINITY, inverse }
    }

    /// Windows that were fitted.
    pub(super) fn windows(&self) -> usize {
        self.members.len()
    }

    /// Independent samples.
    fn samples(&self) -> f64 {
        self.members.iter().map(|member| member.window.rows()).sum::<f64>() / self.shared
    }

    /// Descends to the least sum of squared errors.
    pub(super) fn descended(mut self) -> Self {
        /// Steps at most, and the change of a logarithm that is none.
        const STEPS: usize = 25;
        const CLOSE: f64 = 1e-4;
        let mut lines = self.linearised(&self.constants);
        for _ in 0..STEPS {
            self.sse = lines.iter().map(|line| line.sse).sum();
            let Some(step) = self.step(&lines) else { break };
            let Some((next, found)) = self.better(&lines, &step) else { break };
            (self, lines) = (next, found);
            if step.iter().all(|by| by.abs() < CLOSE) {
                break;
            }
        }
        self.sse = lines.iter().map(|line| line.sse).sum();
        self
    }

    /// A part of Gauss and Newton's step that lessens the error.
    fn better(&self, lines: &[Linearised], step: &[f64]) -> Option<(Self, Vec<Linearised>)> {
        /// Parts that are tried.
        const PARTS: [f64; 4] = [1.0, 0.4, 0.1, 0.01];
        PARTS.into_iter().find_map(|part| {
            let step: Vec<f64> = step.iter().map(|by| part * by).collect();
            let mut next = self.clone();
            next.constants = self.constants.moved(&step);
            for (member, line) in next.members.iter_mut().zip(lines) {
                member.move_onset(&line.equations, &step, part);
            }
            let found = next.linearised(&next.constants);
            let sse: f64 = found.iter().map(|line| line.sse).sum();
            (sse < self.sse).then_some((next, found))
        })
    }

    fn linearised(&self, constants: &TimeConstants) -> Vec<Linearised> {
        let trial = |member: &Member<'_>| self.trials.get(member.trial);
        let members = self.members.iter().filter_map(|member| Some((member, trial(member)?)));
        members.map(|(member, trial)| member.linearised(trial, constants)).collect()
    }

    /// Gauss and Newton's step of the parameters; none where it is not determined.
    fn step(&mut self, lines: &[Linearised]) -> Option<Vec<f64>> {
        /// The longest change of a logarithm.
        const LONGEST: f64 = 0.5;
        /// Marquardt's damping, just enough that parameters which do the same can be solved for.
        const DAMPING: f64 = 1e-9;
        let count = self.constants.parameters();
        let sum = |i: usize, j: usize| -> f64 {
            lines.iter().map(|line| line.equations.at(1 + i.min(j), 1 + i.max(j))).sum()
        };
        let damped = |i, j| sum(i, j) * if i == j { 1.0 + DAMPING } else { 1.0 };
        let products = DMatrix::from_fn(count, count, damped);
        let with = DVector::from_fn(count, |i, _| sum(i, count));
        self.inverse = products.try_inverse()?;
        let step = &self.inverse * with;
        let is_finite = step.iter().all(|by| by.is_finite());
        is_finite.then(|| step.iter().map(|by| by.clamp(-LONGEST, LONGEST)).collect())
    }

    /// The noise of the residual, where it was taken for white.
    pub(super) fn noise(&self) -> NoiseModel {
        /// Windows that are enough.
        const ENOUGH: usize = 100;
        let every = self.members.len().div_ceil(ENOUGH).max(1);
        let projection = |member: &Member<'_>| {
            let constants = self.trials.get(member.trial)?.about(member.index, &self.constants);
            Some(member.window.projection(&constants, member.onset))
        };
        let some = self.members.iter().step_by(every);
        NoiseModel::of_projections(&some.filter_map(projection).collect::<Vec<_>>())
    }

    /// Twice the logarithm of the likelihood ratio of another law.
    pub(super) fn gain(&self, other: &Self) -> f64 {
        self.samples() * (self.sse / other.sse.max(f64::MIN_POSITIVE)).ln()
    }

    /// Schwarz's penalty for a parameter.
    pub(super) fn penalty(&self) -> f64 {
        self.samples().ln()
    }

    /// This with other time constants to start from, every onset earlier by so many samples.
    pub(super) fn started_at(&self, constants: TimeConstants, earlier: f64) -> Self {
        let count = constants.parameters();
        let inverse = self.inverse.clone().resize(count, count, 0.0);
        let mut next = Self { constants, inverse, ..self.clone() };
        for member in &mut next.members {
            let (low, high) = member.limits;
            member.onset = (member.onset - earlier).clamp(low, high);
        }
        next
    }

    /// Variance of the residuals of the law.
    pub(super) fn variance(&self) -> f64 {
        /// Parameters of a window: two levels, two decays and the onset.
        const LINEAR: f64 = 5.0;
        let freedom: f64 = self.members.iter().map(|it| it.window.rows() - LINEAR).sum();
        self.sse / freedom.max(1.0)
    }

    /// Covariance of the parameters.
    pub(super) fn covariance(&self) -> DMatrix<f64> {
        // Each sample was counted in as many windows.
        &self.inverse * (self.shared * self.variance())
    }

    /// The squared error about straight lines that break once, in the same windows.
    pub(super) fn sse_of_lines(&self) -> f64 {
        let white = NoiseModel::white();
        let error = |member: &Member<'_>| {
            let trial = self.trials.get(member.trial)?;
            let start = floor_to_index(member.start);
            let values = trial.output.get(start..start + member.window.len())?;
            let window = Window::of(values, &white)?;
            Some(window.best(window.positions())?.sse)
        };
        self.members.iter().filter_map(error).sum()
    }
}

/// The window of a step that reacts, where it has one.
fn member<'a>(
    number: usize,
    trial: &'a SettlingTrial<'a>,
    index: usize,
    noise: &'a NoiseModel,
) -> Option<Member<'a>> {
    let onset = trial.path.onsets.get(index).filter(|onset| onset.counts)?;
    let range = trial.path.window(index);
    let window = StepWindow::of(trial.output.get(range.clone())?, noise)?;
    let limits = trial.limits(index, &range)?;
    let start = range.start as f64;
    let onset = (onset.position - start).clamp(limits.0, limits.1);
    Some(Member { trial: number, index, window, start, limits, onset })
}

impl Member<'_> {
    fn linearised(&self, trial: &SettlingTrial<'_>, constants: &TimeConstants) -> Linearised {
        let about = trial.about(self.index, constants);
        let residual = self.window.residual(&about, self.onset);
        let mut columns = self.window.onset_slope(&about, self.onset);
        for index in 0..constants.parameters() {
            columns.extend(self.slope(trial, constants, index));
        }
        columns.extend(residual.iter().map(|value| -value));
        let mut equations = NormalEquations::of(&columns, self.window.len(), &[]);
        // The onset is this window's own.
        equations.eliminate(0);
        Linearised { sse: dot(&residual, &residual), equations }
    }

    /// How the residual changes with a parameter.
    fn slope(
        &self,
        trial: &SettlingTrial<'_>,
        constants: &TimeConstants,
        index: usize,
    ) -> Vec<f64> {
        /// Change of the logarithm to each side.
        const STEP: f64 = 1e-3;
        let at = |by: f64| {
            let about = trial.about(self.index, &constants.moved_one(index, by));
            self.window.residual(&about, self.onset)
        };
        at(STEP).iter().zip(at(-STEP)).map(|(a, b)| (a - b) / (2.0 * STEP)).collect()
    }

    /// Gauss and Newton's step of the onset, given that of the parameters.
    fn move_onset(&mut self, equations: &NormalEquations, step: &[f64], part: f64) {
        /// Samples, and a part of the window, beyond which the linearisation is no guide.
        const LONGEST: f64 = 3.0;
        const PART: f64 = 0.05;
        let given: Vec<(usize, f64)> = (1..).zip(step.iter().map(|by| by / part)).collect();
        let moved = equations.coefficients(1, &given).first().copied().unwrap_or(0.0);
        let longest = LONGEST.max(PART * self.window.len() as f64);
        let moved = part * moved.clamp(-longest, longest);
        let (low, high) = self.limits;
        self.onset = (self.onset + moved).clamp(low, high);
    }
}
