//! What other methods, settings or logs gave for a step, beside the decision; the decisions by how much
//! they differ from that: both delays over the record and by rank, lines to click, and what there is to say.

use super::canvas::{Layers, Plot, SHEET, Span};
use super::chunk::Chunks;
use super::error::RecordError;
use super::layout::{JointLayout, Placed as Segment};
use super::markdown::plain;
use super::palette::{self, Rgb, role};
use super::panels::{self, Placed};
use super::paths;
use crate::delay::Verdict;
use crate::figure::{Axis, Mark, Panel, Place, Role, Shape};
use crate::report::{EstimatedJoint, Recording};
use crate::study::{JointDifferences, JointResult, StepPair, StepResult};
use crate::wording::{
    difference_in_short, difference_sentences, interval, number, result_in_short, step_name,
    verdict_in_short,
};

/// Width and height of the drawing.
pub(super) const SIZE: (f32, f32) = (SHEET.0, 344.0);

/// Adds `/difference`, `/difference/log` and the drawing.
pub(super) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    others: &[Other<'_>],
) -> Result<(), RecordError> {
    if others.is_empty() {
        return Ok(());
    }
    let ranked = layout.ranked(|segment| segment.difference);
    let shown: Vec<_> = ranked.iter().filter(|placed| differs(placed, others)).collect();
    let index = layout
        .at_the_end(shown.len())
        .with("difference", shown.iter().map(|(_, segment)| segment.difference))
        .all_at("doubt", Some(1));
    let lines = shown.iter().map(|placed| (Some(level(placed, others)), line(placed, others)));
    chunks.lines(paths::DIFFERENCE_LOG, index, lines)?;
    chunks.page(paths::DIFFERENCE, page(&layout.joint.name, others))?;
    draw(chunks, layout, others)
}

/// What others say of a step.
fn pairs<'o>(
    (trial, segment): &Segment<'_, '_>,
    others: &'o [Other<'_>],
) -> impl Iterator<Item = (&'o str, &'o StepPair)> {
    let (label, p) = (trial.trial.label(), segment.decision.input_step.sample);
    others.iter().filter_map(move |other| Some((other.name, other.pair(label, p)?)))
}

fn differs(placed: &Segment<'_, '_>, others: &[Other<'_>]) -> bool {
    pairs(placed, others).any(|(_, pair)| pair.differs())
}

/// Red where a verdict differs.
fn level(placed: &Segment<'_, '_>, others: &[Other<'_>]) -> &'static str {
    let other_verdict =
        |(_, pair): (&str, &StepPair)| pair.here.is_accepted() != pair.there.is_accepted();
    if pairs(placed, others).any(other_verdict) { "ERROR" } else { "INFO" }
}

fn line(placed: &Segment<'_, '_>, others: &[Other<'_>]) -> String {
    let trials = placed.0.estimated.joint.trials.len();
    let said = pairs(placed, others).map(|(name, pair)| {
        let there = result_in_short(&pair.there);
        format!("{name} {there} ({})", difference_in_short(pair))
    });
    let said: Vec<_> = said.collect();
    let step = pairs(placed, others).next().map_or_else(String::new, |(_, pair)| {
        format!("{}: here {}", step_name(&pair.here, trials), result_in_short(&pair.here))
    });
    format!("{step}, {}", said.join(", "))
}

fn page(joint: &str, others: &[Other<'_>]) -> String {
    let parts = others.iter().map(|other| part(joint, other));
    format!("{}\n{HOW}", parts.collect::<String>())
}

fn part(joint: &str, other: &Other<'_>) -> String {
    let settings = other.settings.filter(|settings| *settings != other.name);
    let settings = settings.map_or_else(String::new, |settings| format!(" ({})", plain(settings)));
    let sentences = difference_sentences(&other.differences).into_iter();
    let sentences: Vec<_> = sentences.map(|sentence| plain(&sentence)).collect();
    let (name, other) = (plain(joint), plain(other.name));
    format!("**{name} against {other}**{settings}\n\n- {}\n\n", sentences.join("\n- "))
}

const HOW: &str = "\
On the timeline `difference` (bottom left) the right arrow goes from the largest difference on: \
first the steps that one result accepts and the other rejects, then those with another delay. A \
click on a number in the list leads to its step.";

/// Both delays over the record (above), and their difference by rank (below).
fn draw(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    others: &[Other<'_>],
) -> Result<(), RecordError> {
    let steps: Vec<Step> = layout.segments().flat_map(|placed| of_step(&placed, others)).collect();
    let mut placed = vec![Placed::new(delays(&steps, others), SIDES, 44.0..=165.0)];
    placed.extend(ranks(&steps).map(|panel| Placed::new(panel, SIDES, 250.0..=312.0)));
    let plots: Vec<Plot> = placed.iter().map(|placed| placed.plot).collect();
    panels::add(&mut Layers::fixed(chunks, paths::DIFFERENCE_SHEET), [placed])?;
    let last = plots.last().map_or(0.0, |plot| plot.x_span.high);
    let here = layout.segments().map(|(trial, segment)| {
        let time = trial.seconds(segment.decision.input_step.sample);
        let places = [time, (segment.difference as f64).min(last)];
        let here = |at: f64| {
            Mark::new(role(palette::CANDIDATE), Shape::Verticals(vec![at], 1.6)).part("here")
        };
        places.map(here).into_iter().zip(plots.iter().copied()).collect()
    });
    let rows = Layers::rows(chunks, paths::DIFFERENCE_SHEET, layout.openings());
    panels::add_marks(&mut rows.in_front(), here)
}

/// Left and right end of both plots.
const SIDES: (f32, f32) = (120.0, SHEET.0 - 15.0);

/// A step as it is drawn.
struct Step {
    time_s: f64,
    rank: f64,
    here: Option<f64>,
    there: Option<f64>,
    difference: f64,
    other_verdict: bool,
}

/// The delays of each step here and there, a line between them; a red line through the plot where one
/// result accepts what the other rejects.
fn delays(steps: &[Step], others: &[Other<'_>]) -> Panel {
    let places = |delay: fn(&Step) -> Option<f64>| -> Vec<Place> {
        steps.iter().filter_map(|step| Some((step.time_s, delay(step)?))).collect()
    };
    let alike = steps.iter().filter(|step| !step.other_verdict);
    let links =
        alike.filter_map(|step| Some(vec![(step.time_s, step.here?), (step.time_s, step.there?)]));
    let odd = steps.iter().filter(|step| step.other_verdict).map(|step| step.time_s).collect();
    let known = steps.iter().flat_map(|step| [step.here, step.there]).flatten();
    let y = Span::around(known.chain([0.0]), 0.08);
    let x = Span::around(steps.iter().map(|step| step.time_s), 0.01);
    let names: Vec<_> = others.iter().map(|other| other.name).collect();
    let marks = vec![
        Mark::lines(Role::Faint, 1.8, links.collect()).part("links"),
        Mark::new(Role::Accepted, Shape::Dots(places(|step| step.here), 5.0)).named("here"),
        Mark::new(role(palette::OTHER), Shape::Crosses(places(|step| step.there)))
            .named(names.join(", "))
            .part("there"),
        Mark::new(Role::Rejected, Shape::Verticals(odd, 1.8))
            .named("rejected there or here")
            .part("other_verdict"),
    ];
    Panel { x: Axis::new(x, "", 10.0), y: Axis::new(y, "delay [s]", 3.0), height: 80, marks }
}

/// By how much the delays differ, the largest first; of a step with another verdict a mark where there
/// is no difference to show. None where nothing differs.
fn ranks(steps: &[Step]) -> Option<Panel> {
    let ranked = || steps.iter().filter(|step| step.other_verdict || step.difference != 0.0);
    let bars = |other_verdict: bool| {
        let own = ranked().filter(|step| step.other_verdict == other_verdict);
        own.map(|step| vec![(step.rank, 0.0), (step.rank, step.difference)]).collect()
    };
    let odd = ranked().filter(|step| step.other_verdict).map(|step| (step.rank, 0.0)).collect();
    let last = ranked().map(|step| step.rank).reduce(f64::max)?;
    let y = Span::around(steps.iter().map(|step| step.difference).chain([0.0]), 0.08);
    let name = "delay here − there [s], the largest first";
    let marks = vec![
        Mark::lines(Role::Smoothed, 1.8, bars(false)).part("bars"),
        Mark::lines(Role::Rejected, 1.8, bars(true)).part("other_verdict"),
        Mark::new(Role::Rejected, Shape::Crosses(odd)).part("other_verdict"),
    ];
    let x = Axis::new(Span::new(0.0, last + 1.0), "", 10.0);
    Some(Panel { x, y: Axis::new(y, name, 3.0), height: 40, marks })
}

/// Each result that has the step, as it is drawn.
fn of_step(placed: &Segment<'_, '_>, others: &[Other<'_>]) -> Vec<Step> {
    let (trial, segment) = placed;
    let time_s = trial.seconds(segment.decision.input_step.sample);
    let accepted = |step: &StepResult| step.delay_s.filter(|_| step.verdict == Verdict::Accepted);
    let drawn = |(_, pair): (&str, &StepPair)| Step {
        time_s,
        rank: segment.difference as f64,
        here: accepted(&pair.here),
        there: accepted(&pair.there),
        difference: if pair.differs() { pair.difference_s().unwrap_or(0.0) } else { 0.0 },
        other_verdict: pair.here.is_accepted() != pair.there.is_accepted(),
    };
    pairs(placed, others).map(drawn).collect()
}

/// Another result on one joint.
#[derive(Debug)]
pub(super) struct Other<'a> {
    pub(super) name: &'a str,
    pub(super) settings: Option<&'a str>,
    pub(super) rgb: Rgb,
    pub(super) differences: JointDifferences,
}

impl<'a> Recording<'a> {
    /// What other results say of the joint, in the order they were asked for.
    pub(super) fn others(&self, estimated: EstimatedJoint<'_>) -> Vec<Other<'a>> {
        if self.also.is_empty() {
            return Vec::new();
        }
        let here = JointResult::of(estimated.joint, estimated.estimate);
        let known = self.also.iter().zip(palette::others());
        let known = known.filter_map(|(other, rgb)| Some((other, other.joint(&here.joint)?, rgb)));
        known
            .map(|(other, there, rgb)| Other {
                name: &other.name,
                settings: other.settings.as_deref(),
                rgb,
                differences: JointDifferences::of(&here, Some(there)),
            })
            .collect()
    }
}

impl Other<'_> {
    /// What it says of the step at sample `p` of the trial `label`.
    pub(super) fn pair(&self, label: &str, p: usize) -> Option<&StepPair> {
        self.differences.pair(label, p)
    }
}

/// How much the results differ most on the step at sample `p` of the trial `label`: see
/// [`StepPair::weight`].
pub(super) fn weight(others: &[Other<'_>], label: &str, p: usize) -> (u8, f64) {
    let pairs = others.iter().filter_map(|other| other.pair(label, p));
    let larger = |a: (u8, f64), b: (u8, f64)| if b > a { b } else { a };
    pairs.map(StepPair::weight).fold((0, 0.0), larger)
}

/// The line of the result `name` in a legend, by what it says of a step; its interval is drawn.
pub(super) fn in_short(step: &StepResult, name: &str) -> String {
    let delay = step.delay.map_or_else(|| "none".to_owned(), number);
    match step.verdict {
        Verdict::Accepted => format!("{name}: δ = {delay} ✓"),
        Verdict::Rejected(condition) => format!("{name}: δ = {delay} ✗ {condition}"),
    }
}

/// The row of the result `name` in a table: its delay with the interval in samples, and its verdict.
pub(super) fn row(step: &StepResult, name: &str) -> String {
    let delay = step.delay.map_or_else(|| "none".to_owned(), number);
    let ends = step.interval.map_or_else(String::new, |ends| format!(" ({})", interval(ends)));
    format!("| {name} | {delay}{ends} | {} |", verdict_in_short(step.verdict, "✓ accepted"))
}
