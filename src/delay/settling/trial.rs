//! The onsets of a trial whose output settles, for given time constants.

use std::ops::Range;

use super::constants::{InputChange, TimeConstants};
use super::response::Constants;
use super::window::StepWindow;
use crate::delay::broken_line;
use crate::delay::onsets::OnsetPath;
use crate::delay::prepared::Prepared;
use crate::delay::settings::Settings;
use crate::delay::steps::InputStep;
use crate::numerics::NoiseModel;

/// A reaction with a larger p-value does not bound its neighbours.
const DOUBTFUL: f64 = 0.01;

/// Samples between an onset and the ends of its window.
const MARGIN: f64 = 2.0;

/// A trial and where the output reacts to each of its steps.
#[derive(Clone, Debug)]
pub(super) struct SettlingTrial<'a> {
    pub(super) output: &'a [f64],
    pub(super) path: OnsetPath,
    changes: Vec<InputChange>,
}

/// An onset in its window; positions are indices of the window.
#[derive(Clone, Debug)]
pub(super) struct Found<'a> {
    pub(super) range: Range<usize>,
    pub(super) window: StepWindow<'a>,
    pub(super) constants: Constants,
    /// Where it may be.
    pub(super) limits: (f64, f64),
    pub(super) onset: f64,
    pub(super) sse: f64,
}

impl Found<'_> {
    /// Part of the squared error without a reaction that it removes.
    pub(super) fn explained(&self) -> f64 {
        let without = self.window.sse_without(&self.constants);
        1.0 - self.sse / without.max(f64::MIN_POSITIVE)
    }

    /// How often noise alone looks as much like a reaction as one that removes the part `explained`.
    pub(super) fn p_value(&self, explained: f64) -> f64 {
        let others = self.constants.columns() - 1;
        let samples = self.window.len() as f64;
        let dimensions = self.window.rows() - others as f64;
        broken_line::p_value(explained, dimensions, samples, self.limits)
    }
}

impl<'a> SettlingTrial<'a> {
    /// About where the onsets are: by the cheapest path of responses, then each between its
    /// neighbours.
    pub(super) fn of(
        trial: &'a Prepared<'_>,
        settings: &Settings,
        constants: &TimeConstants,
        noise: &NoiseModel,
    ) -> Self {
        let path = OnsetPath::settling(trial, settings, constants.rising);
        let change = |step: &InputStep| {
            if step.after > step.before { InputChange::Rise } else { InputChange::Fall }
        };
        let changes = trial.steps.iter().map(change).collect();
        // What a low-pass leaves of an onset is not its response: the output as it was measured.
        let mut found = Self { output: &trial.raw, path, changes };
        found.locate(constants, noise, OnsetPath::cautious_window);
        found.locate(constants, noise, OnsetPath::window);
        found
    }

    /// Finds each onset between its neighbours, in the window that is taken from the path.
    fn locate(
        &mut self,
        constants: &TimeConstants,
        noise: &NoiseModel,
        window: fn(&OnsetPath, usize) -> Range<usize>,
    ) {
        for index in 0..self.path.onsets.len() {
            let range = window(&self.path, index);
            let Some(found) = self.find(index, range, constants, noise) else { continue };
            let start = found.range.start as f64;
            let counts = found.p_value(found.explained()) <= DOUBTFUL;
            let error = found.window.standard_error(&found.constants, (found.onset, found.sse));
            let onset = &mut self.path.onsets[index];
            onset.position = start + found.onset;
            onset.counts = counts && !onset.at_rest;
            onset.error = error;
        }
    }

    /// The best onset of a step in a range of samples.
    pub(super) fn find<'n>(
        &self,
        index: usize,
        range: Range<usize>,
        constants: &TimeConstants,
        noise: &'n NoiseModel,
    ) -> Option<Found<'n>> {
        let window = StepWindow::of(self.output.get(range.clone())?, noise)?;
        let (constants, limits) = (self.about(index, constants), self.limits(index, &range)?);
        let (onset, sse) = window.best(&constants, limits.0, limits.1)?;
        Some(Found { range, window, constants, limits, onset, sse })
    }

    /// The time constants about a step.
    pub(super) fn about(&self, index: usize, constants: &TimeConstants) -> Constants {
        let change = |index: usize| self.changes.get(index).copied().unwrap_or(InputChange::Rise);
        let before = self.path.before(index).unwrap_or(index);
        constants.about(change(index), change(before))
    }

    /// Where an onset may be, as indices of its window.
    pub(super) fn limits(&self, index: usize, range: &Range<usize>) -> Option<(f64, f64)> {
        let onset = self.path.onsets.get(index)?;
        let low = (onset.earliest as f64 - range.start as f64).max(MARGIN);
        let last = onset.last_position() as f64 - range.start as f64;
        let high = last.min(range.len() as f64 - 1.0 - MARGIN);
        (low <= high).then_some((low, high))
    }
}
