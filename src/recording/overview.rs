//! The whole record of a joint: chosen lines, breakpoints, delays; and maps of it, a small and a
//! large one, on which the segment under the cursor is framed.

use rerun::components::{Color, MarkerShape};
use rerun::datatypes::Vec2D;
use rerun::{Boxes2D, EntityPath, Points2D, Scalars, SeriesLines, SeriesPoints};

use super::canvas::{Labels, Plot, SHEET, Span, thinned};
use super::chunk::{Chunks, Index, Moment};
use super::error::RecordError;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::palette::{self, Rgb, color};
use super::paths::{self, at, map};
use super::sheet::strips;
use crate::delay::{Candidate, Line, Verdict};
use crate::experiment::Joint;
use crate::wording::{bracketed, number};

/// Adds everything of the overview below `root`.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    joint: &Joint,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    add_lines(chunks, root, layout)?;
    for (kind, [on_output, on_delay], rgb, marker) in [
        (
            Kind::Accepted,
            [paths::BREAKPOINT_ACCEPTED, paths::DELAY_ACCEPTED],
            palette::ACCEPTED,
            MarkerShape::Circle,
        ),
        (
            Kind::Rejected,
            [paths::BREAKPOINT_REJECTED, paths::DELAY_REJECTED],
            palette::REJECTED,
            MarkerShape::Cross,
        ),
    ] {
        let style = Marks { kind, color: color(rgb), marker };
        let breakpoint = |s: &SegmentLayout<'_>| {
            let best = s.decision.shown_candidate()?;
            Some((best.breakpoint, best.after.at(best.breakpoint as f64)))
        };
        style.add(chunks, at(root, on_output), layout, breakpoint)?;
        let delay = |s: &SegmentLayout<'_>| {
            // A breakpoint before its step would stretch the plot for no delay at all.
            let delay = s.decision.delay().filter(|delay| *delay >= 0.0)?;
            Some((s.decision.input_step.sample, delay))
        };
        style.add(chunks, at(root, on_delay), layout, delay)?;
    }
    Map::small(layout).add(chunks, &at(root, map::ROOT), layout)?;
    Map::large(layout, joint).add(chunks, &at(root, map::LARGE), layout)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Accepted,
    Rejected,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Rejected => "rejected",
        }
    }

    fn of(segment: &SegmentLayout<'_>) -> Self {
        match segment.decision.verdict() {
            Verdict::Accepted => Self::Accepted,
            Verdict::Rejected(_) => Self::Rejected,
        }
    }
}

struct Marks {
    kind: Kind,
    color: Color,
    marker: MarkerShape,
}

impl Marks {
    /// A mark per segment of one kind, at the sample and value that `place` gives.
    fn add(
        &self,
        chunks: &mut Chunks,
        entity: EntityPath,
        layout: &JointLayout<'_>,
        place: impl Fn(&SegmentLayout<'_>) -> Option<(usize, f64)>,
    ) -> Result<(), RecordError> {
        let segments = layout.segments().filter(|(_, segment)| Kind::of(segment) == self.kind);
        let marks: Vec<(Moment, f64)> = segments
            .filter_map(|(trial, segment)| {
                let (k, value) = place(segment)?;
                Some((trial.moment_of(k), value))
            })
            .collect();
        let style = SeriesPoints::new().with_names([self.kind.name()]).with_colors([self.color]);
        let style = style.with_markers([self.marker]).with_marker_sizes([4.0]);
        chunks.push_static(entity.clone(), &style)?;
        let index: Index = marks.iter().map(|(moment, _)| *moment).collect();
        let index = index.without_segment();
        let values = Scalars::new(marks.iter().map(|(_, value)| *value));
        chunks.push(entity, index, values.columns_of_unit_batches()?)
    }
}

/// The chosen pair of lines of every segment, each from end to end.
fn add_lines(
    chunks: &mut Chunks,
    root: &EntityPath,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
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
        let mut index = Index::default();
        let (mut values, mut lengths) = (Vec::new(), Vec::new());
        for (trial, segment) in layout.segments() {
            let Some(best) = segment.decision.shown_candidate() else { continue };
            let (line, ends) = side(&best, segment);
            let steps = [segment.decision.input_step.sample, segment.decision.next_sample()];
            for k in vertices(ends, steps) {
                index.extend([trial.moment_of(k)]);
                values.push(line.at(k as f64));
                lengths.push(1);
            }
            index.extend([trial.moment_of(ends[1])]);
            lengths.push(0);
        }
        let entity = at(root, path);
        let style = SeriesLines::new().with_names([name]);
        let style = style.with_colors([color(rgb)]).with_widths([2.0]);
        chunks.push_static(entity.clone(), &style)?;
        chunks.push(entity, index.without_segment(), Scalars::new(values).columns(lengths)?)?;
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
            output: Plot::new(6.0..=96.0, x, output),
            input: Plot::new(104.0..=138.0, x, input),
            delay: None,
            titles: Vec::new(),
            rows: (2.0, 142.0),
        }
    }

    /// A page of its own, which is there on timelines that have no samples.
    fn large(layout: &JointLayout<'_>, joint: &Joint) -> Self {
        let [x, output, input] = spans(layout);
        let known: Vec<f64> = delays(layout).map(|(_, delay_s, _)| delay_s).collect();
        let delay = Span::around(known.iter().copied().chain([0.0]), 0.08);
        // Where no delay is known, the output has its room.
        let delay_plot = (!known.is_empty()).then(|| Plot::new(398.0..=486.0, x, delay));
        let output_rows = if delay_plot.is_some() { 64.0..=318.0 } else { 64.0..=486.0 };
        let output_plot = Plot::new(output_rows, x, output);
        let input_plot = Plot::new(566.0..=634.0, x, input);
        let middle = f64::midpoint(x.low, x.high);
        let unit = |name: &str, unit: &Option<String>| bracketed(name, unit.as_deref());
        let output = unit("output", &joint.output_unit);
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
            (Some(&input_plot), unit("input", &joint.input_unit)),
        ];
        let titles = titles.into_iter();
        let titles = titles.filter_map(|(plot, title)| Some((plot?.above(middle, TITLE), title)));
        let titles = titles.collect();
        Self {
            output: output_plot,
            input: input_plot,
            delay: delay_plot,
            titles,
            rows: (60.0, 638.0),
        }
    }

    fn add(
        &self,
        chunks: &mut Chunks,
        root: &EntityPath,
        layout: &JointLayout<'_>,
    ) -> Result<(), RecordError> {
        let mut labels = Labels::default();
        let named = |span: Span, count| {
            span.ticks(count).into_iter().map(|y| (y, number(y))).collect::<Vec<_>>()
        };
        let x_ticks = self.output.x_span().ticks(12.0);
        let mut grid = self.output.grid(&x_ticks, &named(self.output.y_span(), 3.0), &mut labels);
        grid.extend(self.input.grid(&x_ticks, &named(self.input.y_span(), 1.5), &mut labels));
        // Beside the drawing of a segment the plots are so low that ticks would cover each other.
        if self.titles.is_empty() {
            labels.keep_apart(TICK_HEIGHT);
        }
        if let Some(plot) = &self.delay {
            grid.extend(plot.grid(&x_ticks, &named(plot.y_span(), 2.0), &mut labels));
        }
        for k in x_ticks {
            labels.put_whole(self.input.below(k, 4.0), number(k));
        }
        for (place, title) in &self.titles {
            labels.put(*place, title.clone());
        }
        strips(chunks, at(root, map::GRID), palette::GRID, 0.7, grid)?;
        let outputs = layout.trials.iter().map(|trial| self.output_curve(trial)).collect();
        strips(chunks, at(root, map::OUTPUT), palette::SMOOTHED, 1.2, outputs)?;
        let inputs = layout.trials.iter().map(|trial| self.input_curve(trial)).collect();
        strips(chunks, at(root, map::INPUT), palette::INPUT, 1.2, inputs)?;
        for (path, rgb, kind) in [
            (map::ACCEPTED, palette::ACCEPTED, Kind::Accepted),
            (map::REJECTED, palette::REJECTED, Kind::Rejected),
        ] {
            let breaks = layout.segments().filter(|(_, segment)| Kind::of(segment) == kind);
            let breaks = breaks.filter_map(|(t, s)| self.breakpoint(t, s));
            let own = delays(layout).filter(|(.., of)| *of == kind);
            let delays = own.filter_map(|(k, delay_s, _)| Some(self.delay?.at(k, delay_s)));
            let places: Vec<_> = breaks.chain(delays).collect();
            let points = Points2D::new(places).with_colors([color(rgb)]).with_radii([3.0]);
            chunks.push_static(at(root, path), &points)?;
        }
        let texts = Points2D::new(labels.places).with_labels(labels.texts).with_radii([0.01]);
        let texts = texts.with_colors([color(palette::BORDER)]).with_show_labels(true);
        chunks.push_static(at(root, map::TICKS), &texts)?;
        self.add_frames(chunks, &at(root, map::HERE), layout)
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

    fn add_frames(
        &self,
        chunks: &mut Chunks,
        entity: &EntityPath,
        layout: &JointLayout<'_>,
    ) -> Result<(), RecordError> {
        let index = layout.openings();
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
        chunks.push_static(entity.clone(), &style.with_radii([1.5]))?;
        let boxes = Boxes2D::update_fields().with_centers(centers).with_half_sizes(halves);
        chunks.push(entity.clone(), index, boxes.columns_of_unit_batches()?)
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

/// Sample and delay in seconds of each step that has one, or of each window where there are no
/// steps. A rejected one that is longer than all accepted ones, as at the end of a long hold, or
/// before its step, is left out: it would press the others together.
fn delays<'l>(layout: &'l JointLayout<'_>) -> impl Iterator<Item = (f64, f64, Kind)> + 'l {
    let longest = layout.segments().filter_map(|(_, s)| s.decision.accepted_delay());
    let longest = longest.reduce(f64::max).map(|longest| 1.2 * longest);
    let of_steps = layout.segments().filter_map(move |(trial, segment)| {
        let delay = segment.decision.delay().filter(|delay| *delay >= 0.0)?;
        let is_shown = longest.is_none_or(|longest| delay <= longest);
        let k = trial.sample(segment.decision.input_step.sample) as f64;
        let delay_s = delay * trial.trial.period().seconds();
        is_shown.then_some((k, delay_s, Kind::of(segment)))
    });
    let without_steps = layout.trials.iter().filter(|trial| trial.segments.is_empty());
    let of_windows = without_steps.flat_map(|trial| {
        let period_s = trial.trial.period().seconds();
        let all: Vec<Option<f64>> = trial.estimate.profile.iter().collect();
        let every = all.len().div_ceil(WINDOW_POINTS).max(1);
        let kept = all.into_iter().zip(1..).step_by(every);
        let kept = kept.filter_map(move |(delay, k)| {
            Some((trial.sample(k) as f64, delay? * period_s, Kind::Accepted))
        });
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
    thinned(signal).into_iter().map(place).collect()
}

/// Width of the sheet, for the view's bounds.
pub(super) const MAP_WIDTH: f32 = SHEET.0;
