//! Windows of a few onsets each, cut from a path through a trial, to find a lag in.

use std::ops::Range;

use super::onset::Onset;
use super::path::OnsetPath;
use crate::delay::lag::FitWindow;
use crate::units::ceil_to_index;

/// Onsets in a window that helps to find the lag; chosen: few are solved faster, many share a
/// line and its modes.
const TOGETHER: usize = 4;

/// Samples for each onset, more than which a window needs.
const FEWEST: usize = 8;

/// How well the positions of a path are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Precision {
    /// From broken lines: late by the lag, and not judged.
    Rough,
    /// Behind a lag.
    Refined,
}

/// Windows of a few onsets each, at the positions of the path. Each begins and ends where
/// no other onset can be, as well as their positions are known.
///
/// A log may begin within the delay of a command that it does not hold. The reaction to that, before
/// the first step's, would pass for a lag of all: where there are others, what is before the first
/// onset is left out.
pub(crate) fn fit_windows<'a>(
    output: &'a [f64],
    path: &OnsetPath,
    precision: Precision,
) -> Vec<FitWindow<'a>> {
    let rough = precision == Precision::Rough;
    if path.onsets.iter().any(|onset| onset.alone || onset.at_rest) {
        return lone_windows(output, path, precision);
    }
    let counting: Vec<_> = path.onsets.iter().filter(|onset| rough || onset.counts).collect();
    let (first, counting) = match counting.as_slice() {
        [first, others @ ..] if others.len() >= TOGETHER => (Some(*first), others),
        all => (None, all),
    };
    let guard = guard(path, precision);
    let range = |(index, group): (usize, &[&Onset])| {
        let before = (index * TOGETHER).checked_sub(1).map(|last| counting[last]).or(first);
        let start =
            before.map_or(0, |before| ceil_to_index(before.position) + before.guard().max(guard));
        let next = counting.get((index + 1) * TOGETHER);
        let end = next.map_or(output.len(), |next| end_before(next, group, precision));
        let known =
            output.get(start..end).is_some_and(|values| values.len() > FEWEST * group.len());
        known.then(|| (start..end, group.iter().map(|o| o.position - start as f64).collect()))
    };
    let groups = counting.chunks(TOGETHER).enumerate();
    let ranges: Vec<(Range<usize>, Vec<f64>)> = groups.filter_map(range).collect();
    let window = |(index, (range, onsets)): (usize, &(Range<usize>, Vec<f64>))| {
        let before = index.checked_sub(1).map(|before| &ranges[before].0);
        let first = before.map_or(0, |before| before.end.saturating_sub(range.start));
        let after = ranges.get(index + 1);
        let last = after.map_or(0, |(after, _)| range.end.saturating_sub(after.start));
        FitWindow { values: &output[range.clone()], onsets: onsets.clone(), shared: (first, last) }
    };
    ranges.iter().enumerate().map(window).collect()
}

/// Windows of an onset each, of those that the path does not bound by rest or a stop.
fn lone_windows<'a>(
    output: &'a [f64],
    path: &OnsetPath,
    precision: Precision,
) -> Vec<FitWindow<'a>> {
    let rough = precision == Precision::Rough;
    let window = |(index, onset): (usize, &Onset)| {
        let range = path.window(index);
        let (start, onsets) = (range.start, vec![onset.position - range.start as f64]);
        let is_fit = !onset.alone && !onset.at_rest && (rough || onset.counts);
        let values = output.get(range).filter(|values| is_fit && values.len() > FEWEST)?;
        Some((start, FitWindow { values, onsets, shared: (0, 0) }))
    };
    let windows: Vec<_> = path.onsets.iter().enumerate().filter_map(window).collect();
    let later = windows.iter().filter(|(start, _)| *start > 0).count();
    let from_the_first = |start: usize| start == 0 && later >= TOGETHER;
    windows.into_iter().filter(|(start, _)| !from_the_first(*start)).map(|(_, it)| it).collect()
}

/// Samples by which an onset of another step may be later than it was found.
fn guard(path: &OnsetPath, precision: Precision) -> usize {
    /// Behind a lag, where holds are short.
    const GUARD: usize = 4;
    if precision == Precision::Rough || path.in_time() { 0 } else { GUARD }
}

/// Where a window with the onsets of `group` ends before the `next` one.
fn end_before(next: &Onset, group: &[&Onset], precision: Precision) -> usize {
    /// Samples that an onset needs before the next one may be.
    const ROOM: f64 = 10.0;
    let last = group[group.len() - 1].position;
    // Nothing reacts to an input that has not changed yet.
    if precision == Precision::Rough && next.origin as f64 > last + ROOM {
        return next.origin;
    }
    ceil_to_index(next.position).saturating_sub(next.guard())
}

/// Every so many of the `windows`, from all over the record, with about `enough` samples.
pub(crate) fn thinned(windows: Vec<FitWindow<'_>>, enough: usize) -> Vec<FitWindow<'_>> {
    let samples: usize = windows.iter().map(|window| window.values.len()).sum();
    let every = samples.div_ceil(enough).max(1);
    let mut kept: Vec<_> = windows.into_iter().step_by(every).collect();
    if every > 1 {
        // Their neighbours are left out, so that nothing is shared.
        for window in &mut kept {
            window.shared = (0, 0);
        }
    }
    kept
}
