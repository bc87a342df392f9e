//! The simulations of a model on one trial.

use std::borrow::Cow;
use std::ops::Range;

use super::speed;
use super::window::Window;
use crate::experiment::Trial;
use crate::model::{
    Arrivals, JointModel, Restart, Simulated, Surroundings, simulate, simulate_output,
};

/// How a stretch is simulated: as a whole, or the output alone.
type Simulate = fn(&JointModel, &Arrivals, usize, f64, &[Restart], &Surroundings<'_>) -> Simulated;

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
    pub(super) speeds_measured: bool,
}

impl Run<'_> {
    /// The outputs at the start of the windows that make their squared error least, and
    /// the slope of the simulated output to them, where it is not 1.
    ///
    /// Without a slope the measured outputs will do: what they are wrong by is the same at
    /// all samples of a window.
    pub(super) fn best(&self) -> (Vec<f64>, Option<Vec<f64>>) {
        let measured = self.trial.output();
        let start = |w: &Window| measured.get(w.start).copied().unwrap_or_default();
        let starts: Vec<f64> = self.windows.iter().map(start).collect();
        if !self.model.depends_on_angle() {
            return (starts, None);
        }
        let simulated = self.simulate(&starts, simulate_output).output;
        let nudge = self.nudge();
        let ahead: Vec<f64> = starts.iter().map(|start| start + nudge).collect();
        let ahead = self.simulate(&ahead, simulate_output).output;
        let pairs = ahead.iter().zip(&simulated);
        let slope: Vec<f64> = pairs.map(|(a, b)| (a - b) / nudge).collect();
        let wrong = self.shifts(&simulated, Some(&slope));
        (starts.iter().zip(wrong).map(|(start, by)| start + by).collect(), Some(slope))
    }

    /// The simulation from `starts` and its residuals; what the starts are still wrong by
    /// is taken off as far as it is linear.
    pub(super) fn from(&self, starts: &[f64], slope: Option<&[f64]>) -> (Simulated, Vec<f64>) {
        self.by(starts, slope, simulate)
    }

    /// The residuals of the simulation from `starts`, as [`from`](Self::from) has them.
    pub(super) fn residuals_from(&self, starts: &[f64], slope: Option<&[f64]>) -> Vec<f64> {
        self.by(starts, slope, simulate_output).1
    }

    fn by(
        &self,
        starts: &[f64],
        slope: Option<&[f64]>,
        simulate: Simulate,
    ) -> (Simulated, Vec<f64>) {
        let mut simulated = self.simulate(starts, simulate);
        let shifts = self.shifts(&simulated.output, slope);
        for (window, shift) in self.windows.iter().zip(shifts) {
            let values = simulated.output.get_mut(window.start..window.end).unwrap_or_default();
            for (index, value) in (window.start..).zip(values) {
                *value += shift * slope.map_or(1.0, |g| g.get(index).copied().unwrap_or(1.0));
            }
        }
        let pairs = self.trial.output().iter().zip(&simulated.output);
        let residuals = pairs.map(|(y, s)| y - s).collect();
        (simulated, residuals)
    }

    /// A small part of what the output spans.
    fn nudge(&self) -> f64 {
        /// Small against what changes an effect, large against rounding.
        const PART: f64 = 1e-5;
        PART * self.span.max(f64::MIN_POSITIVE.sqrt())
    }

    /// The simulation of all windows; not a number where there is none.
    fn simulate(&self, starts: &[f64], simulate: Simulate) -> Simulated {
        let restart = |(window, output): (&Window, &f64)| Restart {
            sample: window.start,
            output: *output,
            speed: self
                .speeds_measured
                .then(|| speed::measured(self.trial, window.start))
                .flatten(),
        };
        let restarts: Vec<_> = self.windows.iter().zip(starts).map(restart).collect();
        let stretches = stretches(&self.windows);
        if let [only] = stretches.as_slice()
            && only.start == 0
        {
            return self.simulate_stretch(only, &restarts, simulate);
        }
        let mut whole = Simulated::default();
        for stretch in stretches {
            let own = restarts.iter().filter(|restart| stretch.contains(&restart.sample));
            let shifted = own.map(|r| Restart { sample: r.sample - stretch.start, ..*r });
            let output = self.trial.output().get(stretch.start).copied().unwrap_or_default();
            let begin = Restart { sample: 0, output, speed: None };
            let restarts: Vec<_> = std::iter::once(begin).chain(shifted).collect();
            whole.resume_at(stretch.start);
            whole.append(self.simulate_stretch(&stretch, &restarts, simulate));
        }
        whole
    }

    /// The simulation of one stretch, whose restarts count from its start.
    fn simulate_stretch(
        &self,
        stretch: &Range<usize>,
        restarts: &[Restart],
        simulate: Simulate,
    ) -> Simulated {
        let period_s = self.trial.period().seconds();
        let from_s = stretch.start as f64 * period_s;
        let surroundings = Surroundings {
            others: self.surroundings.others.get(stretch.start..).unwrap_or_default(),
            start_s: self.surroundings.start_s + from_s,
            ..self.surroundings
        };
        let later = (stretch.start > 0).then(|| self.arrivals.after(from_s));
        let arrivals = later.as_ref().unwrap_or(&self.arrivals);
        simulate(&self.model, arrivals, stretch.len(), period_s, restarts, &surroundings)
    }

    /// By how much the start of each window is wrong: `Σ w g r / Σ w g²`, with the slope
    /// `g` of the output to it (1 where there is none).
    fn shifts(&self, simulated: &[f64], slope: Option<&[f64]>) -> Vec<f64> {
        let shift = |window: &Window| {
            let (mut with, mut square) = (0.0, f64::MIN_POSITIVE);
            for index in window.start..window.end {
                let at = |values: &[f64]| values.get(index).copied().unwrap_or(1.0);
                let (g, w) = (slope.map_or(1.0, at), self.weights.map_or(1.0, at));
                with += w * g * (at(self.trial.output()) - at(simulated));
                square += w * g * g;
            }
            with / square
        };
        self.windows.iter().map(shift).collect()
    }
}

/// Samples before a stretch that are simulated, so that it does not begin at rest.
const LEAD_IN: usize = 150;

/// Samples that are simulated: windows without a gap are one stretch, and the first of them
/// has a lead-in.
fn stretches(windows: &[Window]) -> Vec<Range<usize>> {
    let mut stretches: Vec<Range<usize>> = Vec::new();
    for window in windows {
        let before = stretches.last_mut().map(|last| (last.end, last));
        match before {
            Some((end, last)) if window.start <= end + LEAD_IN => last.end = window.end,
            _ => stretches.push(window.start.saturating_sub(LEAD_IN)..window.end),
        }
    }
    stretches
}
