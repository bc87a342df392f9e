//! The whole record of a joint: chosen lines, breakpoints, delays; and maps of it, a small and a
//! large one, on which the segment under the cursor is framed.

use rerun::components::MarkerShape;
use rerun::datatypes::Vec2D;
use rerun::{Boxes2D, SeriesPoints};

use super::canvas::{CURVE_POINTS, Plot, Span, thinned_to};
use super::chunk::{Chunks, Index, line};
use super::error::RecordError;
use super::layers::Layers;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::palette::{self, Rgb, color};
use super::paths;
use super::sheet::Sheet;
use crate::delay::{Candidate, Line};
use crate::wording::bracketed;

/// Adds everything of the overview below `root`.
pub(super) fn add(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    type Place = fn(&SegmentLayout<'_>) -> Option<(usize, f64)>;
    add_lines(chunks, layout)?;
    let breakpoint: Place = |segment| {
        let best = segment.decision.shown_candidate()?;
        Some((best.breakpoint, best.after.at(best.breakpoint as f64)))
    };
    let delay: Place = |segment| {
        // A breakpoint before its step would stretch the plot for no delay at all.
        let delay = segment.decision.delay().filter(|delay| *delay >= 0.0)?;
        Some((segment.decision.input_step.sample, delay))
    };
    let [accepted, rejected] = KINDS;
    for (path, (is_accepted, name, rgb, marker), place) in [
        (paths::BREAKPOINT_ACCEPTED, accepted, breakpoint),
        (paths::DELAY_ACCEPTED, accepted, delay),
        (paths::BREAKPOINT_REJECTED, rejected, breakpoint),
        (paths::DELAY_REJECTED, rejected, delay),
    ] {
        let segments =
            layout.segments().filter(|(_, segment)| segment.is_accepted() == is_accepted);
        let marks = segments.filter_map(|(trial, segment)| {
            let (k, value) = place(segment)?;
            Some((trial.moment_of(k), Some(value)))
        });
        let (moments, values): (Vec<_>, Vec<_>) = marks.unzip();
        let style = SeriesPoints::new().with_names([name]).with_colors([color(rgb)]);
        let style = style.with_markers([marker]).with_marker_sizes([4.0]);
        chunks.push_static(path, &style)?;
        let index = moments.into_iter().collect::<Index>().without_segment();
        chunks.scalars(path, index, &values)?;
    }
    Map::small(layout).add(chunks, layout)?;
    Map::large(layout).add(chunks, layout)
}

/// Whether decisions are accepted; their name, colour and mark.
const KINDS: [(bool, &str, Rgb, MarkerShape); 2] = [
    (true, "accepted", palette::ACCEPTED, MarkerShape::Circle),
    (false, "rejected", palette::REJECTED, MarkerShape::Cross),
];

/// The chosen pair of lines of every segment, each from end to end.
fn add_lines(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    type Side = fn(&Candidate, &SegmentLayout<'_>) -> (Line, [usize; 2]);
    let before = |best: &Candidate, segment: &SegmentLayout<'_>| {
        (best.before, [segment.decision.segment.first, best.breakpoint])
    };
    let after = |best: &Candidate, segment: &SegmentLayout<'_>| {
        let q = best.breakpoint;
        // Where the next segment starts before this one ends, its lines take over.
        let end = segment.decision.segment.last.min(q + segment.decision.hold).max(q);
        (best.after, [q, end])
    };
    let sides: [(&str, &str, Rgb, Side); 2] = [
        (paths::LINE_BEFORE, "line before", palette::CANDIDATE, before),
        (paths::LINE_AFTER, "line after", palette::ACCEPTED, after),
    ];
    for (path, name, rgb, side) in sides {
        let (mut moments, mut values) = (Vec::new(), Vec::new());
        for (trial, segment) in layout.segments() {
            let Some(best) = segment.decision.shown_candidate() else { continue };
            let (line, ends) = side(&best, segment);
            let steps = [segment.decision.input_step.sample, segment.decision.next_sample()];
            for k in vertices(ends, steps) {
                moments.push(trial.moment_of(k));
                values.push(Some(line.at(k as f64)));
            }
            moments.push(trial.moment_of(ends[1]));
            values.push(None);
        }
        let index = moments.into_iter().collect::<Index>().without_segment();
        chunks.series(path, &line(name, rgb, 2.0), (index, values))?;
    }
    Ok(())
}

/// Both ends of a line and, between them, both sides of each step: there the timeline of
/// decisions jumps, and the line with it.
fn vertices([first, last]: [usize; 2], steps: [usize; 2]) -> Vec<usize> {
    let inside = |k: &usize| first < *k && *k < last;
    let between = steps.into_iter().flat_map(|step| [step - 1, step]).filter(inside);
    std::iter::once(first).chain(between).chain([last]).collect()
}

/// The record on one sheet, drawn once: it stays whatever the timeline.
struct Map {
    root: &'static str,
    output: Plot,
    input: Plot,
    /// Delays, in seconds, where there is room for them.
    delay: Option<Plot>,
    titles: Vec<(Vec2D, String)>,
    /// Height of the frame that marks a segment.
    rows: (f32, f32),
}

/// Height of the small map on its sheet.
pub(super) const MAP_HEIGHT: f32 = 182.0;

/// Height of a tick on the small one, in a window of 720 points.
const TICK_HEIGHT: f32 = 36.0;

/// Height of the large one.
pub(super) const LARGE_HEIGHT: f32 = 680.0;

impl Map {
    /// Beside the drawing of a segment.
    fn small(layout: &JointLayout<'_>) -> Self {
        let [x, output, input] = spans(layout);
        Self {
            root: paths::MAP,
            output: Plot::new(6.0..=96.0, x, output),
            input: Plot::new(104.0..=138.0, x, input),
            delay: None,
            titles: Vec::new(),
            rows: (2.0, 142.0),
        }
    }

    /// A page of its own, which is there on timelines that have no samples.
    fn large(layout: &JointLayout<'_>) -> Self {
        let [x, output, input] = spans(layout);
        let known: Vec<f64> = delays(layout).map(|(_, delay_s, _)| delay_s).collect();
        let delay = Span::around(known.iter().copied().chain([0.0]), 0.08);
        // Where no delay is known, the output has its room.
        let delay_plot = (!known.is_empty()).then(|| Plot::new(398.0..=486.0, x, delay));
        let output_rows = if delay_plot.is_some() { 64.0..=318.0 } else { 64.0..=486.0 };
        let output_plot = Plot::new(output_rows, x, output);
        let input_plot = Plot::new(566.0..=634.0, x, input);
        let unit = |name: &str, unit: &Option<String>| bracketed(name, unit.as_deref());
        let output = unit("output", &layout.joint.output_unit);
        let titles = if layout.segments().next().is_some() {
            [
                format!("{output} over samples; breakpoints green accepted, red rejected"),
                "delay [s] of each step: green accepted, red rejected".to_owned(),
            ]
        } else {
            [format!("{output} over samples"), "dead time of each window [s]".to_owned()]
        };
        let [output, delay] = titles;
        let titles = [
            (Some(&output_plot), output),
            (delay_plot.as_ref(), delay),
            (Some(&input_plot), unit("input", &layout.joint.input_unit)),
        ];
        let titles = titles.into_iter();
        let titles =
            titles.filter_map(|(plot, title)| Some((plot?.above(plot?.middle(), TITLE), title)));
        let titles = titles.collect();
        Self {
            root: paths::LARGE_MAP,
            output: output_plot,
            input: input_plot,
            delay: delay_plot,
            titles,
            rows: (60.0, 638.0),
        }
    }

    fn add(&self, chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
        let mut sheet = Sheet::default();
        let x_ticks = self.output.x_span().ticks(12.0);
        sheet.outline(&self.output, &x_ticks, &self.output.y_ticks(3.0));
        sheet.outline(&self.input, &x_ticks, &self.input.y_ticks(1.5));
        // Beside the drawing of a segment the plots are so low that ticks would cover each other.
        if self.titles.is_empty() {
            sheet.labels.keep_apart(TICK_HEIGHT);
        }
        if let Some(plot) = &self.delay {
            sheet.outline(plot, &x_ticks, &plot.y_ticks(2.0));
        }
        sheet.below(&self.input, 4.0, &x_ticks);
        for (place, title) in &self.titles {
            sheet.put(*place, title.clone());
        }
        let (grid, labels) = sheet.into_parts();
        let mut layers = Layers::fixed(chunks, self.root);
        layers.strips("grid", palette::GRID, 0.7, [grid])?;
        let outputs = layout.trials.iter().map(|trial| self.output_curve(trial)).collect();
        layers.strips("output", palette::SMOOTHED, 1.2, [outputs])?;
        let inputs = layout.trials.iter().map(|trial| self.input_curve(trial)).collect();
        layers.strips("input", palette::INPUT, 1.2, [inputs])?;
        for (is_accepted, name, rgb, _) in KINDS {
            let breaks =
                layout.segments().filter(|(_, segment)| segment.is_accepted() == is_accepted);
            let breaks = breaks.filter_map(|(t, s)| self.breakpoint(t, s));
            let own = delays(layout).filter(|(.., of)| *of == is_accepted);
            let delays = own.filter_map(|(k, delay_s, _)| Some(self.delay?.at(k, delay_s)));
            layers.points(name, rgb, 3.0, [breaks.chain(delays).collect()])?;
        }
        layers.texts("ticks", palette::BORDER, [labels])?;
        self.add_frames(chunks, layout)
    }

    fn output_curve(&self, trial: &TrialLayout<'_>) -> Vec<Vec2D> {
        self.output.places(curve(trial, trial.trial.output()))
    }

    /// The levels of the input, with an edge at every step; all of it where there are no steps.
    fn input_curve(&self, trial: &TrialLayout<'_>) -> Vec<Vec2D> {
        if trial.segments.is_empty() {
            return self.input.places(curve(trial, trial.trial.input()));
        }
        let first = trial.trial.input().first().copied().unwrap_or_default();
        let mut curve = vec![self.input.at(trial.sample(1) as f64, first)];
        let mut level = first;
        for segment in &trial.segments {
            let step = segment.decision.input_step;
            let k = trial.sample(step.sample) as f64;
            curve.extend([self.input.at(k, level), self.input.at(k, step.after)]);
            level = step.after;
        }
        curve.push(self.input.at(trial.sample(trial.trial.len()) as f64, level));
        curve
    }

    fn breakpoint(&self, trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) -> Option<Vec2D> {
        let best = segment.decision.shown_candidate()?;
        let y = best.after.at(best.breakpoint as f64);
        Some(self.output.at(trial.sample(best.breakpoint) as f64, y))
    }

    fn add_frames(&self, chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
        let (mut centers, mut halves) = (Vec::new(), Vec::new());
        for (trial, segment) in layout.segments() {
            let ends = segment.decision.segment;
            let [left, right] =
                [ends.first, ends.last].map(|k| self.output.x(trial.sample(k) as f64));
            let (top, bottom) = self.rows;
            centers.push([f32::midpoint(left, right), f32::midpoint(top, bottom)]);
            halves.push([(right - left).max(4.0) / 2.0, (bottom - top) / 2.0]);
        }
        let style = Boxes2D::update_fields().with_colors([color(palette::CANDIDATE)]);
        let lengths = vec![1; centers.len()];
        let mut layers = Layers::rows(chunks, self.root, layout.openings());
        layers.stays("here", &style.with_radii([1.5]))?;
        let boxes = Boxes2D::update_fields().with_centers(centers).with_half_sizes(halves);
        layers.push("here", &boxes, &lengths)
    }
}

/// Samples, output and input of the whole record.
fn spans(layout: &JointLayout<'_>) -> [Span; 3] {
    let last = layout.trials.iter().map(|trial| trial.sample(trial.trial.len())).max();
    let span = |values: for<'t> fn(&'t TrialLayout<'_>) -> &'t [f64]| {
        Span::around(layout.trials.iter().flat_map(|t| values(t).iter().copied()), 0.08)
    };
    [
        Span::new(1.0, last.unwrap_or(1) as f64),
        span(|trial| trial.trial.output()),
        span(|trial| trial.trial.input()),
    ]
}

/// Sample and delay in seconds of each step that has one, and whether it is accepted; or of each window where there are no
/// steps. A rejected one that is longer than all accepted ones, as at the end of a long hold, or
/// before its step, is left out: it would press the others together.
fn delays<'l>(layout: &'l JointLayout<'_>) -> impl Iterator<Item = (f64, f64, bool)> + 'l {
    let longest = layout.segments().filter_map(|(_, s)| s.decision.accepted_delay());
    let longest = longest.reduce(f64::max).map(|longest| 1.2 * longest);
    let of_steps = layout.segments().filter_map(move |(trial, segment)| {
        let delay = segment.decision.delay().filter(|delay| *delay >= 0.0)?;
        let is_shown = longest.is_none_or(|longest| delay <= longest);
        let k = trial.sample(segment.decision.input_step.sample) as f64;
        let delay_s = delay * trial.trial.period().seconds();
        is_shown.then_some((k, delay_s, segment.is_accepted()))
    });
    let without_steps = layout.trials.iter().filter(|trial| trial.segments.is_empty());
    let of_windows = without_steps.flat_map(|trial| {
        let period_s = trial.trial.period().seconds();
        let all: Vec<Option<f64>> = trial.estimate.profile.iter().collect();
        let every = all.len().div_ceil(WINDOW_POINTS).max(1);
        let kept = all.into_iter().zip(1..).step_by(every);
        let kept = kept
            .filter_map(move |(delay, k)| Some((trial.sample(k) as f64, delay? * period_s, true)));
        kept.collect::<Vec<_>>()
    });
    of_steps.chain(of_windows)
}

/// Points of the dead times of windows: more hide one another.
const WINDOW_POINTS: usize = 300;

/// How far above its plot a title is put, so that it covers no data in a small window.
const TITLE: f32 = 48.0;

/// A signal of a trial, thinned.
fn curve(trial: &TrialLayout<'_>, signal: &[f64]) -> Vec<(f64, f64)> {
    let place = |index: usize| {
        let value = signal.get(index).copied().unwrap_or_default();
        (trial.sample(index + 1) as f64, value)
    };
    thinned_to(signal, CURVE_POINTS).into_iter().map(place).collect()
}
