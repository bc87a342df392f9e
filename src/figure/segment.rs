//! One decision: the segment with both lines, what they leave, the squared error of every candidate, and
//! a close-up of the reaction.
//!
//! Places along the trial are samples, counted from 1, which may lie between two; a [`Scale`] says where
//! they are on the horizontal axis.

use super::panel::{Axis, Mark, Panel, Place, Role, Shape};
use super::span::{Span, thinned_places, thinned_to};
use crate::delay::{Candidate, Decision, Line, Verdict};
use crate::experiment::Trial;
use crate::units::floor_to_index;
use crate::wording::{bracketed, interval, number, samples_text};

/// Errors less than this part of the largest are drawn at it: the fit is exact there. Chosen
/// so that a curve over nine decades is still read.
const EXACT: f64 = 1e-9;

/// Standard deviations of the noise on each side of a line between which 95 % of it lie.
const BAND: f64 = 1.96;

/// Pixels below the edge of a panel at which the delay and its interval are drawn.
const DEPTH: f64 = -8.0;

/// The horizontal axis of a trial.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    /// Where the first sample is.
    first: f64,
    /// From one sample to the next.
    step: f64,
    name: &'static str,
    /// Points of a curve, at most.
    points: usize,
}

impl Scale {
    /// Samples, counted from 1, for a drawing as wide as a screen.
    pub(crate) const SAMPLES: Self = Self { first: 1.0, step: 1.0, name: "sample", points: 2000 };

    /// The time of a trial, for a narrow drawing.
    pub(crate) fn time(trial: &Trial) -> Self {
        let (first, step) = (trial.time_s(1), trial.period().seconds());
        Self { first, step, name: "time [s]", points: 600 }
    }

    fn at(&self, sample: f64) -> f64 {
        self.first + (sample - 1.0) * self.step
    }

    fn places(&self, places: impl IntoIterator<Item = Place>) -> Vec<Place> {
        places.into_iter().map(|(sample, y)| (self.at(sample), y)).collect()
    }

    /// The axis from one sample to another, with about so many ticks.
    fn axis(&self, (from, to): (f64, f64), ticks: f64) -> Axis {
        let mut axis = Axis::new(Span::new(self.at(from), self.at(to)), self.name, ticks);
        let between_samples = |tick: f64| ((tick - self.first) / self.step).fract() != 0.0;
        if self.name == Self::SAMPLES.name {
            axis.ticks.retain(|(tick, _)| !between_samples(*tick));
        }
        axis
    }
}

/// A segment, and what was decided on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SegmentFigure<'a> {
    decision: &'a Decision,
    /// What was measured, and what the lines were fitted to.
    measured: &'a [f64],
    smoothed: Option<&'a [f64]>,
    unit: Option<&'a str>,
    scale: Scale,
    /// First and last sample that are drawn.
    window: (usize, usize),
    /// The least error that is drawn.
    least_error: f64,
}

impl<'a> SegmentFigure<'a> {
    /// The segment of `decision` in `trial`, whose output is measured in `unit`.
    pub(crate) fn new(
        (trial, unit): (&'a Trial, Option<&'a str>),
        smoothed: Option<&'a [f64]>,
        decision: &'a Decision,
        scale: Scale,
    ) -> Self {
        let highest = decision.candidates.sse().iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let (measured, least_error) = (trial.output(), EXACT * highest);
        let window = window(trial, decision);
        Self { decision, measured, smoothed, unit, scale, window, least_error }
    }

    /// Whether the best pair of lines was accepted.
    pub(crate) fn verdict(&self) -> Role {
        match self.decision.verdict() {
            Verdict::Accepted => Role::Accepted,
            Verdict::Rejected(_) => Role::Rejected,
        }
    }

    fn p(&self) -> f64 {
        self.decision.input_step.sample as f64
    }

    /// Where the delay ends.
    fn q(&self) -> Option<f64> {
        Some(self.p() + self.decision.delay()?)
    }

    /// Where the delay of the program ends, where a reviewer put another one.
    fn q_before_review(&self) -> Option<f64> {
        Some(self.p() + self.decision.delay_before_review()?)
    }

    /// A signal between two samples.
    fn signal(&self, values: &[f64], (first, last): (usize, usize)) -> Vec<Place> {
        let visible = values.get(first - 1..last).unwrap_or_default();
        let place = |index: usize| ((first + index) as f64, visible[index]);
        let kept = thinned_to(visible, self.scale.points).into_iter();
        self.scale.places(kept.map(place))
    }

    /// Both lines of a candidate, which break at `q`, so much above where they are.
    fn lines(&self, candidate: &Candidate, q: f64, above: f64) -> Vec<Vec<Place>> {
        let segment = self.decision.segment;
        let ends = |line: &Line, from: f64, to: f64| {
            self.scale.places([from, to].map(|k| (k, line.at(k) + above)))
        };
        let before = ends(&candidate.before, segment.first as f64, q);
        vec![before, ends(&candidate.after, q, segment.last as f64)]
    }

    /// Lines from edge to edge at samples.
    fn verticals(&self, role: Role, width: f64, samples: impl IntoIterator<Item = f64>) -> Mark {
        let places = samples.into_iter().map(|sample| self.scale.at(sample)).collect();
        Mark::new(role, Shape::Verticals(places, width))
    }

    fn step(&self) -> Mark {
        self.verticals(Role::Input, 1.6, [self.p()]).part("input_step")
    }

    /// The delay as a distance, or the interval in which it ends, so many pixels above the panel.
    pub(crate) fn spread(&self, role: Role, (low, high): (f64, f64), above: f64) -> Mark {
        let ends = [low, high].map(|delay| self.scale.at(self.p() + delay));
        Mark::new(role, Shape::Spreads(vec![ends.into()], above))
    }

    /// The output with both lines; what is drawn of it where the program's lines are not those shown.
    pub(crate) fn output(&self) -> Panel {
        let (decision, role) = (self.decision, self.verdict());
        let chosen = decision.shown_candidate().zip(self.q());
        let chosen = chosen.map_or_else(Vec::new, |(best, q)| self.lines(&best, q, 0.0));
        let measured = self.signal(self.measured, self.window);
        let smoothed = self.smoothed.map(|values| self.signal(values, self.window));
        let shown = measured.iter().chain(smoothed.iter().flatten()).chain(chosen.iter().flatten());
        let y = Span::around(shown.map(|place| place.1), 0.06);
        let ends = [decision.segment.first, decision.segment.last].map(|k| k as f64);
        let mut marks =
            vec![Mark::lines(Role::Measured, 1.2, vec![measured]).named("output").part("measured")];
        marks.extend(
            smoothed.map(|line| Mark::lines(Role::Smoothed, 1.2, vec![line]).named("smoothed")),
        );
        marks.push(Mark::lines(role, 2.0, chosen).named("lines").part("chosen"));
        marks.push(self.verticals(Role::Faint, 0.8, ends).part("borders"));
        marks.push(self.step().named("step"));
        marks.push(self.verticals(role, 1.4, self.q()).named("q").part("chosen"));
        if let Some((best, q)) = decision.candidates.best().zip(self.q_before_review()) {
            let lines = self.lines(&best, q, 0.0);
            marks.push(Mark::lines(Role::Faint, 1.0, lines).part("before_review"));
            marks.push(self.verticals(Role::Faint, 1.2, [q]).part("before_review"));
        }
        marks.extend(self.interval());
        marks.push(Mark::new(Role::Ink, Shape::Flags(self.flags())).part("names"));
        let (first, last) = self.window;
        let y = Axis::new(y, bracketed("output", self.unit), 5.0);
        let x = self.scale.axis((first as f64, last as f64), 5.0).bare();
        Panel { x, y, height: 170, marks }
    }

    fn interval(&self) -> Option<Mark> {
        let fine = self.decision.fine.filter(|_| self.decision.delay_before_review().is_none())?;
        Some(self.spread(Role::Ink, (fine.low, fine.high), DEPTH).part("interval"))
    }

    /// The names of p and q, and of both ends of the segment.
    fn flags(&self) -> Vec<(f64, String)> {
        let decision = self.decision;
        let mut flags = vec![(self.p(), format!("p = {}", decision.input_step.sample))];
        let q = decision.shown_candidate().and_then(|best| Some((best, self.q()?)));
        flags.extend(q.map(|(best, q)| {
            let text = match (decision.delay_before_review(), decision.fine) {
                (Some(_), _) => format!("q = {} by a reviewer", number(q)),
                (None, Some(_)) => format!("q = {q:.2}"),
                (None, None) => format!("q = {}", best.breakpoint),
            };
            (q, text)
        }));
        let before = decision.candidates.best().zip(self.q_before_review());
        flags.extend(before.map(|(best, q)| {
            (q, format!("program: q = {}, SSE = {}", number(q), number(best.sse)))
        }));
        let ends = [("r", decision.segment.first), ("end", decision.segment.last)];
        flags.extend(ends.map(|(name, k)| (k as f64, format!("{name} = {k}"))));
        flags.into_iter().map(|(sample, text)| (self.scale.at(sample), text)).collect()
    }

    /// What the chosen lines leave of what they were fitted to; it breaks where they do.
    pub(crate) fn residual(&self) -> Panel {
        let segment = self.decision.segment;
        let values = self.smoothed.unwrap_or(self.measured);
        let values = values.get(segment.indices()).unwrap_or_default();
        let parts = self.decision.candidates.best().map(|best| {
            let left = (segment.first..).zip(values).map(|(k, y)| {
                let line = if k < best.breakpoint { best.before } else { best.after };
                (k as f64, y - line.at(k as f64))
            });
            let (before, after): (Vec<_>, Vec<_>) =
                left.partition(|(k, _)| *k < best.breakpoint as f64);
            [before, after].map(|part| self.scale.places(thinned_places(&part, self.scale.points)))
        });
        let parts = parts.map_or_else(Vec::new, Vec::from);
        let y = Span::around(parts.iter().flatten().map(|place| place.1).chain([0.0]), 0.1);
        let (first, last) = self.window;
        let x = self.scale.axis((first as f64, last as f64), 5.0).bare();
        let zero = vec![(x.span.low, 0.0), (x.span.high, 0.0)];
        let marks = vec![
            Mark::lines(Role::Grid, 0.8, vec![zero]).part("zero"),
            Mark::lines(Role::Smoothed, 1.4, parts).part("residual"),
        ];
        Panel { x, y: Axis::new(y, "residual", 2.0), height: 40, marks }
    }

    /// The squared error of every candidate.
    pub(crate) fn errors(&self) -> Panel {
        let candidates = &self.decision.candidates;
        let kept = thinned_to(candidates.sse(), self.scale.points).into_iter();
        let curve =
            kept.filter_map(|index| candidates.get(index)).map(|c| self.error(&c)).collect();
        let shown = self.decision.shown_candidate();
        let best = shown.map(|shown| self.error(&shown)).into_iter().collect();
        let at_q = if self.decision.delay_before_review().is_some() { "at q" } else { "least" };
        let sse = candidates.sse().iter();
        let y = Span::around(sse.map(|sse| sse.max(self.least_error).log10()), 0.12);
        let unit = self.unit.map(|unit| format!("{unit}²"));
        let (first, last) = self.window;
        Panel {
            x: self.scale.axis((first as f64, last as f64), 5.0),
            y: Axis::logarithmic(y, bracketed("SSE", unit.as_deref()), 3.0),
            height: 76,
            marks: vec![
                Mark::lines(Role::Error, 1.6, vec![curve]).named("each candidate").part("sse"),
                self.step(),
                self.verticals(self.verdict(), 1.0, self.q()).part("chosen"),
                Mark::new(self.verdict(), Shape::Dots(best, 4.0)).named(at_q).part("least"),
            ],
        }
    }

    /// The logarithm to base ten of a candidate's squared error, at its breakpoint.
    pub(crate) fn error(&self, candidate: &Candidate) -> Place {
        let q = self.scale.at(candidate.breakpoint as f64);
        (q, candidate.sse.max(self.least_error).log10())
    }

    /// The samples around the reaction, beside Algorithm 1's lines with 95 % of the sensor's `noise`:
    /// two delays, or two widths of the interval where that is more, on each side of step and
    /// breakpoint; where there is no delay, the beginning of the hold.
    pub(crate) fn close_up(&self, noise: Option<f64>) -> Panel {
        let (decision, (first, last)) = (self.decision, self.reaction());
        let mut x = self.scale.axis((first as f64 - 0.5, last as f64 + 0.5), 4.0);
        x.name = String::new();
        let measured = self.signal(self.measured, (first, last));
        let smoothed = self.signal(self.smoothed.unwrap_or(self.measured), (first, last));
        let y = Span::around(measured.iter().chain(&smoothed).map(|place| place.1), 0.1);
        let lines = |above: f64| {
            let best = decision.candidates.best();
            best.map_or_else(Vec::new, |best| self.lines(&best, best.breakpoint as f64, above))
        };
        let band = noise.map_or_else(Vec::new, |noise| {
            [-BAND * noise, BAND * noise].into_iter().flat_map(lines).collect()
        });
        let mut marks = vec![
            Mark::lines(Role::Grid, 0.8, band).part("noise"),
            Mark::new(Role::Measured, Shape::Dots(measured, 4.0)).part("close"),
            Mark::lines(Role::Smoothed, 1.2, vec![smoothed]).part("smoothed"),
            self.step(),
            self.verticals(self.verdict(), 1.4, self.q()).part("chosen"),
        ];
        // Where Algorithm 1's answer is another one, its lines have a colour of their own.
        if decision.onset.is_some() {
            let q = decision.candidates.best().map(|best| best.breakpoint as f64);
            marks.push(Mark::lines(Role::Ink, 1.4, lines(0.0)).part("algorithm_1"));
            marks.push(self.verticals(Role::Ink, 1.0, q).part("algorithm_1"));
        } else if let Some((best, q)) = decision.shown_candidate().zip(self.q()) {
            marks.push(Mark::lines(self.verdict(), 2.4, self.lines(&best, q, 0.0)).part("chosen"));
        }
        marks.extend(self.interval());
        Panel { x, y: Axis::new(y, "", 6.0), height: 300, marks }
    }

    fn reaction(&self) -> (usize, usize) {
        /// Fewest samples on each side.
        const FEWEST: f64 = 8.0;
        let (decision, p) = (self.decision, self.p());
        let delay = decision.delay().unwrap_or(0.1 * decision.hold as f64);
        let spread = decision.fine.map_or(0.0, |fine| fine.high - fine.low);
        let room = 2.0 * delay.abs().max(spread).max(0.5 * FEWEST);
        let samples = self.measured.len().max(1);
        let end = |sample: f64| floor_to_index(sample.max(1.0)).clamp(1, samples);
        (end(p.min(p + delay) - room), end(p.max(p + delay) + room))
    }

    /// `δ = 21.6 samples (21.1 … 22.2) = 0.216 s`; nothing where there is no delay.
    pub(crate) fn delay_text(&self, period_s: f64) -> String {
        let Some(delay) = self.decision.delay() else { return String::new() };
        let own = self.decision.fine.filter(|_| self.decision.delay_before_review().is_none());
        let interval =
            own.map_or_else(String::new, |fine| format!(" ({})", interval((fine.low, fine.high))));
        format!("δ = {}{interval} = {} s", samples_text(delay), number(delay * period_s))
    }

    /// A candidate in the panels of output, errors and close-up: its lines, its breakpoint, its error.
    pub(crate) fn candidate(&self, candidate: &Candidate, role: Role) -> [Vec<Mark>; 3] {
        let q = candidate.breakpoint as f64;
        let at_q = || self.verticals(role, 2.0, [q]).part("candidate");
        let lines = || Mark::lines(role, 2.0, self.lines(candidate, q, 0.0)).part("candidate");
        let place = self.error(candidate);
        let (delay, sse) = (number(q - self.p()), number(candidate.sse));
        let said = vec![(place, format!("q {q}, δ {delay}, SSE {sse}"))];
        let mark = Mark::new(role, Shape::Dots(vec![place], 7.0)).part("candidate/mark");
        let said = Mark::new(role, Shape::Words(said)).part("candidate/words");
        [vec![lines(), at_q()], vec![at_q(), mark, said], vec![lines(), at_q()]]
    }

    /// Two lines of another result that meet at its delay, as far as its segment reaches.
    pub(crate) fn other(
        &self,
        role: Role,
        (delay, segment): (f64, (usize, usize)),
        lines: Option<[Line; 2]>,
    ) -> Vec<Mark> {
        let q = self.p() + delay;
        let (start, end) = ((segment.0 as f64).min(q), (segment.1 as f64).max(q));
        let ends = |line: &Line, from: f64, to: f64| {
            self.scale.places([from, to].map(|k| (k, line.at(k))))
        };
        let lines =
            lines.map(|[before, after]| vec![ends(&before, start, q), ends(&after, q, end)]);
        let lines = lines.map(|lines| Mark::lines(role, 1.8, lines));
        lines.into_iter().chain([self.verticals(role, 1.8, [q])]).collect()
    }
}

/// First and last sample of a decision that are looked at: its segment with its step and a margin.
pub(crate) fn window(trial: &Trial, decision: &Decision) -> (usize, usize) {
    let segment = decision.segment;
    let margin = (segment.len() / 12).max(3);
    let first = segment.first.min(decision.input_step.sample);
    (first.saturating_sub(margin).max(1), (segment.last + margin).min(trial.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::{Method, Settings, estimate};
    use crate::numerics::testing::normals;
    use crate::units::SamplePeriod;

    #[test]
    fn lines_run_from_end_to_end_of_the_segment_and_break_where_they_are_told() {
        let ramp = |k: u32| 0.2 * (f64::from(k) - 111.0).max(0.0);
        let mut noise = normals(5);
        let output: Vec<f64> = (0..240).map(|k| ramp(k) + 0.01 * noise()).collect();
        let input = (0..240).map(|k| f64::from(u8::from(k >= 100))).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, input, output).unwrap();
        let decisions = estimate(&trial, &Settings::of(Method::TWO_LINE)).unwrap().decisions;
        let decision = decisions.first().unwrap();
        let figure = SegmentFigure::new((&trial, None), None, decision, Scale::SAMPLES);
        let best = decision.candidates.best().unwrap();
        let lines = figure.lines(&best, 112.0, 0.0);
        let ends: Vec<f64> = lines.iter().flatten().map(|(k, _)| *k).collect();
        let segment = decision.segment;
        assert_eq!(ends, [segment.first as f64, 112.0, 112.0, segment.last as f64]);
    }
}
