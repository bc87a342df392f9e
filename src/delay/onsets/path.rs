//! Where the output reacts to each step, roughly and all at once.
//!
//! Between two reactions the output is about a line. Which reaction belongs to which step
//! is determined by the cheapest path of lines through the whole trial (dynamic programming),
//! first over few positions for each reaction, then over some about the best ones. So holds
//! may be shorter than delays. What is found only has to be good enough for windows.

use std::ops::Range;

use super::costs::{LONGEST_MOTION, Pieces, lateness};
use super::onset::Onset;
use crate::delay::lag::{FreeMotion, LagModel, Response};
use crate::delay::prepared::Prepared;
use crate::delay::settings::Settings;
use crate::delay::steps::InputStep;
use crate::units::ceil_to_index;

/// The onsets of all steps, and how many samples there are.
#[derive(Clone, Debug)]
pub(crate) struct OnsetPath {
    pub(crate) onsets: Vec<Onset>,
    samples: usize,
}

/// Steps to either side, at most, whose samples a step is seen among; chosen: on eleven logs, ten of
/// them measured, each decision stays the same.
const REACH: usize = 10;

impl OnsetPath {
    /// The reactions to the steps of `trial`.
    pub(crate) fn of(trial: &Prepared<'_>, settings: &Settings) -> Self {
        let output = trial.output();
        let samples = output.len();
        let mut path = Self { onsets: onsets(samples, &trial.steps, settings), samples };
        for (onset, motion) in path.onsets.iter_mut().zip(&trial.motions) {
            if let Some(motion) = motion {
                onset.narrow(motion);
            }
        }
        if settings.max_delay.is_none() && path.onsets.iter().any(|onset| !onset.alone) {
            path.connect(output, &Pieces::Lines);
        }
        path
    }

    /// The reactions of an output that settles with a time constant in samples. Its rest is but a
    /// level at which it has settled: it bounds nothing.
    pub(crate) fn settling(trial: &Prepared<'_>, settings: &Settings, time_constant: f64) -> Self {
        let output = trial.output();
        let samples = output.len();
        let mut path = Self { onsets: onsets(samples, &trial.steps, settings), samples };
        if settings.max_delay.is_none() {
            let longest = output.len().min(LONGEST_MOTION);
            path.connect(output, &Pieces::Motions(FreeMotion::to_a_level(time_constant, longest)));
        }
        path
    }

    /// The onsets where they are cheapest behind a lag.
    pub(crate) fn behind(mut self, model: &LagModel, output: &[f64]) -> Self {
        let onsets = self.onsets.iter().zip(self.onsets.iter().skip(2));
        let longest = onsets.map(|(onset, later)| later.latest - onset.origin).max();
        let longest = longest.unwrap_or(output.len()).min(LONGEST_MOTION);
        let pieces = Pieces::Motions(FreeMotion::of(model, longest));
        self.relocate(output, lateness(output), &pieces);
        self
    }

    /// Each onset earlier by as much as this lag is late.
    pub(crate) fn without(mut self, model: &LagModel) -> Self {
        let late = Response::of(model).mean;
        for onset in &mut self.onsets {
            onset.position = (onset.position - late).max(onset.earliest as f64);
        }
        self
    }

    /// Whether nine of ten reactions have room before the next step of the input. Some
    /// others are where nothing happened; then neighbours are known well enough at once.
    pub(crate) fn in_time(&self) -> bool {
        let in_time = self.onsets.iter().filter(|onset| onset.in_time()).count();
        10 * in_time >= 9 * self.onsets.len()
    }

    /// Whether most positions are known so well that neighbours need not be searched again.
    pub(crate) fn is_fine(&self) -> bool {
        /// Samples.
        const FINE: f64 = 0.5;
        let fine = self.onsets.iter().filter(|onset| onset.error <= FINE).count();
        2 * fine >= self.onsets.len()
    }

    /// The nearest onset before `index` that counts.
    pub(crate) fn before(&self, index: usize) -> Option<usize> {
        (0..index).rev().find(|before| self.counts(*before))
    }

    /// The nearest onset after `index` that counts.
    pub(crate) fn after(&self, index: usize) -> Option<usize> {
        (index + 1..self.onsets.len()).find(|after| self.counts(*after))
    }

    fn counts(&self, index: usize) -> bool {
        self.onsets[index].counts
    }

    /// The samples between the neighbours of onset `index` that count.
    pub(crate) fn window(&self, index: usize) -> Range<usize> {
        let after = self.after(index).map(|after| ceil_to_index(self.onsets[after].position));
        self.window_until(index, after.unwrap_or(self.samples))
    }

    /// The samples up to the next onset while that is known but roughly: it cannot be before
    /// the input changes.
    pub(crate) fn cautious_window(&self, index: usize) -> Range<usize> {
        /// Samples by which the next reaction may be off.
        const GUARD: usize = 4;
        let onset = &self.onsets[index];
        let next = self.onsets.get(index + 1);
        let next = next.map(|next| ceil_to_index(next.position).saturating_sub(GUARD));
        let end = if onset.in_time() { onset.next } else { next.unwrap_or(self.samples) };
        self.window_until(index, end)
    }

    /// A window of no more than [`REACH`] steps to either side: where none of hundreds counts, each
    /// would else see the whole trial.
    fn window_until(&self, index: usize, end: usize) -> Range<usize> {
        let lowest = index.checked_sub(REACH).map_or(0, |far| self.onsets[far].origin);
        let highest = self.onsets.get(index + REACH).map_or(self.samples, |far| far.next);
        let before = self.before(index);
        let start = before.map_or(0, |before| ceil_to_index(self.onsets[before].position));
        let (first, last) = self.onsets[index].within;
        let start = start.max(first).max(lowest);
        start..end.min(last).min(highest).max(start)
    }

    /// Puts every onset at its position in the cheapest path of `pieces`.
    ///
    /// At first every reaction is taken to come before the next step; where a hold is not
    /// long beside the delays that gives, it may also come later.
    fn connect(&mut self, output: &[f64], pieces: &Pieces) {
        let late = lateness(output);
        let latest: Vec<usize> = self.onsets.iter().map(|onset| onset.latest).collect();
        for onset in &mut self.onsets {
            onset.latest = onset.latest.min(onset.next);
        }
        self.relocate(output, late, pieces);
        let longest = self.longest_delay();
        let mut any_late = false;
        for (onset, latest) in self.onsets.iter_mut().zip(latest) {
            if onset.next - onset.origin < longest {
                onset.latest = latest.min(onset.origin + longest);
                any_late = true;
            }
        }
        if any_late {
            self.relocate(output, late, pieces);
        }
    }

    /// A delay that few will exceed.
    fn longest_delay(&self) -> usize {
        let delay = |onset: &Onset| ceil_to_index(onset.position) - onset.origin;
        let mut delays: Vec<usize> = self.onsets.iter().map(delay).collect();
        let middle = delays.len() / 2;
        delays.sort_unstable();
        delays.get(middle).map_or(0, |median| 2 * median + 10)
    }

    /// Puts every onset at its position, with the positions that it may have.
    fn relocate(&mut self, output: &[f64], late: f64, pieces: &Pieces) {
        let coarse: Vec<Vec<usize>> = self.onsets.iter().map(Onset::spread).collect();
        let found = cheapest(output, &self.onsets, &coarse, late, pieces);
        let fine = self.onsets.iter().zip(&coarse).zip(&found);
        let fine: Vec<Vec<usize>> =
            fine.map(|((onset, tried), at)| onset.around(tried, *at)).collect();
        let found = cheapest(output, &self.onsets, &fine, late, pieces);
        for (onset, position) in self.onsets.iter_mut().zip(found) {
            onset.position = position as f64;
        }
    }
}

fn onsets(samples: usize, steps: &[InputStep], settings: &Settings) -> Vec<Onset> {
    let nexts = steps.iter().skip(1).map(|next| next.sample - 1).chain([samples]);
    let holds = steps.iter().zip(nexts.clone()).map(|(step, next)| next + 1 - step.sample);
    // One long pause must not widen where every onset may be.
    let longest = usual_longest(holds.collect());
    let onset = |(step, next): (&InputStep, usize)| {
        let origin = step.sample - 1;
        let reach = settings.max_delay.unwrap_or(longest + longest / 2);
        let latest =
            origin.saturating_add(reach).max(if settings.max_delay.is_some() { 0 } else { next });
        let latest =
            latest.saturating_add(if settings.max_delay.is_some() { 0 } else { settings.alpha });
        let latest = latest.min(samples.saturating_sub(2));
        let within = match settings.max_delay {
            None => (0, samples),
            Some(delay) => {
                let last =
                    origin.saturating_add(delay).saturating_add(settings.alpha).saturating_add(1);
                (origin.saturating_sub(settings.alpha), last.min(samples))
            }
        };
        let earliest = origin.saturating_sub(settings.alpha);
        let position = origin.midpoint(latest.min(next)) as f64;
        Onset {
            origin,
            earliest,
            latest,
            within,
            next,
            position,
            error: 0.0,
            counts: true,
            at_rest: false,
            alone: false,
        }
    };
    steps.iter().zip(nexts).map(onset).collect()
}

/// A hold that is longer than nine of ten.
fn usual_longest(mut holds: Vec<usize>) -> usize {
    holds.sort_unstable();
    holds.get(holds.len() * 9 / 10).copied().unwrap_or(0)
}

/// The cheapest path of `pieces` through one of the `tried` positions of each onset; a
/// reaction `late`, after the next step of the input, costs that much more.
fn cheapest(
    output: &[f64],
    onsets: &[Onset],
    tried: &[Vec<usize>],
    late: f64,
    pieces: &Pieces,
) -> Vec<usize> {
    let start = vec![0];
    let mut before = (&start, vec![0.0]);
    let mut ways: Vec<Vec<usize>> = Vec::with_capacity(onsets.len());
    let end = vec![output.len()];
    let all = onsets.iter().map(|onset| onset.next).chain([usize::MAX]);
    for (positions, next) in tried.iter().chain([&end]).zip(all) {
        let (from, costs) = (before.0, &before.1);
        let mut best = vec![(f64::INFINITY, 0); positions.len()];
        let errors = pieces.errors(output, from, positions);
        let errors = errors.chunks_exact(positions.len().max(1));
        for (way, (errors, cost)) in errors.zip(costs).enumerate() {
            for (best, error) in best.iter_mut().zip(errors) {
                // Bellman: the cheapest way to a position goes on from the cheapest ways to those
                // before it.
                if cost + error < best.0 {
                    *best = (cost + error, way);
                }
            }
        }
        let late = |position: &usize| if *position > next { late } else { 0.0 };
        let late = positions.iter().map(late);
        let (mut costs, way): (Vec<f64>, Vec<usize>) =
            best.into_iter().zip(late).map(|((cost, way), late)| (cost + late, way)).unzip();
        // Steps too close for any path: go on from here as if they had none.
        if costs.iter().all(|cost| cost.is_infinite()) {
            costs.fill(0.0);
        }
        ways.push(way);
        before = (positions, costs);
    }
    back(tried, &ways)
}

/// The positions on the way back from the end.
fn back(tried: &[Vec<usize>], ways: &[Vec<usize>]) -> Vec<usize> {
    // The last way leads to the only end; each before it to the onset of the same index.
    let mut index = ways[tried.len()][0];
    let mut found: Vec<usize> = Vec::with_capacity(tried.len());
    for (positions, way) in tried.iter().zip(ways).rev() {
        found.push(positions[index]);
        index = way[index];
    }
    found.reverse();
    found
}
