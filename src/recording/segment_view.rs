//! The drawing of one decision: on the left the segment, both lines, what they leave, the error
//! curve and the cursor; on the right a close-up of the reaction.
//!
//! What belongs to the segment is set at its opening tick and stays until the next one;
//! what belongs to a candidate is set at each of its ticks and cleared before and after,
//! so that nothing leaks into the next segment.

use rerun::datatypes::Vec2D;

use super::beside::{Other, Shown};
use super::canvas::{
    CURVE_POINTS, HALF_LETTER, Labels, Plot, SHEET, Span, diamond, simplified, whole_ticks,
};
use super::chunk::Chunks;
use super::close_up::CloseUp;
use super::error::RecordError;
use super::layers::Layers;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::palette;
use super::paths;
use super::sheet::Sheet;
use crate::delay::{Candidate, Line, Method};
use crate::diagnosis::sensor_noise;
use crate::figure::segment::SegmentFigure;
use crate::figure::{Role, power_of_ten};
use crate::study::StepResult;
use crate::units::signed;
use crate::wording::{bracketed, number, samples_text};

/// Width and height of the sheet.
pub(super) const SIZE: (f32, f32) = (SHEET.0, 770.0);

/// Left and right end of the plots of the whole segment.
const SIDES: (f32, f32) = (120.0, 960.0);

/// Adds the drawings of all segments below `root`/drawing.
pub(super) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    (method, others): (Method, &[Other<'_>]),
) -> Result<(), RecordError> {
    let drawings: Vec<_> =
        layout.segments().map(|(trial, segment)| Drawing::new(trial, segment)).collect();
    let mut layers = Layers::rows(chunks, paths::DRAWING, layout.openings());
    add_drawings(&mut layers, &drawings)?;
    if !others.is_empty() {
        add_others(&mut layers, &drawings, method, others)?;
    }
    add_candidates(chunks, &drawings)
}

/// What belongs to each segment, without its candidates.
pub(super) fn add_drawings(
    sheet: &mut Layers<'_>,
    drawings: &[Drawing<'_, '_>],
) -> Result<(), RecordError> {
    let rows = || drawings.iter();
    let (grids, ticks): (Vec<_>, Vec<_>) = rows().map(|d| d.grid().into_parts()).unzip();
    sheet.strips("grid", palette::GRID, 0.8, grids)?;
    sheet.texts("ticks", palette::BORDER, ticks)?;
    sheet.points("measured", palette::RAW, 1.6, rows().map(Drawing::measured))?;
    sheet.points("close", palette::MEASURED, 5.0, rows().map(|d| d.close_up.measured()))?;
    sheet.strips("smoothed", palette::SMOOTHED, 1.4, rows().map(Drawing::smoothed))?;
    sheet.strips("borders", palette::BORDER, 1.2, rows().map(Drawing::borders))?;
    sheet.strips("input_step", palette::INPUT, 1.6, rows().map(Drawing::input_step))?;
    sheet.strips("residual", palette::SMOOTHED, 1.4, rows().map(Drawing::residual))?;
    sheet.strips(
        "sse",
        palette::ERROR,
        1.6,
        rows().map(|d| vec![d.error.places(d.figure.errors(CURVE_POINTS))]),
    )?;
    if rows().any(|drawing| drawing.segment.decision.onset.is_some()) {
        let lines = rows().map(Drawing::algorithm_1);
        sheet.strips("algorithm_1", palette::BORDER, 1.4, lines)?;
    }
    for (path, rgb, role) in [
        ("accepted", palette::ACCEPTED, Role::Accepted),
        ("rejected", palette::REJECTED, Role::Rejected),
    ] {
        sheet.strips(path, rgb, 2.4, rows().map(|d| d.chosen(role)))?;
    }
    if rows().any(|drawing| drawing.segment.decision.delay_before_review().is_some()) {
        let before = rows().map(Drawing::before_review);
        sheet.strips("before_review", palette::BORDER, 1.0, before)?;
    }
    sheet.texts("names", palette::BORDER, rows().map(Drawing::names))?;
    if rows().any(|drawing| drawing.segment.decision.fine.is_some()) {
        sheet.strips("interval", palette::BORDER, 1.6, rows().map(Drawing::interval))?;
    }
    Ok(())
}

/// What other results say, with a legend of all.
fn add_others(
    sheet: &mut Layers<'_>,
    drawings: &[Drawing<'_, '_>],
    method: Method,
    others: &[Other<'_>],
) -> Result<(), RecordError> {
    // Texts, one below another, at the bottom of the close-up.
    let entry = |index: usize, text: Option<String>| {
        let mut labels = Labels::default();
        if let Some(text) = text {
            labels.put_whole(CloseUp::legend_place(index, others.len() + 1), text);
        }
        labels
    };
    for (path, rgb, role) in [
        ("first_accepted", palette::ACCEPTED, Role::Accepted),
        ("first_rejected", palette::REJECTED, Role::Rejected),
    ] {
        let first = |drawing: &Drawing<'_, '_>| {
            let is_it = drawing.figure.verdict() == role;
            let result = Shown::of(drawing.segment.decision);
            entry(0, is_it.then(|| result.in_short(method.id())))
        };
        sheet.texts(path, rgb, drawings.iter().map(first))?;
    }
    for (index, other) in others.iter().enumerate() {
        let found = |drawing: &Drawing<'_, '_>| {
            let p = drawing.segment.decision.input_step.sample;
            other.pair(drawing.trial.trial.label(), p).map(|pair| &pair.there)
        };
        let strips = |drawing: &Drawing<'_, '_>| {
            found(drawing).map_or_else(Vec::new, |step| drawing.other(step, index))
        };
        let name = |drawing: &Drawing<'_, '_>| {
            entry(index + 1, found(drawing).map(|step| Shown::there(step).in_short(other.name)))
        };
        sheet.strips(&format!("other_{index}"), other.rgb, 1.8, drawings.iter().map(strips))?;
        sheet.texts(&format!("other_{index}_name"), other.rgb, drawings.iter().map(name))?;
    }
    Ok(())
}

/// One segment on its sheet: the output above, what both lines leave of it, the error curve
/// below; and the close-up beside them.
pub(super) struct Drawing<'l, 'a> {
    trial: &'l TrialLayout<'a>,
    segment: &'l SegmentLayout<'a>,
    figure: SegmentFigure<'l>,
    output: Plot,
    /// What the chosen lines leave, with its plot.
    residual: (Vec<(f64, f64)>, Plot),
    error: Plot,
    close_up: CloseUp<'l>,
}

impl<'l, 'a> Drawing<'l, 'a> {
    pub(super) fn new(trial: &'l TrialLayout<'a>, segment: &'l SegmentLayout<'a>) -> Self {
        let figure = SegmentFigure::new(trial.trial, segment.decision);
        let (first, last) = figure.window;
        let x = Span::new(first as f64, last as f64);
        let measured = figure.visible(trial.trial.output());
        let values = measured.iter().chain(figure.visible(trial.output())).copied();
        let y = Span::around(values, 0.06);
        let left = figure.residual(trial.output());
        let heights = left.iter().map(|(_, y)| *y).chain([0.0]);
        let residual = Plot::within(SIDES, 494.0..=556.0, x, Span::around(heights, 0.1));
        let noise = sensor_noise(&trial.estimated.joint.trials);
        Self {
            trial,
            segment,
            figure,
            output: Plot::within(SIDES, 76.0..=400.0, x, y),
            residual: (left, residual),
            error: Plot::within(SIDES, 606.0..=712.0, x, figure.error_span()),
            close_up: CloseUp::new(trial, segment.decision, noise),
        }
    }

    fn measured(&self) -> Vec<Vec2D> {
        self.output.places(self.figure.signal(self.trial.trial.output(), CURVE_POINTS))
    }

    fn smoothed(&self) -> Vec<Vec<Vec2D>> {
        let signal = self.figure.signal(self.trial.output(), CURVE_POINTS);
        vec![simplified(self.output.places(signal)), self.close_up.smoothed()]
    }

    /// Algorithm 1's lines in the close-up, where the answer is not theirs.
    fn algorithm_1(&self) -> Vec<Vec<Vec2D>> {
        let decision = self.segment.decision;
        let best = decision.candidates.best().filter(|_| decision.onset.is_some());
        best.map_or_else(Vec::new, |best| {
            let q = best.breakpoint as f64;
            let lines = self.close_up.lines(&best, q, 0.0).into_iter();
            lines.chain(self.close_up.vertical(q)).collect()
        })
    }

    fn grid(&self) -> Sheet {
        let mut sheet = Sheet::default();
        let x_ticks = whole_ticks(&self.output, 5.0);
        sheet.outline(&self.output, &x_ticks, &self.output.y_ticks(5.0));
        let (_, residual) = &self.residual;
        sheet.outline(residual, &x_ticks, &apart(residual.y_ticks(2.0), residual));
        sheet.grid.push(residual.level(0.0).to_vec());
        let errors = self.error.y_span().ticks(3.0);
        let errors: Vec<_> = errors.into_iter().map(|e| (e, number(power_of_ten(e)))).collect();
        sheet.outline(&self.error, &x_ticks, &errors);
        sheet.below(&self.error, 4.0, &x_ticks);
        self.close_up.grid(&mut sheet);
        sheet
    }

    fn borders(&self) -> Vec<Vec<Vec2D>> {
        let segment = self.segment.decision.segment;
        let line = |k: usize| self.output.vertical(k as f64).to_vec();
        vec![line(segment.first), line(segment.last)]
    }

    fn input_step(&self) -> Vec<Vec<Vec2D>> {
        let p = self.segment.decision.input_step.sample as f64;
        let close = self.close_up.input_step();
        vec![self.output.vertical(p).to_vec(), self.error.vertical(p).to_vec(), close]
    }

    /// What the chosen lines leave, thinned; the line breaks where they do.
    fn residual(&self) -> Vec<Vec<Vec2D>> {
        let (all, plot) = &self.residual;
        let q = self.segment.decision.shown_candidate().map_or(0.0, |best| best.breakpoint as f64);
        let parts = all.split_at(all.partition_point(|(k, _)| *k < q));
        let curve = |part: &[(f64, f64)]| {
            let (places, heights): (Vec<f64>, Vec<f64>) = part.iter().copied().unzip();
            plot.curve(&heights, CURVE_POINTS, |index| places[index])
        };
        [parts.0, parts.1].map(curve).into_iter().filter(|curve| curve.len() > 1).collect()
    }

    fn error_at(&self, candidate: &Candidate) -> Vec2D {
        let (q, error) = self.figure.error(candidate);
        self.error.at(q, error)
    }

    /// Both lines of a candidate, and a line down through its breakpoint `q`.
    fn pair(&self, candidate: &Candidate, q: f64) -> Vec<Vec<Vec2D>> {
        let [before, after] = self.figure.lines(candidate, q).map(|line| self.output.places(line));
        vec![before, after, self.output.through(&self.error, q).to_vec()]
    }

    /// A candidate in both plots.
    fn candidate(&self, candidate: &Candidate) -> Vec<Vec<Vec2D>> {
        let q = candidate.breakpoint as f64;
        let mut strips = self.pair(candidate, q);
        strips.extend(self.close_up.lines(candidate, q, 0.0));
        strips.extend(self.close_up.vertical(q));
        strips
    }

    /// The chosen pair, a mark on the error curve, and the delay as a distance.
    fn best(&self) -> Vec<Vec<Vec2D>> {
        let decision = self.segment.decision;
        let Some((best, delay)) = decision.shown_candidate().zip(decision.delay()) else {
            return Vec::new();
        };
        let p = decision.input_step.sample as f64;
        let mut strips = self.pair(&best, p + delay);
        // Where Algorithm 1's answer is another one, its lines have a colour of their own.
        if decision.onset.is_none() {
            strips.extend(self.close_up.lines(&best, p + delay, 0.0));
        }
        strips.extend(self.close_up.answer());
        strips.push(diamond(self.error_at(&best), 6.0));
        let [from, to] = [p, p + delay].map(|k| self.output.above(k, 8.0));
        strips.push(vec![from, to]);
        strips
    }

    /// The lines of another result, and its delay or its interval as a bar. Of a step that lies at
    /// another sample there, as in another log, the lines are of that log, and left out.
    fn other(&self, step: &StepResult, index: usize) -> Vec<Vec<Vec2D>> {
        let Some(delay) = step.delay else { return Vec::new() };
        let own = self.segment.decision.input_step.sample;
        let p = own as f64;
        let Span { low: first, high: last } = self.output.x_span();
        let within = |k: f64| k.clamp(first, last);
        let q = within(p + delay);
        let at = |line: &Line, k: f64| self.output.at(k, line.at(k));
        let start = within(step.segment.0 as f64).min(q);
        let end = within(step.segment.1 as f64).max(q);
        let (low, high) = step.interval.unwrap_or((0.0, delay));
        // Below the edge, so that it is not taken for the first method's above.
        let depth = -10.0 - 12.0 * index as f32;
        let lines =
            step.lines.filter(|_| step.p == own).map_or_else(Vec::new, |[before, after]| {
                vec![vec![at(&before, start), at(&before, q)], vec![at(&after, q), at(&after, end)]]
            });
        let bar = self.output.interval([p + low, p + high], depth, 4.0);
        let bar = std::iter::once(self.output.vertical(q).to_vec()).chain(bar);
        lines.into_iter().chain(bar).chain(self.close_up.vertical(p + delay)).collect()
    }

    /// The program's lines and breakpoint, where a reviewer put another one.
    fn before_review(&self) -> Vec<Vec<Vec2D>> {
        let decision = self.segment.decision;
        let found = decision.candidates.best().zip(decision.delay_before_review());
        let p = decision.input_step.sample as f64;
        found.map_or_else(Vec::new, |(best, delay)| self.pair(&best, p + delay))
    }

    /// Where the delay may end: a bar from one end of its interval to the other.
    fn interval(&self) -> Vec<Vec<Vec2D>> {
        let decision = self.segment.decision;
        let Some(fine) = decision.fine else { return Vec::new() };
        let p = decision.input_step.sample as f64;
        self.output.interval([p + fine.low, p + fine.high], 8.0, 5.0)
    }

    /// The chosen pair if its verdict is the wanted one.
    fn chosen(&self, wanted: Role) -> Vec<Vec<Vec2D>> {
        if self.figure.verdict() == wanted { self.best() } else { Vec::new() }
    }

    /// Names p, q and both ends of the segment below their lines: on either side of two lines that
    /// are near each other, and in a second row where there is no room in the first.
    fn name_places(&self, labels: &mut Labels) {
        /// Both rows, below the plot.
        const ROWS: [f32; 2] = [2.0, 42.0];
        let decision = self.segment.decision;
        // With room between two of them: that of a letter was not seen in 0.41.0.
        let half = |text: &str| HALF_LETTER * (text.chars().count() + 3) as f32;
        let p = decision.input_step.sample as f64;
        let step = format!("p = {}", decision.input_step.sample);
        let mut names = vec![(self.output.x(p), step)];
        if let Some((_, delay)) = decision.shown_candidate().zip(decision.delay()) {
            let place = self.segment.place().unwrap_or_default();
            let text = match decision.delay_before_review() {
                None => format!("q = {place}"),
                Some(_) => format!("q = {place} by a reviewer"),
            };
            names.push((self.output.x(p + delay), text));
        }
        if let [(at_p, step), (at_q, text)] = &mut names[..] {
            let (of_p, of_q) = (half(step), half(text));
            if collide((*at_p, of_p), (*at_q, of_q)) {
                let side = if at_q < at_p { -1.0 } else { 1.0 };
                let middle = f32::midpoint(*at_p, *at_q);
                (*at_p, *at_q) = (middle - side * of_p, middle + side * of_q);
            }
        }
        if let Some((best, delay)) = decision.candidates.best().zip(decision.delay_before_review())
        {
            let (q, sse) = (number(p + delay), number(best.sse));
            names.push((self.output.x(p + delay), format!("program: q = {q}, SSE = {sse}")));
        }
        let ends = [("r", decision.segment.first), ("end", decision.segment.last)];
        names.extend(ends.map(|(name, k)| (self.output.x(k as f64), format!("{name} = {k}"))));
        let mut taken: Vec<(f32, f32)> = Vec::new();
        for (x, text) in names {
            let half = half(&text);
            let x = x.min(SIDES.1 + 60.0 - half).max(half);
            let row = usize::from(taken.iter().any(|other| collide((x, half), *other)));
            if row == 0 {
                taken.push((x, half));
            }
            labels.put(Vec2D::new(x, self.output.bottom + ROWS[row]), text);
        }
    }

    fn names(&self) -> Labels {
        let decision = self.segment.decision;
        let mut labels = Labels::default();
        if let Some(delay) = decision.delay() {
            let seconds = number(delay * self.trial.trial.period().seconds());
            let own = decision.fine.filter(|_| decision.delay_before_review().is_none());
            let interval = own.map_or_else(String::new, |fine| {
                format!(" ({} … {})", number(fine.low), number(fine.high))
            });
            let text = format!("δ = {}{interval} = {seconds} s", samples_text(delay));
            CloseUp::title(&mut labels, text);
        }
        self.name_places(&mut labels);
        let output = bracketed("output", self.trial.estimated.joint.output_unit.as_deref());
        labels.put_whole(Vec2D::new(62.0, 22.0), output);
        labels.put(Vec2D::new(75.0, 442.0), "residual".to_owned());
        let least = self.segment.decision.shown_candidate();
        let least = least.map_or_else(String::new, |best| format!(", least {}", number(best.sse)));
        labels.put_whole(Vec2D::new(190.0, 550.0), format!("SSE (log){least}"));
        labels
    }
}

/// Whether two texts whose middles and halves these are would cover each other.
fn collide(a: (f32, f32), b: (f32, f32)) -> bool {
    (a.0 - b.0).abs() < a.1 + b.1
}

/// Ticks without those whose text would cover that of the one before, in a small window.
fn apart(ticks: Vec<(f64, String)>, plot: &Plot) -> Vec<(f64, String)> {
    /// Height of a line of text on the sheet in a window of 1280 points.
    const LINE: f32 = 46.0;
    let mut kept: Vec<(f64, String)> = Vec::new();
    for tick in ticks.into_iter().rev() {
        if kept.last().is_none_or(|(last, _)| (plot.y(*last) - plot.y(tick.0)).abs() >= LINE) {
            kept.push(tick);
        }
    }
    kept
}

/// A row per candidate; empty ones at the opening and the verdict tick.
fn add_candidates(chunks: &mut Chunks, drawings: &[Drawing<'_, '_>]) -> Result<(), RecordError> {
    let ticks = drawings.iter().flat_map(|drawing| {
        let (trial, segment) = (drawing.trial, drawing.segment);
        trial
            .ticks(segment)
            .map(move |(moment, candidate)| (trial.within(segment, moment), (drawing, candidate)))
    });
    let (moments, rows): (Vec<_>, Vec<_>) = ticks.unzip();
    let lines = rows.iter().map(|(drawing, candidate)| {
        candidate.map_or_else(Vec::new, |candidate| drawing.candidate(&candidate))
    });
    let marks = rows.iter().map(|(drawing, candidate)| {
        let mut marks = Labels::default();
        if let Some(candidate) = candidate {
            let p = signed(drawing.segment.decision.input_step.sample);
            let (q, sse) = (signed(candidate.breakpoint), number(candidate.sse));
            marks.put(drawing.error_at(candidate), format!("q {q}, δ {}, SSE {sse}", q - p));
        }
        marks
    });
    let mut layers = Layers::rows(chunks, paths::DRAWING, moments.into_iter().collect());
    layers.strips("candidate", palette::CANDIDATE, 2.0, lines)?;
    layers.named_points("candidate/mark", palette::CANDIDATE, 7.0, marks)
}
