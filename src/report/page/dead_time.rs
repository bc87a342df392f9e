//! The dead time of a joint whose input moves all the time: in windows, and how it was found.

use super::document::{Block, Figure, WIDTH};
use super::timeline::Timeline;
use crate::delay::{Bounds, DeadTime};
use crate::figure::{Axis, Mark, Panel, Place, Role, Shape, Span};
use crate::report::{EstimatedJoint, dead_time_sentences};

/// What is said and drawn of it; nothing for an input that is made of steps.
pub(super) fn blocks(estimated: EstimatedJoint<'_>, file: &str) -> Vec<Block> {
    let Some(found) = &estimated.estimate.dead_time else { return Vec::new() };
    let mut blocks = vec![Block::part("Dead time")];
    let sentences = dead_time_sentences(&estimated);
    blocks.extend(sentences.into_iter().map(|sentence| Block::text(format!("{sentence}."))));
    let mut figures = Vec::new();
    figures.extend(over_time(estimated, found, format!("{file}-windows")));
    figures.extend(curve(estimated, found, format!("{file}-dead-time")));
    if !figures.is_empty() {
        blocks.push(Block::Figures(figures));
    }
    blocks
}

/// The dead time of each window, with its interval.
fn over_time(estimated: EstimatedJoint<'_>, found: &DeadTime, file: String) -> Option<Figure> {
    let panels = vec![panel(found, &Timeline::of(estimated.joint))?];
    let name = format!("Dead time of {} over time", estimated.joint.name);
    let caption = "The dead time in windows of the record, with intervals; where the input moves \
                   the output too little there is none."
        .to_owned();
    Some(Figure { file, name, width: WIDTH, panels, caption })
}

pub(crate) fn panel(found: &DeadTime, timeline: &Timeline<'_>) -> Option<Panel> {
    let known = found.windows.iter().filter_map(|window| {
        let at = |sample: usize| timeline.at(window.trial, sample as f64);
        Some((at(window.first), at(window.last), window.estimate?))
    });
    let known: Vec<(f64, f64, Bounds)> = known.collect();
    if known.is_empty() {
        return None;
    }
    let middle = |(from, to, _): &(f64, f64, Bounds)| f64::midpoint(*from, *to);
    let interval =
        |one: &(f64, f64, Bounds)| vec![(middle(one), one.2.low_s), (middle(one), one.2.high_s)];
    let reach = |(from, to, b): &(f64, f64, Bounds)| vec![(*from, b.value_s), (*to, b.value_s)];
    let dots: Vec<Place> = known.iter().map(|one| (middle(one), one.2.value_s)).collect();
    let intervals: Vec<Vec<Place>> = known.iter().map(interval).collect();
    let y = Span::around(intervals.iter().flatten().map(|place| place.1), 0.14);
    let mut marks = vec![timeline.borders()];
    if let Some(Bounds { low_s, high_s, .. }) = found.bounds() {
        marks.push(Mark::new(Role::Noise, Shape::Band(low_s, high_s)).named("whole record"));
    }
    let reaches = known.iter().map(reach).collect();
    marks.push(Mark::lines(Role::Smoothed, 1.0, reaches).named("window"));
    marks.push(Mark::lines(Role::Faint, 1.4, intervals).named("interval"));
    marks.push(Mark::dots(Role::Accepted, dots).named("dead time"));
    let axis = Axis::new(y, "dead time [s]", 5.0);
    Some(Panel { x: timeline.axis(), y: axis, height: 150, marks })
}

/// The prediction error of each dead time.
fn curve(estimated: EstimatedJoint<'_>, found: &DeadTime, file: String) -> Option<Figure> {
    let points: Vec<Place> = found.curve.iter().map(|p| (p.delay_s, p.error)).collect();
    let (bounds, last) = found.bounds().zip(points.last())?;
    let y = Span::around(points.iter().map(|place| place.1), 0.1);
    let x = Axis::new(Span::new(0.0, last.0), "dead time [s]", 10.0);
    let marks = vec![
        Mark::new(Role::Noise, Shape::Spans(vec![(bounds.low_s, bounds.high_s)], 1.0))
            .named("interval"),
        Mark::new(Role::Accepted, Shape::Verticals(vec![bounds.value_s], 1.4)).named("dead time"),
        Mark::lines(Role::Error, 1.4, vec![points]).named("error"),
    ];
    let panel = Panel { x, y: Axis::new(y, "error over the least", 5.0), height: 150, marks };
    let name = format!("Prediction error of {} by dead time", estimated.joint.name);
    let caption = "The error of the prediction against the dead time, all else being fitted anew \
                   to each."
        .to_owned();
    Some(Figure { file, name, width: WIDTH, panels: vec![panel], caption })
}
