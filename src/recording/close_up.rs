//! The samples around the reaction to one step: from two delays before the input step to two behind
//! the breakpoint.

use rerun::datatypes::Vec2D;

use super::canvas::{CURVE_POINTS, Labels, Plot, Span, Strips, thinned_to, whole_ticks};
use super::layout::TrialLayout;
use super::sheet::Sheet;
use crate::delay::{Candidate, Decision, Line};
use crate::units::floor_to_index;

/// Left and right end on the sheet, and its rows.
const PLACE: ((f32, f32), (f32, f32)) = ((1080.0, 1585.0), (76.0, 712.0));

/// Standard deviations of the noise on each side of a line between which 95 % of it lie.
const BAND: f64 = 1.96;

/// The close-up of one decision.
pub(super) struct CloseUp<'a> {
    decision: &'a Decision,
    /// First and last sample that are drawn.
    window: (usize, usize),
    measured: &'a [f64],
    smoothed: &'a [f64],
    plot: Plot,
    /// Standard deviation of the sensor's noise, where the record shows it.
    noise: Option<f64>,
}

impl<'a> CloseUp<'a> {
    pub(super) fn new(trial: &TrialLayout<'a>, decision: &'a Decision, noise: Option<f64>) -> Self {
        let window = window(decision, trial.trial.len());
        let (first, last) = window;
        let within = |values: &'a [f64]| values.get(first - 1..last).unwrap_or_default();
        let (measured, smoothed) = (within(trial.trial.output()), within(trial.output()));
        let x = Span::new(first as f64 - 0.5, last as f64 + 0.5);
        let y = Span::around(measured.iter().chain(smoothed).copied(), 0.1);
        let (columns, (top, bottom)) = PLACE;
        let plot = Plot::within(columns, top..=bottom, x, y);
        Self { decision, window, measured, smoothed, plot, noise }
    }

    /// Frame, grid, and the band of the noise around Algorithm 1's lines.
    pub(super) fn grid(&self, sheet: &mut Sheet) {
        let x_ticks = whole_ticks(&self.plot, 4.0);
        sheet.outline(&self.plot, &x_ticks, &self.plot.y_ticks(6.0));
        sheet.below(&self.plot, 4.0, &x_ticks);
        if let Some((best, noise)) = self.decision.candidates.best().zip(self.noise) {
            for shift in [-BAND * noise, BAND * noise] {
                sheet.grid.extend(self.lines(&best, best.breakpoint as f64, shift));
            }
        }
    }

    pub(super) fn measured(&self) -> Vec<Vec2D> {
        let kept = thinned_to(self.measured, CURVE_POINTS).into_iter();
        let place = |index: usize| Some((self.sample(index), *self.measured.get(index)?));
        self.plot.places(kept.filter_map(place))
    }

    pub(super) fn smoothed(&self) -> Vec<Vec2D> {
        self.plot.curve(self.smoothed, CURVE_POINTS, |index| self.sample(index))
    }

    fn sample(&self, index: usize) -> f64 {
        (self.window.0 + index) as f64
    }

    pub(super) fn input_step(&self) -> Vec<Vec2D> {
        self.plot.vertical(self.decision.input_step.sample as f64).to_vec()
    }

    /// Where the delay ends, from edge to edge, with its interval as a bar.
    pub(super) fn answer(&self) -> Strips {
        let Some(delay) = self.decision.delay() else { return Vec::new() };
        let p = self.decision.input_step.sample as f64;
        let mut strips: Strips = self.vertical(p + delay).into_iter().collect();
        let own = self.decision.fine.filter(|_| self.decision.delay_before_review().is_none());
        if let Some(fine) = own {
            strips.extend(self.plot.interval([p + fine.low, p + fine.high], -12.0, 8.0));
        }
        strips
    }

    /// A line from edge to edge at a sample, where it is in the plot.
    pub(super) fn vertical(&self, sample: f64) -> Option<Vec<Vec2D>> {
        let span = self.plot.x_span();
        (span.low <= sample && sample <= span.high).then(|| self.plot.vertical(sample).to_vec())
    }

    /// Both lines of a candidate that break at `q`, `shift` above, as far as they are in the plot.
    pub(super) fn lines(&self, candidate: &Candidate, q: f64, shift: f64) -> Strips {
        let segment = self.decision.segment;
        let before = (candidate.before, segment.first as f64, q);
        let after = (candidate.after, q, segment.last as f64);
        let line = |(line, from, to): (Line, f64, f64)| {
            self.plot.clipped([from, to].map(|k| (k, line.at(k) + shift)))
        };
        [before, after].into_iter().filter_map(line).map(Vec::from).collect()
    }

    /// Puts a text above the plot.
    pub(super) fn title(labels: &mut Labels, text: String) {
        let (left, right) = PLACE.0;
        labels.put_whole(Vec2D::new(f32::midpoint(left, right), 22.0), text);
    }

    /// Where the line `row` of a legend of `rows` lines stands: at the bottom of the plot.
    pub(super) fn legend_place(row: usize, rows: usize) -> Vec2D {
        /// Height of a line of text on the sheet.
        const LINE: f32 = 44.0;
        let ((left, right), (_, bottom)) = PLACE;
        Vec2D::new(f32::midpoint(left, right), bottom - LINE * (rows - row) as f32)
    }
}

/// First and last sample of the close-up: two delays, or two widths of the interval where that is
/// more, on each side of step and breakpoint; where there is no delay, the beginning of the hold.
fn window(decision: &Decision, samples: usize) -> (usize, usize) {
    /// Fewest samples on each side.
    const FEWEST: f64 = 8.0;
    let p = decision.input_step.sample as f64;
    let delay = decision.delay().unwrap_or(0.1 * decision.hold as f64);
    let spread = decision.fine.map_or(0.0, |fine| fine.high - fine.low);
    let room = 2.0 * delay.abs().max(spread).max(0.5 * FEWEST);
    let end = |sample: f64| floor_to_index(sample.max(1.0)).clamp(1, samples.max(1));
    (end(p.min(p + delay) - room), end(p.max(p + delay) + room))
}
