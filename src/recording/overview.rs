//! The whole record of a joint: its signals, sample by sample; chosen lines, breakpoints, delays; and maps
//! of it, a small and a large one, on which the segment under the cursor is framed.

use rerun::components::{InterpolationMode, MarkerShape};
use rerun::{Boxes2D, SeriesLines, SeriesPoints};

use super::canvas::{Layers, Plot, SHEET};
use super::chunk::{Chunks, Index, line};
use super::error::RecordError;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::palette::{self, Rgb, color};
use super::panels::{self, Placed};
use super::paths::{self, child};
use crate::delay::{Candidate, Line};
use crate::report::page::delays::{dead_time_panel, delay_panel, record_panels};
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
    add_maps(chunks, layout)
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

/// Height of the small map on its sheet.
pub(super) const MAP_HEIGHT: f32 = 220.0;

/// Height of the large one.
pub(super) const LARGE_HEIGHT: f32 = 680.0;

/// Left and right end of all plots: room for labels on the left.
const SIDES: (f32, f32) = (120.0, SHEET.0 - 15.0);

/// Adds the record on one sheet, drawn once: it stays whatever the timeline. The small map is beside
/// the drawing of a segment; the large one is a page of its own, which has the delays as well.
fn add_maps(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    let timeline = layout.timeline();
    let [output, input] = record_panels(layout.estimated, &timeline);
    let delay = match &layout.estimated.estimate.dead_time {
        Some(found) => dead_time_panel(found, &timeline),
        None => delay_panel(layout.estimated, &timeline),
    };
    let small = vec![
        Placed::unnamed(output.clone(), SIDES, 6.0..=124.0),
        Placed::unnamed(input.clone(), SIDES, 134.0..=174.0),
    ];
    // Where no delay is known, the output has its room.
    let rows = if delay.is_some() { 64.0..=298.0 } else { 64.0..=486.0 };
    let mut large =
        vec![Placed::new(output, SIDES, rows), Placed::new(input, SIDES, 566.0..=634.0)];
    large.extend(delay.map(|panel| Placed::new(panel, SIDES, 378.0..=486.0)));
    for (root, map, rows) in
        [(paths::MAP, small, (2.0, 178.0)), (paths::LARGE_MAP, large, (60.0, 638.0))]
    {
        let plot = map.first().map(|placed| placed.plot);
        panels::add(&mut Layers::fixed(chunks, root), [map])?;
        plot.map_or(Ok(()), |plot| add_frames(chunks, layout, (root, &plot, rows)))?;
    }
    Ok(())
}

/// A frame about each segment.
fn add_frames(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    (root, plot, (top, bottom)): (&'static str, &Plot, (f32, f32)),
) -> Result<(), RecordError> {
    let (mut centers, mut halves) = (Vec::new(), Vec::new());
    for (trial, segment) in layout.segments() {
        let ends = segment.decision.segment;
        let [left, right] = [ends.first, ends.last].map(|k| plot.x(trial.seconds(k)));
        centers.push([f32::midpoint(left, right), f32::midpoint(top, bottom)]);
        halves.push([(right - left).max(4.0) / 2.0, (bottom - top) / 2.0]);
    }
    let style = Boxes2D::update_fields().with_colors([color(palette::CANDIDATE)]);
    let lengths = vec![1; centers.len()];
    let mut layers = Layers::rows(chunks, root, layout.openings());
    layers.stays("here", &style.with_radii([1.5]))?;
    let boxes = Boxes2D::update_fields().with_centers(centers).with_half_sizes(halves);
    layers.push("here", &boxes, &lengths)
}

/// Adds all signals of `joint` below the entity `root`.
pub(super) fn add_signals(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    type Values = fn(&TrialLayout<'_>) -> Vec<Option<f64>>;
    type Drawn = (&'static str, String, (Rgb, f32), InterpolationMode, Values);
    // Input and delay are held between samples; what was measured is drawn from point to point.
    let (held, drawn) = (InterpolationMode::StepAfter, InterpolationMode::Linear);
    let joint = layout.joint;
    let unit = |unit: &Option<String>| bracketed("", unit.as_deref());
    let (input, output) = (unit(&joint.input_unit), unit(&joint.output_unit));
    let signals: [Drawn; 4] = [
        (paths::INPUT, format!("input{input}"), (palette::INPUT, 1.5), held, |trial| {
            known(trial.trial.input())
        }),
        (paths::OUTPUT_RAW, format!("measured{output}"), (palette::RAW, 1.0), drawn, |trial| {
            trial.logged(trial.trial.output())
        }),
        (
            paths::OUTPUT_SMOOTHED,
            format!("smoothed{output}"),
            (palette::SMOOTHED, 1.5),
            drawn,
            |trial| known(trial.output()),
        ),
        (paths::TAU, "delay τ [samples]".to_owned(), (palette::ACCEPTED, 1.5), held, |trial| {
            trial.estimate.profile.iter().collect()
        }),
    ];
    for (path, name, (rgb, width), mode, values) in signals {
        let style = line(name, rgb, width).with_interpolation_mode(mode);
        chunks.series(path, &style, layout.series(values))?;
    }
    for (index, signal) in joint.covariates.iter().enumerate() {
        let entity = child(paths::COVARIATE, &signal.name);
        let style =
            SeriesLines::new().with_names([format!("{}{}", signal.name, unit(&signal.unit))]);
        let values = layout.series(|trial| {
            let values = trial.trial.covariates().get(index);
            values.into_iter().flatten().map(|v| (!v.is_nan()).then_some(*v)).collect()
        });
        chunks.series(entity, &style, values)?;
    }
    Ok(())
}

/// Values at every sample.
fn known(values: &[f64]) -> Vec<Option<f64>> {
    values.iter().copied().map(Some).collect()
}
