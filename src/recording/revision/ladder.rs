//! The ladder of errors: a rung per revision, down to the noise.

use rerun::Color;
use rerun::datatypes::Vec2D;

use super::bars::Bars;
use crate::diagnosis::Comparison;
use crate::figure::ladder::judged;
use crate::recording::canvas::{Labels, Strips};
use crate::recording::error::RecordError;
use crate::recording::error_share::{HATCH, short};
use crate::recording::palette::{self, color};
use crate::recording::paths::revision::sheet;
use crate::recording::rows::Rows;
use crate::report::{ImprovedJoint, change_in_words};

/// Left end, end of the names, and right end on the sheet.
const COLUMNS: (f32, f32, f32) = (0.0, 300.0, 630.0);

/// Adds the ladder, the revision at hand being bright.
pub(super) fn add(rows: &mut Rows<'_>, improved: &ImprovedJoint<'_>) -> Result<(), RecordError> {
    let ladder = Ladder::of(improved);
    let count = improved.revisions.len();
    rows.colored(sheet::LADDER, HATCH, (0..count).map(|at| ladder.bars(at)))?;
    let marks = ladder.training();
    rows.strips(sheet::TRAINING, palette::BORDER, 1.6, (0..count).map(|_| marks.clone()))
}

/// The rungs and where they lie.
struct Ladder<'a> {
    improved: &'a ImprovedJoint<'a>,
    bars: Bars,
}

impl<'a> Ladder<'a> {
    fn of(improved: &'a ImprovedJoint<'a>) -> Self {
        let most = comparisons(improved).map(judged).fold(0.0, f64::max);
        Self { improved, bars: Bars::new(COLUMNS, improved.revisions.len(), most) }
    }

    fn bars(&self, at: usize) -> Vec<(Vec<Vec2D>, Color)> {
        let rungs = comparisons(self.improved).enumerate();
        let bar = |(row, comparison)| {
            let rgb = palette::REVISION;
            let shade = if row == at { rgb } else { palette::dimmed(rgb) };
            self.bars.bar(row, judged(comparison), color(shade))
        };
        rungs.flat_map(bar).collect()
    }

    /// A mark at the training error of each revision.
    fn training(&self) -> Strips {
        let rungs = comparisons(self.improved).enumerate();
        let marks = rungs.filter_map(|(row, c)| Some(self.bars.mark(row, c.training?.rmse)));
        marks.collect()
    }
}

/// The line of the noise and all texts of the ladder, the revision at hand being named.
pub(super) fn around(
    improved: &ImprovedJoint<'_>,
    at: usize,
    labels: &mut Labels,
    floor: &mut Labels,
) -> Strips {
    let Ladder { bars, .. } = Ladder::of(improved);
    let unit = improved.finding.compared.joint.output_unit.as_deref().unwrap_or("");
    let title = "error of each revision: validation (bar), training (white)";
    bars.title(labels, title);
    for (row, (revision, step)) in improved.numbered().enumerate() {
        let here = if row == at { "▶ " } else { "" };
        bars.name(labels, row, &format!("{here}{revision}: {}", change_in_words(step)));
        let comparison = &step.comparison;
        let end = comparison.training.map_or(0.0, |error| error.rmse).max(judged(comparison));
        bars.value(labels, row, end, format!("{} {unit}", short(judged(comparison))));
    }
    let noise = improved.revisions.get(at).and_then(|step| step.comparison.noise_floor);
    let Some(noise) = noise else { return Vec::new() };
    bars.below(floor, noise, format!("noise {} {unit}", short(noise)));
    vec![bars.line(noise)]
}

fn comparisons<'a>(improved: &ImprovedJoint<'a>) -> impl Iterator<Item = &'a Comparison> {
    improved.revisions.iter().map(|revision| &revision.comparison)
}
