//! Onsets behind a known lag: each fitted together with its neighbours, again and again.

use std::ops::Range;

use super::locate::DOUBTFUL;
use super::path::OnsetPath;
use crate::delay::broken_line;
use crate::delay::lag::{Basis, FINE, FitWindow, LagModel, Linearised};
use crate::numerics::NoiseModel;

/// Times that all onsets are fitted where holds are short; chosen (`tests/delays/delay_methods.rs`, holds shorter than delay and lag).
const PASSES: usize = 3;

/// Samples by which an onset that only bounds its neighbours may still move.
const ROUGHLY: f64 = 0.2;

/// What [`DOUBTFUL`] is where holds are short: a small reaction left out spoils its neighbours
/// more than one that isn't there.
const DOUBTFUL_IF_SHORT: f64 = 0.3;

/// The onsets of a trial behind a known lag.
pub(crate) struct Refinement<'a> {
    pub(crate) output: &'a [f64],
    pub(crate) path: OnsetPath,
    pub(crate) basis: Basis,
    pub(crate) noise: NoiseModel,
    /// Whether holds are long beside delays.
    in_time: bool,
}

/// An onset fitted between its neighbours.
pub(crate) struct RefinedOnset<'a> {
    /// The samples that it was fitted to.
    pub(crate) range: Range<usize>,
    pub(crate) window: FitWindow<'a>,
    pub(crate) fit: Linearised,
}

impl<'a> Refinement<'a> {
    /// Behind this lag, from about where the onsets are.
    pub(crate) fn of(
        output: &'a [f64],
        path: OnsetPath,
        model: LagModel,
        noise: NoiseModel,
    ) -> Self {
        let in_time = path.in_time();
        let basis = Basis::of(&model, output.len());
        Self { output, path, basis, noise, in_time }
    }

    /// All onsets fitted between the neighbours of the pass before, `times` or, where holds
    /// are short, some more.
    pub(crate) fn refined(mut self, times: usize) -> Self {
        let passes = if self.in_time { times } else { PASSES };
        for _ in 0..passes {
            self.noise = self.refine();
            self.in_time = self.path.in_time();
        }
        self
    }

    /// Fits every onset once; the noise of the residuals.
    fn refine(&mut self) -> NoiseModel {
        /// Windows that are enough to know the noise.
        const ENOUGH: usize = 100;
        // Where holds are short a rough onset may be taken for a neighbour's.
        let fine = if self.in_time { ROUGHLY } else { FINE };
        let doubtful = if self.in_time { DOUBTFUL } else { DOUBTFUL_IF_SHORT };
        let every = self.path.onsets.len().div_ceil(ENOUGH).max(1);
        let mut projections = Vec::new();
        for index in 0..self.path.onsets.len() {
            let Some(found) = self.fit(index, fine) else { continue };
            if index % every == 0 {
                projections.push(found.window.projection(&self.basis.model));
            }
            let p_value = self.p_value(index, &found);
            let onset = &mut self.path.onsets[index];
            onset.position = found.position();
            onset.counts = p_value <= doubtful && !onset.at_rest;
            onset.error = found.position_error();
        }
        NoiseModel::of_projections(&projections)
    }

    /// The onset of step `index`, with its neighbours where they are near, after a step of no
    /// more than `fine` samples.
    pub(crate) fn fit(&self, index: usize, fine: f64) -> Option<RefinedOnset<'a>> {
        let members = self.members(index);
        let (first, last) = members
            .iter()
            .fold((index, index), |(first, last), member| (first.min(*member), last.max(*member)));
        let range = self.path.window(first).start..self.path.window(last).end;
        let values = self.output.get(range.clone())?;
        let position = |member: &usize| self.path.onsets[*member].position - range.start as f64;
        let onsets: Vec<f64> = members.iter().map(position).collect();
        let limits: Vec<_> = members.iter().map(|member| self.limits(*member, &range)).collect();
        let columns = self.basis.response.modes() + 2 * onsets.len();
        if values.len() < 2 * columns + broken_line::FEWEST {
            return None;
        }
        let mut window = FitWindow::alone(values, onsets);
        let mut fit = window.minimise(&self.basis, &self.noise, &limits, fine);
        // Gauss and Newton find the nearest valley only.
        if members.len() > 1 || is_vague(&fit, values.len()) {
            self.look_around(&mut window, &mut fit, &limits, fine);
        }
        Some(RefinedOnset { range, window, fit })
    }

    /// The onset of an index, last, behind those of its neighbours whose transients it meets.
    fn members(&self, index: usize) -> Vec<usize> {
        /// Samples behind a transient that a line needs.
        const LINE: f64 = 20.0;
        let onsets = &self.path.onsets;
        let room = self.basis.response.settling_time() + LINE;
        let near = |other: &usize| (onsets[*other].position - onsets[index].position).abs() < room;
        let neighbours = [self.path.before(index), self.path.after(index)];
        neighbours.into_iter().flatten().filter(near).chain([index]).collect()
    }

    /// Where an onset may be, as indices of a window.
    fn limits(&self, index: usize, range: &Range<usize>) -> (f64, f64) {
        let onset = &self.path.onsets[index];
        let behind = |at: Option<usize>| Some(self.path.onsets[at?].position + 1.0);
        let start = range.start as f64;
        let low = behind(self.path.before(index)).unwrap_or(0.0).max(onset.earliest as f64);
        let high = behind(self.path.after(index)).unwrap_or(f64::INFINITY) - 2.0;
        let last = if self.in_time { onset.last_position() } else { onset.latest };
        let high = high.min(last as f64).min(range.end as f64 - 2.0);
        (low - start, (high - start).max(low - start))
    }

    /// Tries the last onset all over its limits, and goes on from where it is best.
    fn look_around(
        &self,
        window: &mut FitWindow<'a>,
        fit: &mut Linearised,
        limits: &[(f64, f64)],
        fine: f64,
    ) {
        /// Positions over the limits; chosen.
        const TRIED: u32 = 12;
        let (low, high) = limits[limits.len() - 1];
        let tried =
            (0..TRIED).map(|n| low + (high - low) * (f64::from(n) + 0.5) / f64::from(TRIED));
        let at = |position: f64| {
            let there = window.with_last_onset(position);
            (there.at(&self.basis, &self.noise).sse, there)
        };
        let best = tried.map(at).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, mut there)) = best else { return };
        let found = there.minimise(&self.basis, &self.noise, limits, fine);
        if found.sse < fit.sse {
            (*window, *fit) = (there, found);
        }
    }

    /// How often noise alone looks as much like this reaction.
    pub(crate) fn p_value(&self, index: usize, found: &RefinedOnset<'_>) -> f64 {
        let ends = self.limits(index, &found.range);
        // All but the onset and its change of speed, which are what noise may gain with.
        let others = found.fit.parameters() - 2;
        let rows = found.range.len().saturating_sub(self.noise.order()) as f64;
        let (dimensions, samples) = (rows - others as f64, found.range.len() as f64);
        broken_line::p_value(found.fit.share(), dimensions, samples, ends)
    }
}

/// Whether the last onset is known so badly that another valley may be better.
fn is_vague(fit: &Linearised, samples: usize) -> bool {
    /// Variance of the onset, samples squared: half a sample of standard error.
    const VAGUE: f64 = 0.25;
    let variance = fit.sse / samples as f64 * fit.onset_variance();
    variance.is_nan() || variance > VAGUE
}

impl RefinedOnset<'_> {
    /// Index in the trial.
    pub(crate) fn position(&self) -> f64 {
        self.range.start as f64 + self.window.last_onset()
    }

    /// Standard error of the position.
    fn position_error(&self) -> f64 {
        (self.fit.sse / self.range.len() as f64 * self.fit.onset_variance()).sqrt()
    }

    /// How far the onset may move, about as far as `guess`, until the squared error has
    /// grown by `growth`.
    pub(crate) fn reach(&self, guess: f64, growth: f64, basis: &Basis, noise: &NoiseModel) -> f64 {
        /// Half-widths in samples below which the error is a parabola.
        const PARABOLIC: f64 = 0.3;
        if guess.abs() < PARABOLIC || self.window.onsets.len() > 1 {
            return guess.abs();
        }
        let there = self.window.with_last_onset(self.window.last_onset() + guess);
        let grown = there.at(basis, noise).sse - self.fit.sse;
        // A parabola through the point that was tried: its error grows with the square.
        let ratio = (growth / grown.max(f64::MIN_POSITIVE)).sqrt();
        guess.abs() * ratio.clamp(0.5, 3.0)
    }
}
