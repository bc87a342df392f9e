//! The simulations of a model on one trial.

use std::borrow::Cow;
use std::ops::Range;

use super::evaluation::Starts;
use super::speed;
use super::window::{Part, Window};
use crate::experiment::Trial;
use crate::model::{
    Arrivals, BESIDE, Driven, JointModel, Restart, Signals, Simulated, Surroundings,
    outputs_together, simulate_together,
};

/// How ranges of samples are simulated: as a whole, or the output alone.
type Simulate = fn(&[Driven<'_>]) -> Vec<Simulated>;

/// A model on one trial, and what the two need of the record.
pub(super) struct Run<'a> {
    /// The model in this trial: without the effects of other conditions.
    pub(super) model: Cow<'a, JointModel>,
    pub(super) trial: &'a Trial,
    pub(super) arrivals: Arrivals,
    pub(super) surroundings: Surroundings<'a>,
    pub(super) windows: Vec<Window>,
    pub(super) weights: Option<&'a [f64]>,
    /// Highest minus lowest output of the trial.
    pub(super) span: f64,
    /// Where the speed at a restart is measured, if it is.
    pub(super) speeds: Option<Speeds<'a>>,
}

/// A trial with all samples, of which a run has one in `stride`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Speeds<'a> {
    pub(super) trial: &'a Trial,
    pub(super) stride: usize,
}

impl Run<'_> {
    /// The windows between two restarts.
    fn between_restarts(&self) -> impl Iterator<Item = &[Window]> {
        self.windows.chunk_by(|_, next| !next.restarts)
    }

    /// The window at each restart.
    fn first_windows(&self) -> impl Iterator<Item = &Window> {
        self.between_restarts().filter_map(|windows| windows.first())
    }

    /// The outputs that were measured at the restarts.
    fn measured_starts(&self) -> Vec<f64> {
        let measured = self.trial.output();
        self.first_windows().map(|window| measured[window.start]).collect()
    }

    /// The measured outputs at the restarts, each the mean of the samples around it, of as
    /// many on either side, four at most.
    fn smoothed_starts(&self) -> Vec<f64> {
        /// Samples on either side: a third of the noise is left, and of a straight motion nothing
        /// is changed.
        const SIDE: usize = 4;
        let measured = self.trial.output();
        let start = |window: &Window| {
            let side = SIDE.min(window.start).min(measured.len() - 1 - window.start);
            let around = &measured[window.start - side..=window.start + side];
            around.iter().sum::<f64>() / around.len() as f64
        };
        self.first_windows().map(start).collect()
    }

    /// What is `simulated`, less what its starts are wrong by.
    fn shifted(&self, mut simulated: Simulated, slope: Option<&[f64]>) -> Simulated {
        let shifts = self.shifts(&simulated.output, slope);
        for (windows, shift) in self.between_restarts().zip(shifts) {
            let (Some(first), Some(last)) = (windows.first(), windows.last()) else { continue };
            let values = &mut simulated.output[first.start..last.end];
            for (index, value) in (first.start..).zip(values) {
                *value += shift * slope.map_or(1.0, |g| g[index]);
            }
        }
        simulated
    }

    fn residual(&self, simulated: &Simulated) -> Vec<f64> {
        let pairs = self.trial.output().iter().zip(&simulated.output);
        pairs.map(|(y, s)| y - s).collect()
    }

    /// The residuals in the place of what is `simulated`.
    fn residual_in_place(&self, simulated: Simulated) -> Vec<f64> {
        let mut values = simulated.output;
        values.iter_mut().zip(self.trial.output()).for_each(|(value, y)| *value = y - *value);
        values
    }

    /// A small part of what the output spans.
    fn perturbation(&self) -> f64 {
        /// Small against what changes an effect, large against rounding.
        const PART: f64 = 1e-5;
        PART * self.span.max(f64::MIN_POSITIVE.sqrt())
    }

    /// Where the simulation is set to `starts`.
    fn restarts(&self, starts: &[f64]) -> Vec<Restart> {
        let restart = |(window, output): (&Window, &f64)| Restart {
            sample: window.start,
            output: *output,
            speed: self.speeds.and_then(|of| speed::measured(of.trial, of.stride * window.start)),
        };
        self.first_windows().zip(starts).map(restart).collect()
    }

    /// The ranges of this run, which is that at `index`, from the `starts` of its windows.
    fn pieces(&self, index: usize, starts: &[f64]) -> Vec<Piece> {
        let restarts = self.restarts(starts);
        let ranges = simulated_ranges(&self.windows);
        if let [only] = ranges.as_slice()
            && only.start == 0
        {
            return vec![Piece { of: index, range: only.clone(), arrivals: None, restarts }];
        }
        let piece = |range: Range<usize>| {
            let own = restarts.iter().filter(|restart| range.contains(&restart.sample));
            let shifted = own.map(|r| Restart { sample: r.sample - range.start, ..*r });
            // It begins as it was measured.
            let output = self.trial.output()[range.start];
            let begin = Restart { sample: 0, output, speed: None };
            let restarts = std::iter::once(begin).chain(shifted).collect();
            let ends = (self.seconds(range.start), self.seconds(range.end));
            let arrivals = (range.start > 0).then(|| self.arrivals.between(ends.0, ends.1));
            Piece { of: index, range, arrivals, restarts }
        };
        ranges.into_iter().map(piece).collect()
    }

    /// What is simulated before it is, with room for outputs where they come in parts.
    fn nothing_yet(&self) -> Simulated {
        let is_whole =
            matches!(simulated_ranges(&self.windows).as_slice(), [only] if only.start == 0);
        let samples = self.windows.last().map_or(0, |window| window.end);
        Simulated::with_room_for(if is_whole { 0 } else { samples })
    }

    fn driven<'p>(&'p self, piece: &'p Piece) -> Driven<'p> {
        let start = piece.range.start;
        Driven {
            model: &self.model,
            arrivals: piece.arrivals.as_ref().unwrap_or(&self.arrivals),
            restarts: &piece.restarts,
            samples: piece.range.len(),
            period_s: self.trial.period().seconds(),
            surroundings: Surroundings {
                others: self.surroundings.others.get(start..).unwrap_or_default(),
                start_s: self.surroundings.start_s + self.seconds(start),
                signals: Signals { from: start, ..self.surroundings.signals },
                ..self.surroundings
            },
        }
    }

    fn seconds(&self, sample: usize) -> f64 {
        sample as f64 * self.trial.period().seconds()
    }

    /// By how much the start after each restart is wrong: `Σ w g r / Σ w g²` over the samples of its
    /// windows that are for training, or of all where none is, with the slope `g` of the output to it
    /// (1 where there is none).
    fn shifts(&self, simulated: &[f64], slope: Option<&[f64]>) -> Vec<f64> {
        let shift = |windows: &[Window]| {
            let is_fitted = |window: &&Window| window.part == Part::Training;
            let has_fitted = windows.iter().any(|window| is_fitted(&window));
            let seen = windows.iter().filter(|window| !has_fitted || is_fitted(window));
            let (mut with, mut square) = (0.0, f64::MIN_POSITIVE);
            for index in seen.flat_map(|window| window.start..window.end) {
                let at = |values: &[f64]| values[index];
                let (g, w) = (slope.map_or(1.0, at), self.weights.map_or(1.0, at));
                with += w * g * (at(self.trial.output()) - at(simulated));
                square += w * g * g;
            }
            with / square
        };
        self.between_restarts().map(shift).collect()
    }
}

/// For each run the outputs at the restarts that make their squared error least, and the
/// slope of the simulated output to them, where it is not 1.
///
/// Without a slope the measured outputs will do: what they are wrong by is the same at all samples
/// of a window.
pub(super) fn best_starts(runs: &[Run<'_>]) -> Vec<Starts> {
    let measured: Vec<Vec<f64>> = runs.iter().map(Run::measured_starts).collect();
    let ahead = |(run, starts): (&Run<'_>, &Vec<f64>)| -> Vec<f64> {
        let perturbation = run.perturbation();
        starts.iter().map(|start| start + perturbation).collect()
    };
    let ahead: Vec<Vec<f64>> = runs.iter().zip(&measured).map(ahead).collect();
    let all = runs.iter().zip(measured.iter().zip(&ahead));
    let curved = all.filter(|(run, _)| run.model.depends_on_angle());
    let begun = curved.flat_map(|(run, (here, ahead))| [(run, here.as_slice()), (run, ahead)]);
    let found = simulated(&begun.collect::<Vec<_>>(), outputs_together);
    // Two for each run that depends on the angle.
    let mut pairs = found.chunks_exact(2);
    let best = |(run, outputs): (&Run<'_>, Vec<f64>)| {
        let pair = if run.model.depends_on_angle() { pairs.next() } else { None };
        let Some([Simulated { output: here, .. }, Simulated { output: ahead, .. }]) = pair else {
            return Starts { outputs, slope: None };
        };
        let perturbation = run.perturbation();
        let slope: Vec<f64> = ahead.iter().zip(here).map(|(a, b)| (a - b) / perturbation).collect();
        let wrong = run.shifts(here, Some(&slope));
        let outputs = outputs.iter().zip(wrong).map(|(start, by)| start + by).collect();
        Starts { outputs, slope: Some(slope) }
    };
    runs.iter().zip(measured).map(best).collect()
}

/// The simulation of each run from its starts, and its residuals; what the starts are still wrong by
/// is removed as far as it is linear.
pub(super) fn simulated_from<'r>(
    begun: impl Iterator<Item = (&'r Run<'r>, &'r Starts)>,
) -> Vec<(Simulated, Vec<f64>)> {
    let begun: Vec<_> = begun.collect();
    let outputs: Vec<_> = begun.iter().map(|(run, from)| (*run, from.outputs.as_slice())).collect();
    let all = simulated(&outputs, simulate_together).into_iter().zip(begun);
    let found = all.map(|(simulated, (run, starts))| {
        let simulated = run.shifted(simulated, starts.slope.as_deref());
        let residual = run.residual(&simulated);
        (simulated, residual)
    });
    found.collect()
}

/// The residuals of each run from its starts, as [`simulated_from`] has them, without the outputs.
pub(super) fn residuals_from<'r>(
    begun: impl Iterator<Item = (&'r Run<'r>, &'r Starts)>,
) -> Vec<Vec<f64>> {
    let begun: Vec<_> = begun.collect();
    let outputs: Vec<_> = begun.iter().map(|(run, from)| (*run, from.outputs.as_slice())).collect();
    let all = simulated(&outputs, outputs_together).into_iter().zip(begun);
    let found = all.map(|(simulated, (run, starts))| {
        run.residual_in_place(run.shifted(simulated, starts.slope.as_deref()))
    });
    found.collect()
}

/// The residuals of each run whose windows start at the smoothed measured output: nothing is
/// removed.
pub(super) fn raw_residuals(runs: &[Run<'_>]) -> Vec<Vec<f64>> {
    let starts: Vec<Vec<f64>> = runs.iter().map(Run::smoothed_starts).collect();
    let begun: Vec<_> = runs.iter().zip(&starts).map(|(run, from)| (run, &from[..])).collect();
    let all = simulated(&begun, outputs_together).into_iter().zip(runs);
    all.map(|(simulated, run)| run.residual_in_place(simulated)).collect()
}

/// The simulations of the windows of each run, from their starts; not a number where there is none.
fn simulated(begun: &[(&Run<'_>, &[f64])], simulate: Simulate) -> Vec<Simulated> {
    let pieces = begun.iter().enumerate();
    let pieces = pieces.flat_map(|(index, (run, starts))| run.pieces(index, starts));
    let pieces: Vec<Piece> = pieces.collect();
    let mut whole: Vec<Simulated> = begun.iter().map(|(run, _)| run.nothing_yet()).collect();
    // So many at a time, lest all ranges are held twice.
    for some in pieces.chunks(BESIDE) {
        let driven = some.iter().filter_map(|piece| Some(begun.get(piece.of)?.0.driven(piece)));
        let parts = simulate(&driven.collect::<Vec<_>>());
        for (piece, part) in some.iter().zip(parts) {
            if let Some(whole) = whole.get_mut(piece.of) {
                whole.append_at(piece.range.start, part);
            }
        }
    }
    whole
}

/// A part of the run at the index `of`, to be simulated.
struct Piece {
    of: usize,
    range: Range<usize>,
    /// What arrives from its start on, where that is not that of the trial.
    arrivals: Option<Arrivals>,
    /// Counted from its start.
    restarts: Vec<Restart>,
}

/// Samples before a window that are simulated, so that it does not begin at rest.
const LEAD_IN: usize = 150;

/// Samples that are simulated: windows without a gap are one range, and the first of them
/// has a lead-in.
///
/// Between windows that make up most of the record the simulation goes on, so that what remembers
/// (play, friction, slow states) comes to the next one as it was driven.
fn simulated_ranges(windows: &[Window]) -> Vec<Range<usize>> {
    let seen: usize = windows.iter().map(|window| window.end - window.start).sum();
    let mut ranges: Vec<Range<usize>> = Vec::new();
    let Some((first, last)) = windows.first().zip(windows.last()) else { return ranges };
    let is_most = 2 * seen >= last.end - first.start;
    let skipped = if is_most { usize::MAX } else { LEAD_IN };
    for window in windows {
        match ranges.last_mut() {
            Some(range) if window.start - range.end <= skipped => range.end = window.end,
            _ => ranges.push(window.start.saturating_sub(LEAD_IN)..window.end),
        }
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Joint;
    use crate::fit::{FitRecord, Horizon, Split};
    use crate::units::SamplePeriod;

    #[test]
    fn the_start_of_a_free_run_is_fitted_to_what_is_for_training_alone() {
        let input: Vec<f64> = (0..1800).map(|k| f64::from(k / 100 % 2)).collect();
        // The blocks for validation lie 5 above what an integrator could follow.
        let output = (0..1800).map(|k| match k {
            400..800 | 1600.. => 5.0,
            _ => 0.0,
        });
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("a", 0.0, period, input, output.collect()).unwrap();
        let joint = Joint {
            name: "boom".to_owned(),
            input_unit: None,
            output_unit: None,
            covariates: Vec::new(),
            trials: [trial].into(),
        };
        let record = FitRecord::new(&joint, Split::Blocks, Horizon::FreeRun);
        let still = JointModel::integrator(0.0, 0.0);
        let simulated = record.evaluate(&still).simulated;
        assert!(simulated[0].output.iter().all(|output| output.abs() < 1e-12));
    }
}
