//! Where each onset is by broken lines: the path through the trial, then each onset exactly
//! between its neighbours.

use std::ops::RangeInclusive;

use super::path::OnsetPath;
use crate::delay::broken_line::{PARAMETERS, Window};
use crate::delay::prepared::Prepared;
use crate::delay::settings::Settings;
use crate::numerics::NoiseModel;

/// A reaction with a larger p-value does not bound its neighbours.
pub(super) const DOUBTFUL: f64 = 0.01;

/// The onset of each step, and the noise about the lines, after `passes` at most; after
/// one the noise is taken for white.
pub(crate) fn located(
    trial: &Prepared<'_>,
    settings: &Settings,
    passes: usize,
) -> (OnsetPath, NoiseModel) {
    /// Samples that are enough to know the noise.
    const ENOUGH: usize = 50_000;
    /// Those of all windows, which are in some three of them where every neighbour counts.
    const MOST: usize = 8 * ENOUGH;
    let output = trial.output();
    let mut path = OnsetPath::of(trial, settings);
    let every = output.len().div_ceil(ENOUGH).max(1);
    let mut noise = NoiseModel::white();
    for pass in 0..passes {
        if pass > 0 && path.in_time() && path.is_fine() {
            break;
        }
        let (mut residuals, mut known) = (Vec::new(), 0);
        for index in 0..path.onsets.len() {
            let range = if pass == 0 { path.cautious_window(index) } else { path.window(index) };
            let start = range.start;
            let Some(values) = output.get(range) else { continue };
            let found = break_window(&path, index, values, start, &noise);
            let Some(line) = found.and_then(|(window, positions)| window.best(positions)) else {
                continue;
            };
            if index % every == 0 && known < MOST {
                known += values.len();
                residuals.push(line.residuals(values));
            }
            let onset = &mut path.onsets[index];
            onset.position = start as f64 + line.position;
            onset.counts = line.p_value <= DOUBTFUL && !onset.at_rest;
            onset.error = line.position_error(values.len());
        }
        noise = NoiseModel::of(&residuals, PARAMETERS);
    }
    (path, noise)
}

/// The window of an onset, whose `values` begin at `start`, and where its break may be.
pub(crate) fn break_window<'a>(
    path: &OnsetPath,
    index: usize,
    values: &[f64],
    start: usize,
    noise: &'a NoiseModel,
) -> Option<(Window<'a>, RangeInclusive<usize>)> {
    let onset = &path.onsets[index];
    let window = Window::of(values, noise)?;
    let positions = window.positions();
    let first = onset.earliest.saturating_sub(start).max(*positions.start());
    let last = onset.last_position().checked_sub(start)?.min(*positions.end());
    Some((window, first..=last))
}
