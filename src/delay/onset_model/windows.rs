//! The windows of a joint's steps, and one pass over them.
//!
//! The window of a step runs from the onset before it to the onset after it, so that it holds one
//! onset, its own; each pass finds every onset between its neighbours, which the next pass takes
//! for the ends of the windows.

use std::ops::Range;

use super::dynamics::{Before, Fit, Jump, Response};
use super::shape::{Shape, Shapes};
use crate::delay::neutral::Transition;
use crate::numerics::halved;
use crate::units::{ceil_to_index, floor_to_index};

/// Samples at the ends of a window at which there is no onset: with one sample beyond it, any
/// change of slope fits.
pub(super) const MARGIN: usize = 2;

/// Samples before a step that show what was under way.
const SEEN: f64 = 10.0;

/// How finely an onset is found, samples.
const FINE: f64 = 0.002;

/// Halvings of a sample after which an end of an interval is known as finely.
const HALVINGS: usize = 10;

/// Positions over a window that are looked at before the best one is searched finely.
const COARSE: usize = 100;

/// A step of the input, and what bounds the reaction to it; positions are indices of its trial.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) kind: Transition,
    /// The first sample with the new level; between samples where some are left out.
    pub(super) at: f64,
    pub(super) before: f64,
    pub(super) after: f64,
    /// The first, and one after the last, sample that says something of it.
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

    /// 0 down, 1 up.
    pub(super) fn direction(&self) -> usize {
        usize::from(self.change() > 0.0)
    }
}

/// A trial as it is fitted.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) output: Vec<f64>,
    pub(super) steps: Vec<Step>,
    /// Whether it is one window, all of which says something of its step.
    pub(super) is_window: bool,
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

/// The onsets of one run.
#[derive(Clone, Debug)]
pub(super) struct Onsets {
    /// Where each is taken to be for the ends of windows.
    pub(super) positions: Vec<f64>,
    pub(super) found: Vec<Option<Onset>>,
    /// The windows, where they are to stay.
    windows: Option<Vec<(usize, usize)>>,
}

/// All onsets that were found, with their runs and the numbers of their steps.
pub(super) fn all<'a>(
    runs: &'a [Run],
    onsets: &'a [Onsets],
) -> impl Iterator<Item = (&'a Run, usize, &'a Onset)> + Clone {
    runs.iter().zip(onsets).flat_map(|(run, onsets)| {
        let found = onsets.found.iter().enumerate();
        found.filter_map(move |(index, onset)| Some((run, index, onset.as_ref()?)))
    })
}

/// A shape, and what its windows go by.
pub(super) struct Pass {
    /// The responses to the kinds of steps, each shape once.
    pub(super) responses: Vec<(Shape, Box<dyn Response>)>,
    pub(super) shapes: Shapes,
    /// Samples to each side of an onset that are looked at.
    pub(super) reach: usize,
    /// The delay at which an onset that is not clear is taken to be.
    pub(super) typical: f64,
    pub(super) noise: f64,
    /// What was under way before a record.
    pub(super) before: Before,
}

impl Onsets {
    /// All of them so many samples after their steps.
    pub(super) fn behind(run: &Run, delay: f64) -> Self {
        Self::at(run.steps.iter().map(|step| step.at + delay).collect())
    }

    /// Where they are taken to be.
    pub(super) fn at(positions: Vec<f64>) -> Self {
        Self { found: vec![None; positions.len()], positions, windows: None }
    }

    /// These, so many samples later.
    pub(super) fn later(&self, by: f64) -> Self {
        let positions = self.positions.iter().map(|position| position + by).collect();
        Self { positions, ..self.clone() }
    }

    /// These with all windows where they are.
    pub(super) fn held(&self, run: &Run, pass: &Pass) -> Self {
        let steps = 0..self.positions.len();
        let windows = steps.map(|index| pass.window(run, &self.positions, index)).collect();
        Self { windows: Some(windows), ..self.clone() }
    }

    /// Finds each onset of a range of steps between its neighbours.
    pub(super) fn sweep(&mut self, run: &Run, range: Range<usize>, pass: &Pass) {
        for index in range {
            let held = self.windows.as_ref().map(|windows| windows[index]);
            let window = held.unwrap_or_else(|| pass.window(run, &self.positions, index));
            let onset = pass.find(run, index, window);
            self.found[index] = onset;
            let Some(onset) = onset else { continue };
            let before = index.checked_sub(1).map_or(f64::MIN, |before| self.positions[before]);
            let next = self.positions.get(index + 1).copied().unwrap_or(f64::MAX);
            // One that says nothing of where it is does not bound its neighbours.
            self.positions[index] = if onset.is_clear {
                onset.position
            } else {
                (run.steps[index].at + pass.typical).max(before).min(next.max(before))
            };
        }
    }

    /// Gives reactions back to the steps that made them, where one step has none since those before it
    /// have each taken the next one's.
    pub(super) fn reassign(&mut self, run: &Run, pass: &Pass) {
        for last in 1..run.steps.len() {
            if self.found[last].is_some_and(|onset| !onset.is_clear) {
                self.shift(run, last, pass);
            }
        }
    }

    /// Moves the onsets up to the step `last` to the next step each, as far as they lie after it, and
    /// finds another for the first of these steps, if less is left over then.
    fn shift(&mut self, run: &Run, last: usize, pass: &Pass) {
        /// Steps of a chain at most (chosen).
        const LONGEST: usize = 12;
        let taken = |index: &usize| self.positions[index - 1] > run.steps[*index].at;
        let links = (1..=last).rev().take_while(taken).take(LONGEST).count();
        let first = last - links;
        if links == 0 {
            return;
        }
        let affected = first.saturating_sub(1)..(last + 2).min(self.found.len());
        let before = self.clone();
        self.positions.copy_within(first..last, first + 1);
        let earliest = first.checked_sub(1).map_or(0.0, |before| self.positions[before]);
        self.positions[first] =
            (run.steps[first].at + pass.typical).max(earliest).min(self.positions[first + 1]);
        (0..2).for_each(|_| self.sweep(run, affected.clone(), pass));
        if self.lack(affected.clone()) >= before.lack(affected) {
            *self = before;
        }
    }

    /// What is left over in windows: the negative logarithm of their likelihood, for a sample.
    fn lack(&self, range: Range<usize>) -> f64 {
        let found = self.found[range].iter().flatten();
        let (sum, samples) = found.fold((0.0, 0.0), |(sum, samples), onset| {
            let log = onset.mean_square().max(f64::MIN_POSITIVE).ln();
            (sum + onset.samples() as f64 * log, samples + onset.samples() as f64)
        });
        sum / f64::max(samples, 1.0)
    }
}

impl Pass {
    /// The response to a kind of step.
    pub(super) fn response(&self, kind: Transition) -> &dyn Response {
        let shape = self.shapes.of(kind);
        let found = self.responses.iter().find(|(known, _)| *known == shape);
        found.unwrap_or(&self.responses[0]).1.as_ref()
    }

    /// The window of a step, given where the onsets are taken to be.
    pub(super) fn window(&self, run: &Run, positions: &[f64], index: usize) -> (usize, usize) {
        /// Samples of the first and the last window at least, where the record may hold a reaction to
        /// what came before it, or, of an output that leads its input, to what comes after it.
        const FEWEST: f64 = 10.0;
        let n = run.output.len();
        if run.is_window {
            return (0, n);
        }
        let (here, step) = (positions[index], &run.steps[index]);
        // What begins before a record with a few steps is most of it.
        let edge = if self.before == Before::Steady { 0.0 } else { self.typical };
        let start = match index.checked_sub(1) {
            Some(before) => positions[before],
            None => edge.min(here - FEWEST),
        };
        let end = match positions.get(index + 1) {
            Some(next) => next.floor() + 1.0,
            None => (n as f64 + edge.min(0.0)).max(here + FEWEST),
        };
        let reach = self.reach as f64;
        let start = ceil_to_index(start.max(here - reach).max(step.first).max(0.0));
        let end = floor_to_index(end.min(here + reach).min(step.end).max(0.0)).min(n);
        (start, end)
    }

    fn fit(
        &self,
        run: &Run,
        index: usize,
        (start, end): (usize, usize),
    ) -> Option<Box<dyn Fit + '_>> {
        let values = run.output.get(start..end)?;
        let step = &run.steps[index];
        let shape = self.shapes.of(step.kind);
        let ends = shape.lasts(step.change());
        // A level to which an output was on its way before is seen in the samples before its step.
        let is_hidden = shape.family.may_be_curved() || step.at < SEEN;
        let is_steady = self.before == Before::Steady && index == 0 && is_hidden;
        let before = if is_steady { Before::Steady } else { Before::Any };
        self.response(step.kind).window(values, ends, before)
    }

    /// Finds the onset of the step `index` of a run in its window.
    fn find(&self, run: &Run, index: usize, (start, end): (usize, usize)) -> Option<Onset> {
        /// Times the noise that three parameters gain, from which an onset is clear (chosen).
        const CLEAR: f64 = 12.0;
        // A joint that goes on resting has no onset.
        if run.steps[index].rests {
            return None;
        }
        let fit = self.fit(run, index, (start, end))?;
        let first = MARGIN as f64;
        let last = ((end - start - 1 - MARGIN) as f64).min(run.steps[index].latest - start as f64);
        if last < first {
            return None;
        }
        let (position, jump) = best(fit.as_ref(), first, last);
        let parameters = self.response(run.steps[index].kind).parameters();
        let freedom = (fit.samples() as f64 - parameters as f64).max(1.0);
        let noise = (jump.sse / freedom).max(0.25 * self.noise * self.noise);
        let inside = position > first + 0.5 && position < last - 0.5;
        Some(Onset {
            position: start as f64 + position,
            sse: jump.sse,
            sse_without: fit.sse_without(),
            size: jump.size,
            information: jump.information,
            start,
            end,
            is_clear: inside && fit.sse_without() - jump.sse > CLEAR * noise,
        })
    }

    /// The mean squared error with the onsets where they are taken to be.
    pub(super) fn mean_square(&self, runs: &[Run], onsets: &[Onsets]) -> f64 {
        let (mut sse, mut samples) = (0.0, 0.0);
        for (run, Onsets { positions, .. }) in runs.iter().zip(onsets) {
            for (index, position) in positions.iter().enumerate() {
                let (start, end) = self.window(run, positions, index);
                let here = position - start as f64;
                if here < MARGIN as f64 || here > end as f64 - start as f64 - MARGIN as f64 {
                    continue;
                }
                let Some(fit) = self.fit(run, index, (start, end)) else { continue };
                sse += fit.at(here).sse;
                samples += fit.samples() as f64;
            }
        }
        if samples > 0.0 { sse / samples } else { f64::INFINITY }
    }

    /// What is fitted to the window of an onset.
    pub(super) fn fitted(&self, run: &Run, index: usize, onset: &Onset) -> Vec<f64> {
        let fit = self.fit(run, index, (onset.start, onset.end));
        fit.map_or_else(Vec::new, |fit| fit.fitted(onset.position - onset.start as f64))
    }

    /// How far from the onset the squared error is below `limit`, to both sides.
    pub(super) fn extent(&self, run: &Run, index: usize, onset: &Onset, limit: f64) -> (f64, f64) {
        let Some(fit) = self.fit(run, index, (onset.start, onset.end)) else {
            return (f64::INFINITY, f64::INFINITY);
        };
        let here = onset.position - onset.start as f64;
        let last = fit.samples() as f64 - 1.5;
        let below = |distance: f64, sign: f64| {
            let position = here + sign * distance;
            (0.5..=last).contains(&position) && fit.at(position).sse <= limit
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
            let (low, high) = halved((inside, inside + 1.0), HALVINGS, |place| below(place, sign));
            f64::midpoint(low, high)
        };
        (side(-1.0), side(1.0))
    }
}

/// The best onset between two positions of a window.
pub(super) fn best(fit: &dyn Fit, first: f64, last: f64) -> (f64, Jump) {
    let stride = (fit.samples() / COARSE).max(1) as f64;
    let mut best = (first, fit.at(first));
    let try_at = |position: f64, best: &mut (f64, Jump)| {
        let jump = fit.at(position);
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
