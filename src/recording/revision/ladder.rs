//! The ladder of errors: a rung per revision, down to the noise.

use rerun::Color;
use rerun::datatypes::Vec2D;

use super::bars::{Bars, Columns};
use super::figure::noise;
use crate::figure::ladder::{self, Rung};
use crate::recording::canvas::{Labels, Strips};
use crate::recording::error::RecordError;
use crate::recording::error_share::{HATCH, short};
use crate::recording::palette::{self, color};
use crate::recording::paths::revision::sheet;
use crate::recording::rows::Rows;
use crate::report::{ImprovedJoint, change_in_words};

const COLUMNS: Columns = Columns { left: 0.0, names: (300.0, 370.0), right: 630.0 };

/// Adds the ladder, the revision at hand being bright.
pub(super) fn add(rows: &mut Rows<'_>, improved: &ImprovedJoint<'_>) -> Result<(), RecordError> {
    let ladder = Ladder::of(improved);
    let count = improved.revisions.len();
    rows.colored(sheet::LADDER, HATCH, (0..count).map(|at| ladder.bars(at)))?;
    let marks = ladder.training();
    rows.strips(sheet::TRAINING, palette::BORDER, 1.6, (0..count).map(|_| marks.clone()))
}

/// The rungs and where they lie.
struct Ladder<'r> {
    rungs: Vec<Rung<'r>>,
    bars: Bars,
}

impl<'r> Ladder<'r> {
    fn of(improved: &'r ImprovedJoint<'_>) -> Self {
        let rungs = ladder::rungs(improved.revisions);
        let names = improved.revisions.iter().map(|step| change_in_words(step).chars().count());
        // Behind its number.
        let longest = 3 + names.max().unwrap_or(0);
        let bars = Bars::new(COLUMNS, (rungs.len(), longest), ladder::largest(&rungs));
        Self { rungs, bars }
    }

    fn bars(&self, at: usize) -> Vec<(Vec<Vec2D>, Color)> {
        let bar = |(row, rung): (usize, &Rung<'_>)| {
            let rgb = palette::model(row);
            let shade = if row == at { rgb } else { palette::dimmed(rgb) };
            self.bars.bar(row, rung.error, color(shade))
        };
        self.rungs.iter().enumerate().flat_map(bar).collect()
    }

    /// A mark at the training error of each revision.
    fn training(&self) -> Strips {
        let rungs = self.rungs.iter().enumerate();
        rungs
            .filter_map(|(row, rung)| {
                Some(self.bars.mark(row, rung.revision.comparison.training?.rmse))
            })
            .collect()
    }
}

/// The line of the noise and all texts of the ladder, the revision at hand being named.
pub(super) fn around(
    improved: &ImprovedJoint<'_>,
    at: usize,
    labels: &mut Labels,
    floor: &mut Labels,
) -> Strips {
    let Ladder { rungs, bars } = Ladder::of(improved);
    let unit = improved.finding.compared.joint.output_unit.as_deref().unwrap_or("");
    let title = "error of each revision: validation (bar), training (white)";
    bars.title(labels, title);
    for (row, ((revision, step), rung)) in improved.numbered().zip(&rungs).enumerate() {
        let here = if row == at { "▶ " } else { "" };
        bars.name(labels, row, &format!("{here}{revision}: {}", change_in_words(step)));
        let training = step.comparison.training.map_or(0.0, |error| error.rmse);
        let end = training.max(rung.error);
        bars.value(labels, row, end, format!("{} {unit}", short(rung.error)));
    }
    let Some(noise) = noise(improved) else { return Vec::new() };
    bars.below(floor, noise, format!("noise {} {unit}", short(noise)));
    vec![bars.line(noise)]
}
