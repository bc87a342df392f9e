//! The windows of a joint's steps, and one pass over them.
//!
//! The window of a step runs from the onset before it to the onset behind it, so that it holds one
//! onset, its own; each pass finds every onset between its neighbours, which the next pass takes
//! for the ends of the windows.

use std::ops::Range;

use super::dynamics::{Before, Dynamics, Jump, Window};
use super::shape::Shape;
use crate::units::{ceil_to_index, floor_to_index};

/// Samples at the ends of a window at which there is no onset: with one sample beyond it, any
/// change of slope fits.
pub(super) const MARGIN: usize = 2;

/// Samples before a step that show what was under way.
const SEEN: f64 = 10.0;

/// How finely an onset is found, samples.
const FINE: f64 = 0.01;

/// Positions over a window that are looked at before the best one is searched finely.
const COARSE: usize = 100;

/// A step of the input, and what bounds the reaction to it; positions are indices of its trial.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// The first sample with the new level; between samples where some are left out.
    pub(super) at: f64,
    pub(super) before: f64,
    pub(super) after: f64,
    /// The first and behind the last sample that says something of it.
    pub(super) first: f64,
    pub(super) end: f64,
    /// The last position that its onset may have.
    pub(super) latest: f64,
    /// Whether the joint went on resting, as at a stop.
    pub(super) rests: bool,
}

impl Step {
    pub(super) fn change(&self) -> f64 {
        self.after - self.before
    }
}

/// A trial as it is fitted.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) output: Vec<f64>,
    pub(super) steps: Vec<Step>,
}

/// The onset of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Onset {
    /// Index of its trial, between samples.
    pub(super) position: f64,
    /// Squared error of its window, and that without an onset.
    pub(super) sse: f64,
    pub(super) sse_without: f64,
    /// The change of the speed, or of the level to which the output settles.
    pub(super) size: f64,
    /// The inverse variance of its size, for noise of variance 1.
    pub(super) information: f64,
    /// Its window.
    pub(super) start: usize,
    pub(super) end: usize,
    /// Whether it is far more than noise, and not at an end of where it was looked for.
    pub(super) is_clear: bool,
}

impl Onset {
    pub(super) fn samples(&self) -> usize {
        self.end - self.start
    }

    /// Mean square of what the fit leaves over.
    pub(super) fn mean_square(&self) -> f64 {
        self.sse / self.samples() as f64
    }
}

/// Where each onset is taken to be for the ends of windows, and what was found; for each run.
#[derive(Clone, Debug)]
pub(super) struct Onsets {
    pub(super) positions: Vec<Vec<f64>>,
    pub(super) found: Vec<Vec<Option<Onset>>>,
}

/// What a pass goes by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass<'a> {
    pub(super) shape: Shape,
    /// Samples to each side of an onset that are looked at.
    pub(super) reach: usize,
    /// The delay at which an onset that is not clear is taken to be.
    pub(super) typical: f64,
    /// The delay of what begins before a record and ends behind it.
    pub(super) edge: f64,
    pub(super) noise: f64,
    /// What was under way before a record.
    pub(super) before: Before,
    /// The windows, where they are to stay.
    pub(super) windows: Option<&'a [Vec<(usize, usize)>]>,
}

/// What fits windows, whatever the size of its state.
pub(super) trait Fit: Sync {
    /// Parameters of each window.
    fn parameters(&self) -> usize;

    /// Finds the onset of a step, the `index` of a run of a `number`, between its neighbours.
    fn find(
        &self,
        run: &Run,
        positions: &[f64],
        at: (usize, usize),
        pass: &Pass<'_>,
    ) -> Option<Onset>;

    /// The mean squared error with the onsets where they are taken to be.
    fn mean_square(&self, runs: &[Run], positions: &[Vec<f64>], pass: &Pass<'_>) -> f64;

    /// What is fitted to the window of an onset.
    fn fitted(&self, run: &Run, index: usize, onset: &Onset, pass: &Pass<'_>) -> Vec<f64>;

    /// How far from the onset the squared error is below `limit`, to both sides.
    fn extent(
        &self,
        run: &Run,
        index: usize,
        onset: &Onset,
        pass: &Pass<'_>,
        limit: f64,
    ) -> (f64, f64);
}

/// The window of a step, given where the onsets are taken to be.
pub(super) fn window(
    run: &Run,
    positions: &[f64],
    index: usize,
    pass: &Pass<'_>,
) -> (usize, usize) {
    /// Samples of the first and the last window at least, where the record may hold a reaction to
    /// what came before it, or, of an output that leads its input, to what comes behind it.
    const FEWEST: f64 = 10.0;
    let n = run.output.len();
    let (here, step) = (positions[index], &run.steps[index]);
    let start = match index.checked_sub(1) {
        Some(before) => positions[before],
        None => pass.edge.min(here - FEWEST),
    };
    let end = match positions.get(index + 1) {
        Some(next) => next.floor() + 1.0,
        None => (n as f64 + pass.edge.min(0.0)).max(here + FEWEST),
    };
    let reach = pass.reach as f64;
    let start = ceil_to_index(start.max(here - reach).max(step.first).max(0.0));
    let end = floor_to_index(end.min(here + reach).min(step.end).max(0.0)).min(n);
    (start, end)
}

/// All windows, given where the onsets are taken to be.
pub(super) fn windows(
    runs: &[Run],
    positions: &[Vec<f64>],
    pass: &Pass<'_>,
) -> Vec<Vec<(usize, usize)>> {
    let of_run = |(run, positions): (&Run, &Vec<f64>)| {
        (0..positions.len()).map(|index| window(run, positions, index, pass)).collect()
    };
    runs.iter().zip(positions).map(of_run).collect()
}

/// The onsets of one run.
struct OfRun<'a> {
    run: &'a Run,
    number: usize,
    positions: &'a mut [f64],
    found: &'a mut [Option<Onset>],
}

impl Onsets {
    /// Finds each onset between its neighbours.
    pub(super) fn pass(&mut self, fit: &dyn Fit, runs: &[Run], pass: &Pass<'_>) {
        self.of_runs(runs).for_each(|mut of| of.sweep(fit, 0..of.run.steps.len(), pass));
    }

    /// Gives reactions back to the steps that made them, where one step has none since those before it
    /// have each taken the next one's.
    pub(super) fn reassign(&mut self, fit: &dyn Fit, runs: &[Run], pass: &Pass<'_>) {
        for mut of in self.of_runs(runs) {
            for last in 1..of.run.steps.len() {
                if of.found[last].is_some_and(|onset| !onset.is_clear) {
                    of.shift(fit, last, pass);
                }
            }
        }
    }

    fn of_runs<'a>(&'a mut self, runs: &'a [Run]) -> impl Iterator<Item = OfRun<'a>> {
        let all = runs.iter().zip(self.positions.iter_mut().zip(&mut self.found)).enumerate();
        all.map(|(number, (run, (positions, found)))| OfRun { run, number, positions, found })
    }
}

impl OfRun<'_> {
    fn sweep(&mut self, fit: &dyn Fit, range: Range<usize>, pass: &Pass<'_>) {
        for index in range {
            let onset = fit.find(self.run, self.positions, (self.number, index), pass);
            self.found[index] = onset;
            let Some(onset) = onset else { continue };
            let before = index.checked_sub(1).map_or(f64::MIN, |before| self.positions[before]);
            let next = self.positions.get(index + 1).copied().unwrap_or(f64::MAX);
            // One that says nothing of where it is does not bound its neighbours.
            self.positions[index] = if onset.is_clear {
                onset.position
            } else {
                (self.run.steps[index].at + pass.typical).max(before).min(next.max(before))
            };
        }
    }

    /// Moves the onsets up to the step `last` to the next step each, as far as they lie behind it, and
    /// finds another for the first of these steps, if less is left over then.
    fn shift(&mut self, fit: &dyn Fit, last: usize, pass: &Pass<'_>) {
        /// Steps of a chain at most (chosen).
        const LONGEST: usize = 12;
        let taken = |index: &usize| self.positions[index - 1] > self.run.steps[*index].at;
        let links = (1..=last).rev().take_while(taken).take(LONGEST).count();
        let first = last - links;
        if links == 0 {
            return;
        }
        let affected = first.saturating_sub(1)..(last + 2).min(self.found.len());
        let before =
            (self.positions[affected.clone()].to_vec(), self.found[affected.clone()].to_vec());
        let lacking = self.lack(affected.clone());
        self.positions.copy_within(first..last, first + 1);
        let earliest = first.checked_sub(1).map_or(0.0, |before| self.positions[before]);
        self.positions[first] =
            (self.run.steps[first].at + pass.typical).max(earliest).min(self.positions[first + 1]);
        (0..2).for_each(|_| self.sweep(fit, affected.clone(), pass));
        if self.lack(affected.clone()) >= lacking {
            self.positions[affected.clone()].copy_from_slice(&before.0);
            self.found[affected].copy_from_slice(&before.1);
        }
    }

    /// What is left over in windows: the negative logarithm of their likelihood.
    fn lack(&self, range: Range<usize>) -> f64 {
        let found = self.found[range].iter().flatten();
        found
            .map(|onset| onset.samples() as f64 * onset.mean_square().max(f64::MIN_POSITIVE).ln())
            .sum()
    }
}

impl<const N: usize> Dynamics<N> {
    /// The window of an onset, as sums.
    fn window_of(
        &self,
        run: &Run,
        index: usize,
        (start, end): (usize, usize),
        pass: &Pass<'_>,
    ) -> Option<Window<N>> {
        let values = run.output.get(start..end)?;
        let ends = pass.shape.lasts(run.steps[index].change());
        // A level to which an output was on its way before is seen in the samples before its step.
        let is_hidden = pass.shape.family.may_be_curved() || run.steps[index].at < SEEN;
        let is_steady = pass.before == Before::Steady && index == 0 && is_hidden;
        self.window(values, ends, if is_steady { Before::Steady } else { Before::Any })
    }

    /// The best onset between two positions of a window.
    pub(super) fn best(&self, window: &Window<N>, first: f64, last: f64) -> (f64, Jump) {
        let stride = (window.len() / COARSE).max(1) as f64;
        let mut best = (first, self.at(window, first));
        let try_at = |position: f64, best: &mut (f64, Jump)| {
            let jump = self.at(window, position);
            if jump.sse < best.1.sse {
                *best = (position, jump);
            }
        };
        let mut position = first + stride;
        while position <= last {
            try_at(position, &mut best);
            position += stride;
        }
        let mut step = stride / 2.0;
        while step > FINE {
            for near in [best.0 - step, best.0 + step] {
                if (first..=last).contains(&near) {
                    try_at(near, &mut best);
                }
            }
            step /= 2.0;
        }
        best
    }
}

impl<const N: usize> Fit for Dynamics<N> {
    fn parameters(&self) -> usize {
        self.parameters()
    }

    fn find(
        &self,
        run: &Run,
        positions: &[f64],
        at: (usize, usize),
        pass: &Pass<'_>,
    ) -> Option<Onset> {
        /// Times the noise that three parameters gain, from which an onset is clear (chosen).
        const CLEAR: f64 = 12.0;
        let (number, index) = at;
        // A joint that goes on resting has no onset.
        if run.steps[index].rests {
            return None;
        }
        let (start, end) = match pass.windows {
            Some(windows) => *windows.get(number)?.get(index)?,
            None => window(run, positions, index, pass),
        };
        let window = self.window_of(run, index, (start, end), pass)?;
        let first = MARGIN as f64;
        let last = ((end - start - 1 - MARGIN) as f64).min(run.steps[index].latest - start as f64);
        if last < first {
            return None;
        }
        let (position, jump) = self.best(&window, first, last);
        let freedom = (window.len() as f64 - self.parameters() as f64).max(1.0);
        let noise = (jump.sse / freedom).max(0.25 * pass.noise * pass.noise);
        let inside = position > first + 0.5 && position < last - 0.5;
        Some(Onset {
            position: start as f64 + position,
            sse: jump.sse,
            sse_without: window.sse_without,
            size: jump.size,
            information: jump.information,
            start,
            end,
            is_clear: inside && window.sse_without - jump.sse > CLEAR * noise,
        })
    }

    fn mean_square(&self, runs: &[Run], positions: &[Vec<f64>], pass: &Pass<'_>) -> f64 {
        let (mut sse, mut samples) = (0.0, 0.0);
        for (run, positions) in runs.iter().zip(positions) {
            for (index, position) in positions.iter().enumerate() {
                let (start, end) = window(run, positions, index, pass);
                let here = position - start as f64;
                if here < MARGIN as f64 || here > end as f64 - start as f64 - MARGIN as f64 {
                    continue;
                }
                let Some(window) = self.window_of(run, index, (start, end), pass) else {
                    continue;
                };
                sse += self.at(&window, here).sse;
                samples += window.len() as f64;
            }
        }
        if samples > 0.0 { sse / samples } else { f64::INFINITY }
    }

    fn fitted(&self, run: &Run, index: usize, onset: &Onset, pass: &Pass<'_>) -> Vec<f64> {
        let window = self.window_of(run, index, (onset.start, onset.end), pass);
        let here = onset.position - onset.start as f64;
        window.map_or_else(Vec::new, |window| self.fitted(&window, here))
    }

    fn extent(
        &self,
        run: &Run,
        index: usize,
        onset: &Onset,
        pass: &Pass<'_>,
        limit: f64,
    ) -> (f64, f64) {
        let Some(window) = self.window_of(run, index, (onset.start, onset.end), pass) else {
            return (f64::INFINITY, f64::INFINITY);
        };
        let here = onset.position - onset.start as f64;
        let last = window.len() as f64 - 1.5;
        let below = |distance: f64, sign: f64| {
            let position = here + sign * distance;
            (0.5..=last).contains(&position) && self.at(&window, position).sse <= limit
        };
        let side = |sign: f64| {
            // Samples between the positions that are looked at: finer near the onset.
            let (mut step, mut distance, mut inside) = (4.0 * FINE, 0.0, 0.0);
            let room = if sign < 0.0 { here - 0.5 } else { last - here };
            while distance + step <= room {
                distance += step;
                step = f64::min(1.3 * step, 1.0);
                if below(distance, sign) {
                    inside = distance;
                }
            }
            let (mut low, mut high) = (inside, inside + 1.0);
            while high - low > FINE / 2.0 {
                let middle = f64::midpoint(low, high);
                *(if below(middle, sign) { &mut low } else { &mut high }) = middle;
            }
            f64::midpoint(low, high)
        };
        (side(-1.0), side(1.0))
    }
}
