//! The next experiment as a page: what is to be played, and what is expected of it.

use super::compose::files;
use super::document::{Block, Document, Figure, WIDTH, slug};
use crate::design::{Apart, Prediction, apart};
use crate::experiment::Source;
use crate::figure::{Axis, Mark, Panel, Place, Role, Shape, Span, thinned_places};
use crate::report::TextTable;
use crate::report::design::{DesignedJoint, Held, holds};
use crate::report::design_words::{design_sentences, side_table};
use crate::wording::{bracketed, measure, number, percent};

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
    let difference = difference(joint);
    blocks.push(Block::Figures(vec![figure(joint, difference.as_ref())]));
    let table = hold_table(joint, difference.as_ref());
    blocks.push(Block::details("All levels", vec![Block::Table(table)]));
    blocks
}

/// Where two suspects differ.
fn difference(joint: &DesignedJoint) -> Option<Apart> {
    let noise = joint.discrimination.as_ref()?.noise;
    match joint.expected().as_slice() {
        [(_, one), (_, other)] => Some(apart(&joint.schedule, &one.output, &other.output, noise)),
        _ => None,
    }
}

/// Input, expected outputs with their margin, and their difference over time.
fn figure(joint: &DesignedJoint, difference: Option<&Apart>) -> Figure {
    let x = Axis::new(Span::new(0.0, joint.schedule.duration_s()), "time [s]", 10.0);
    let mut panels = vec![input(joint, &x)];
    panels.extend((!joint.expected().is_empty()).then(|| output(joint, &x)));
    panels.extend(difference.map(|found| over_noise(joint, found, &x)));
    let last = panels.len() - 1;
    panels.iter_mut().take(last).for_each(|panel| panel.x = x.bare());
    Figure {
        file: format!("{}-design", slug(&joint.rig.name)),
        name: format!("The input of {}, and what is expected of it", joint.rig.name),
        width: WIDTH,
        panels,
        caption: "The input and the expected output; thin lines are two standard deviations of \
                  the prediction away from it. The difference of the two effects starts at zero \
                  at each step, as in a fit."
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

fn over_noise(joint: &DesignedJoint, found: &Apart, x: &Axis) -> Panel {
    let y = Span::around(found.over_noise.iter().copied().chain([0.0]), 0.06);
    let difference = Shape::Lines(vec![line(joint, found.over_noise.iter().copied())], 1.2);
    let marks = vec![Mark::new(Role::Error, difference)];
    Panel { x: x.clone(), y: Axis::new(y, "difference [noise]", 4.0), height: 110, marks }
}

/// A row per level: when and how long, and how far the suspects are apart.
fn hold_table(joint: &DesignedJoint, difference: Option<&Apart>) -> TextTable {
    let header = [
        "trial",
        "from [s]",
        "level",
        "held [s]",
        "difference [noise]",
        "of the squared \
         difference",
    ];
    let unit = joint.rig.input_unit.as_deref();
    let row = |(place, hold): (usize, Held)| {
        let own = difference.and_then(|found| found.holds.get(place));
        let cell = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
        [
            hold.trial.to_string(),
            number(hold.start_s),
            measure(hold.level, unit),
            number(hold.hold_s),
            cell(own.map(|own| measure(own.largest, None))),
            cell(own.map(|own| percent(own.share))),
        ]
    };
    let rows = holds(&joint.schedule).into_iter().enumerate().map(row);
    TextTable::of(header, &[0, 1, 2, 3, 4, 5], rows)
}
