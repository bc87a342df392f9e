//! The decisions by how much they differ from those of other results: both delays over the
//! record and by rank, lines to click, and what there is to say.

use rerun::datatypes::Vec2D;

use super::beside::Other;
use super::canvas::{Plot, SHEET, Span, diamond};
use super::chunk::Chunks;
use super::error::RecordError;
use super::layers::Layers;
use super::layout::{JointLayout, Placed};
use super::markdown::plain;
use super::palette::{self, Rgb};
use super::paths;
use super::sheet::Sheet;
use crate::delay::Verdict;
use crate::study::{StepPair, StepResult};
use crate::wording::{difference_in_short, difference_sentences, result_in_short, step_name};

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
    (trial, segment): &Placed<'_, '_>,
    others: &'o [Other<'_>],
) -> impl Iterator<Item = (&'o str, &'o StepPair)> {
    let (label, p) = (trial.trial.label(), segment.decision.input_step.sample);
    others.iter().filter_map(move |other| Some((other.name, other.pair(label, p)?)))
}

fn differs(placed: &Placed<'_, '_>, others: &[Other<'_>]) -> bool {
    pairs(placed, others).any(|(_, pair)| pair.differs())
}

/// Red where a verdict differs.
fn level(placed: &Placed<'_, '_>, others: &[Other<'_>]) -> &'static str {
    let other_verdict =
        |(_, pair): (&str, &StepPair)| pair.here.is_accepted() != pair.there.is_accepted();
    if pairs(placed, others).any(other_verdict) { "ERROR" } else { "INFO" }
}

fn line(placed: &Placed<'_, '_>, others: &[Other<'_>]) -> String {
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
    let figure = Figure::of(layout, others);
    let mut sheet = Sheet::default();
    sheet.draw(&figure.delays, 10.0, &title(others));
    sheet.draw(
        &figure.ranks,
        10.0,
        "delay here − there [s], the largest first; red: one accepts what the other rejects",
    );
    let mut fixed = Layers::fixed(chunks, paths::DIFFERENCE_SHEET);
    fixed.sheets([sheet])?;
    for (path, rgb, shown) in figure.layers() {
        fixed.strips(path, rgb, 1.8, [shown])?;
    }
    let here = layout.segments().map(|(trial, segment)| {
        let time = trial.seconds(segment.decision.input_step.sample);
        let rank = (segment.difference as f64).min(figure.ranks.x_span().high);
        vec![figure.delays.vertical(time).to_vec(), figure.ranks.vertical(rank).to_vec()]
    });
    let mut rows = Layers::rows(chunks, paths::DIFFERENCE_SHEET, layout.openings());
    rows.strips("here", palette::CANDIDATE, 1.6, here)
}

/// What the plot of the delays shows.
fn title(others: &[Other<'_>]) -> String {
    let names: Vec<_> = others.iter().map(|other| other.name).collect();
    format!(
        "delay [s] of each step: here (green), {} (violet); red: rejected there or here",
        names.join(", ")
    )
}

/// A step at its place on both plots.
struct Mark {
    time_s: f64,
    rank: f64,
    here: Option<f64>,
    there: Option<f64>,
    difference: f64,
    other_verdict: bool,
}

struct Figure {
    marks: Vec<Mark>,
    delays: Plot,
    ranks: Plot,
}

impl Figure {
    fn of(layout: &JointLayout<'_>, others: &[Other<'_>]) -> Self {
        let marks: Vec<Mark> =
            layout.segments().flat_map(|placed| of_step(&placed, others)).collect();
        let times = marks.iter().map(|mark| mark.time_s);
        let delays = marks.iter().flat_map(|mark| [mark.here, mark.there]).flatten().chain([0.0]);
        let steps = marks.iter().filter(|mark| mark.has_rank()).map(|mark| mark.rank);
        let last = steps.fold(1.0, f64::max);
        let differences = marks.iter().map(|mark| mark.difference).chain([0.0]);
        Self {
            delays: Plot::new(44.0..=165.0, Span::around(times, 0.01), Span::around(delays, 0.08)),
            ranks: Plot::new(
                250.0..=312.0,
                Span::new(0.0, last + 1.0),
                Span::around(differences, 0.08),
            ),
            marks,
        }
    }

    /// The parts of the drawing, each of one colour.
    fn layers(&self) -> [(&'static str, Rgb, Vec<Vec<Vec2D>>); 5] {
        let marks = || self.marks.iter();
        let link = marks().filter(|mark| !mark.other_verdict).filter_map(|mark| {
            let (here, there) = (mark.here?, mark.there?);
            Some(vec![self.delays.at(mark.time_s, here), self.delays.at(mark.time_s, there)])
        });
        let other = marks().filter(|mark| mark.other_verdict);
        let other: Vec<_> = other.flat_map(|mark| self.other_verdict(mark)).collect();
        let bars = marks().filter(|mark| !mark.other_verdict && mark.has_rank());
        let bars = bars.map(|mark| self.bar(mark).to_vec());
        let here =
            marks().filter_map(|mark| Some(diamond(self.delays.at(mark.time_s, mark.here?), 4.0)));
        let there =
            marks().filter_map(|mark| Some(cross(self.delays.at(mark.time_s, mark.there?))));
        [
            ("links", palette::RAW, link.collect()),
            ("bars", palette::SMOOTHED, bars.collect()),
            ("delays/here", palette::ACCEPTED, here.collect()),
            ("delays/there", palette::OTHER, there.flatten().collect()),
            ("other_verdict", palette::REJECTED, other),
        ]
    }

    fn bar(&self, mark: &Mark) -> [Vec2D; 2] {
        [self.ranks.at(mark.rank, 0.0), self.ranks.at(mark.rank, mark.difference)]
    }

    /// A step with another verdict: a line through the whole plot of the delays, and its bar, or a
    /// mark where there is no difference to show.
    fn other_verdict(&self, mark: &Mark) -> [Vec<Vec2D>; 2] {
        let [Vec2D([x, zero]), _] = self.bar(mark);
        let mut bar = self.bar(mark).to_vec();
        bar.extend([Vec2D::new(x - 3.0, zero), Vec2D::new(x + 3.0, zero)]);
        [self.delays.vertical(mark.time_s).to_vec(), bar]
    }
}

impl Mark {
    fn has_rank(&self) -> bool {
        self.other_verdict || self.difference != 0.0
    }
}

/// A mark for each result that has the step.
fn of_step(placed: &Placed<'_, '_>, others: &[Other<'_>]) -> Vec<Mark> {
    let (trial, segment) = placed;
    let time_s = trial.seconds(segment.decision.input_step.sample);
    let accepted = |step: &StepResult| step.delay_s.filter(|_| step.verdict == Verdict::Accepted);
    let mark = |(_, pair): (&str, &StepPair)| Mark {
        time_s,
        rank: segment.difference as f64,
        here: accepted(&pair.here),
        there: accepted(&pair.there),
        difference: if pair.differs() { pair.difference_s().unwrap_or(0.0) } else { 0.0 },
        other_verdict: pair.here.is_accepted() != pair.there.is_accepted(),
    };
    pairs(placed, others).map(mark).collect()
}

fn cross(Vec2D([x, y]): Vec2D) -> [Vec<Vec2D>; 2] {
    let line = |dy: f32| vec![Vec2D::new(x - 4.0, y - dy), Vec2D::new(x + 4.0, y + dy)];
    [line(4.0), line(-4.0)]
}
