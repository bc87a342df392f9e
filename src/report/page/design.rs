//! The next experiment as a page: what is to be played, and what is expected of it.

use super::compose::files;
use super::document::{Block, Document, Figure, WIDTH, slug};
use crate::design::Prediction;
use crate::experiment::Source;
use crate::figure::{Axis, Mark, Panel, Place, Role, Shape, Span, thinned_places};
use crate::report::TextTable;
use crate::report::design::{DesignedJoint, Held, holds};
use crate::report::design_words::{design_sentences, side_table};
use crate::wording::{bracketed, measure, number};

/// Points of a line: two for each column that is seen.
const POINTS: usize = 1500;

/// The inputs of `joints`, which are known from `sources`, with what is expected of them.
pub(crate) fn design_document(joints: &[DesignedJoint], sources: &[Source]) -> Document {
    let mut blocks: Vec<Block> = joints.iter().flat_map(of_joint).collect();
    blocks.push(Block::section("How this was made", "how-this-was-made"));
    blocks.push(Block::text(format!("Made by tauscope {}.", env!("CARGO_PKG_VERSION"))));
    if !sources.is_empty() {
        blocks.push(Block::Table(files(sources)));
    }
    Document { title: "The next experiment".to_owned(), blocks }
}

fn of_joint(joint: &DesignedJoint) -> Vec<Block> {
    let name = &joint.rig.name;
    let mut sentences = design_sentences(joint).into_iter();
    let mut blocks = vec![Block::section(name, &slug(name))];
    blocks.extend(sentences.next().map(Block::Lead));
    blocks.extend(joint.discrimination.as_ref().map(|found| Block::Table(side_table(found))));
    blocks.push(Block::List(sentences.collect()));
    blocks.push(Block::Figures(vec![figure(joint)]));
    blocks.push(Block::details("All levels", vec![Block::Table(hold_table(joint))]));
    blocks
}

/// Input, and expected outputs with their margin.
fn figure(joint: &DesignedJoint) -> Figure {
    let x = Axis::new(Span::new(0.0, joint.schedule.duration_s()), "time [s]", 10.0);
    let mut panels = vec![input(joint, &x)];
    panels.extend((!joint.expected().is_empty()).then(|| output(joint, &x)));
    let last = panels.len() - 1;
    panels.iter_mut().take(last).for_each(|panel| panel.x = x.bare());
    Figure {
        file: format!("{}-design", slug(&joint.rig.name)),
        name: format!("The input of {}, and what is expected of it", joint.rig.name),
        width: WIDTH,
        panels,
        caption: "The input and the expected output; thin lines are two standard deviations of \
                  the prediction away from it."
            .to_owned(),
    }
}

fn input(joint: &DesignedJoint, x: &Axis) -> Panel {
    let mut end_s = 0.0;
    let mut corners = Vec::new();
    for hold in joint.schedule.holds() {
        let start_s = end_s;
        end_s += hold.samples as f64 * joint.schedule.period().seconds();
        corners.extend([(start_s, hold.level), (end_s, hold.level)]);
    }
    let y = Span::around(joint.schedule.levels().into_iter(), 0.06);
    let y = Axis::new(y, bracketed("input", joint.rig.input_unit.as_deref()), 3.0);
    let marks = vec![Mark::lines(Role::Input, 1.4, vec![corners])];
    Panel { x: x.clone(), y, height: 90, marks }
}

/// A line of values sample by sample.
fn line(joint: &DesignedJoint, values: impl Iterator<Item = f64>) -> Vec<Place> {
    let period_s = joint.schedule.period().seconds();
    let places: Vec<Place> =
        values.zip(0_u32..).map(|(y, k)| (f64::from(k) * period_s, y)).collect();
    thinned_places(&places, POINTS)
}

fn output(joint: &DesignedJoint, x: &Axis) -> Panel {
    let mut marks = Vec::new();
    for (place, (name, Prediction { output, margin })) in joint.expected().into_iter().enumerate() {
        let role = Role::of_revision(place);
        let edge = |sign: f64| line(joint, output.iter().zip(margin).map(|(y, m)| y + sign * m));
        marks.push(Mark::lines(role, 0.5, vec![edge(-1.0), edge(1.0)]));
        let expected = Shape::Lines(vec![line(joint, output.iter().copied())], 1.6);
        marks.push(Mark::new(role, expected).named(name));
    }
    let extents = joint.expected().into_iter().map(|(_, prediction)| prediction.extent());
    let own = Span::around(extents.flat_map(|(low, high)| [low, high]), 0.06);
    // A limit that is far off would flatten the curves.
    let limits = joint.rig.range.into_iter().flat_map(|(low, high)| [low, high]);
    let limits: Vec<f64> = limits.filter(|limit| (-1.0..2.0).contains(&own.part(*limit))).collect();
    let y = Span::around([own.low, own.high].into_iter().chain(limits.iter().copied()), 0.0);
    let range = limits.iter().map(|limit| vec![(x.span.low, *limit), (x.span.high, *limit)]);
    marks.push(Mark::lines(Role::Rejected, 1.0, range.collect()).named("range"));
    let y = Axis::new(y, bracketed("output", joint.rig.output_unit.as_deref()), 5.0);
    Panel { x: x.clone(), y, height: 190, marks }
}

/// A row per level: when and how long.
fn hold_table(joint: &DesignedJoint) -> TextTable {
    let unit = joint.rig.input_unit.as_deref();
    let row = |hold: Held| {
        let (start, hold_s) = (number(hold.start_s), number(hold.hold_s));
        [hold.trial.to_string(), start, measure(hold.level, unit), hold_s]
    };
    let rows = holds(&joint.schedule).into_iter().map(row);
    TextTable::of(["trial", "from [s]", "level", "held [s]"], &[0, 1, 2, 3], rows)
}
