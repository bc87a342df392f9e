//! The ladder of errors: a rung per revision, down to the noise.

use rerun::Color;
use rerun::datatypes::Vec2D;

use super::bars::{Bars, Columns};
use super::figure::noise;
use crate::explain::{Change, Revision};
use crate::recording::canvas::{Labels, Strips};
use crate::recording::error::RecordError;
use crate::recording::error_share::{HATCH, short};
use crate::recording::layers::Layers;
use crate::recording::palette::{self, color};
use crate::recording::rungs::{self, Rung};
use crate::report::{ImprovedJoint, change_in_words};

const COLUMNS: Columns = Columns { left: 0.0, names: (300.0, 370.0), right: 630.0 };

/// Adds the ladder, the revision at hand being bright.
pub(super) fn add(rows: &mut Layers<'_>, improved: &ImprovedJoint<'_>) -> Result<(), RecordError> {
    let ladder = Ladder::of(improved);
    let count = improved.revisions.len();
    rows.colored("ladder", HATCH, (0..count).map(|at| ladder.bars(at)))?;
    let marks = ladder.training();
    rows.strips("training", palette::BORDER, 1.6, (0..count).map(|_| marks.clone()))
}

/// Lines of names that there is room for, one below another.
const MOST_LINES: usize = 14;

/// The rungs and where they lie.
struct Ladder<'r> {
    rungs: Vec<Rung<'r>>,
    bars: Bars,
    /// The row of each rung: what left the model has a row of its own below what came.
    rows: Vec<usize>,
}

impl<'r> Ladder<'r> {
    fn of(improved: &'r ImprovedJoint<'_>) -> Self {
        let rungs = rungs::rungs(improved.revisions);
        let names: Vec<Vec<String>> = improved.revisions.iter().map(lines).collect();
        let apart = names.iter().map(Vec::len).sum::<usize>() <= MOST_LINES;
        let mut next = 0;
        let row = |lines: &Vec<String>| {
            let row = next;
            next += if apart { lines.len() } else { 1 };
            row
        };
        let rows: Vec<usize> = names.iter().map(row).collect();
        // Behind its number.
        let longest =
            3 + names.iter().flatten().map(|line| line.chars().count()).max().unwrap_or(0);
        let bars = Bars::new(COLUMNS, (next, longest), rungs::largest(&rungs));
        Self { rungs, bars, rows }
    }

    /// Each rung with its row.
    fn placed(&self) -> impl Iterator<Item = (usize, &Rung<'r>)> {
        self.rows.iter().copied().zip(&self.rungs)
    }

    fn bars(&self, at: usize) -> Vec<(Vec<Vec2D>, Color)> {
        let bar = |(place, (row, rung)): (usize, (usize, &Rung<'_>))| {
            let rgb = palette::model(place);
            let shade = if place == at { rgb } else { palette::dimmed(rgb) };
            self.bars.bar(row, rung.error, color(shade))
        };
        self.placed().enumerate().flat_map(bar).collect()
    }

    /// The name of the rung at `place` behind its `number`, what left the model below what came.
    fn name(&self, labels: &mut Labels, (place, row): (usize, usize), number: &str) {
        let Some(Rung { revision, .. }) = self.rungs.get(place) else { return };
        let next = self.rows.get(place + 1).copied().unwrap_or(self.bars.rows());
        match lines(revision).as_slice() {
            [came, gone] if next > row + 1 => {
                self.bars.name(labels, row, &format!("{number}: {came}"));
                self.bars.name(labels, row + 1, gone);
                self.bars.value(labels, row + 1, 0.0, "taken out".to_owned());
            }
            _ => self.bars.name(labels, row, &format!("{number}: {}", change_in_words(revision))),
        }
    }

    /// A mark at the training error of each revision.
    fn training(&self) -> Strips {
        let mark = |(row, rung): (usize, &Rung<'_>)| {
            Some(self.bars.mark(row, rung.revision.comparison.training?.rmse))
        };
        self.placed().filter_map(mark).collect()
    }
}

/// The change of a revision, what left the model on a line of its own.
fn lines(revision: &Revision) -> Vec<String> {
    match revision.change {
        Change::Replaced { old, new } => vec![format!("+ {new}"), format!("− {old}")],
        _ => vec![change_in_words(revision)],
    }
}

/// The line of the noise and all texts of the ladder, the revision at hand being named.
pub(super) fn around(
    improved: &ImprovedJoint<'_>,
    at: usize,
    labels: &mut Labels,
    floor: &mut Labels,
) -> Strips {
    let ladder = Ladder::of(improved);
    let bars = &ladder.bars;
    let unit = improved.finding.compared.joint.output_unit.as_deref().unwrap_or("");
    let title = "error of each revision: validation (bar), training (white)";
    bars.title(labels, title);
    let revisions = improved.numbered().zip(ladder.placed());
    for (place, ((revision, step), (row, rung))) in revisions.enumerate() {
        let here = if place == at { "▶ " } else { "" };
        ladder.name(labels, (place, row), &format!("{here}{revision}"));
        let training = step.comparison.training.map_or(0.0, |error| error.rmse);
        let end = training.max(rung.error);
        bars.value(labels, row, end, format!("{} {unit}", short(rung.error)));
    }
    let Some(noise) = noise(improved) else { return Vec::new() };
    bars.below(floor, noise, format!("noise {} {unit}", short(noise)));
    vec![bars.line(noise)]
}
