//! The candidates for what comes next, the best one first, down to the noise.

use rerun::Color;
use rerun::datatypes::Vec2D;

use super::bars::Bars;
use super::figure::noise;
use crate::explain::{Candidate, Revision};
use crate::figure::ladder::judged;
use crate::recording::canvas::{Labels, Strips};
use crate::recording::error::RecordError;
use crate::recording::error_share::{HATCH, short};
use crate::recording::palette::{self, color};
use crate::recording::paths::revision::sheet;
use crate::recording::rows::Rows;
use crate::report::ImprovedJoint;

/// Left end, end of the names, and right end on the sheet.
const COLUMNS: (f32, f32, f32) = (1270.0, 1570.0, 1890.0);

/// Adds the bars of all revisions: the model as it is, then each candidate.
pub(super) fn add(rows: &mut Rows<'_>, improved: &ImprovedJoint<'_>) -> Result<(), RecordError> {
    let of_each = improved.revisions.iter().enumerate().map(|(at, revision)| {
        let proposed = improved.proposed(at).map(|candidate| &candidate.effects);
        let candidates = revision.ranking.iter().map(|candidate| {
            let taken = proposed == Some(&candidate.effects);
            (candidate.rmse(), if taken { palette::PROPOSED } else { palette::RAW })
        });
        let own = std::iter::once((judged(&revision.comparison), palette::REVISION));
        let bars = bars_of(revision);
        let bar = |(row, (error, rgb))| bars.bar(row, error, color(rgb));
        let all: Vec<(Vec<Vec2D>, Color)> =
            own.chain(candidates).enumerate().flat_map(bar).collect();
        all
    });
    rows.colored(sheet::RANKING, HATCH, of_each.collect::<Vec<_>>().into_iter())
}

/// The line of the noise and the texts of the ranking at a revision.
pub(super) fn around(
    improved: &ImprovedJoint<'_>,
    at: usize,
    labels: &mut Labels,
    floor: &mut Labels,
) -> Strips {
    let Some(((number, revision), bars)) =
        improved.numbered().nth(at).map(|numbered| (numbered, bars_of(numbered.1)))
    else {
        return Vec::new();
    };
    let unit = improved.finding.compared.joint.output_unit.as_deref().unwrap_or("");
    let title = match revision.ranking.as_slice() {
        [] => "no effect was looked for at this revision",
        _ => "error with one effect more",
    };
    bars.title(labels, title);
    let own = (format!("revision {number}"), judged(&revision.comparison));
    let candidates = revision.ranking.iter().map(|c| (format!("+ {}", c.name()), c.rmse()));
    for (row, (name, error)) in std::iter::once(own).chain(candidates).enumerate() {
        bars.name(labels, row, &name);
        bars.value(labels, row, error, format!("{} {unit}", short(error)));
    }
    let Some(noise) = noise(improved) else { return Vec::new() };
    bars.below(floor, noise, format!("noise {} {unit}", short(noise)));
    vec![bars.line(noise)]
}

fn bars_of(revision: &Revision) -> Bars {
    let errors = revision.ranking.iter().map(Candidate::rmse);
    let most = errors.fold(judged(&revision.comparison), f64::max);
    Bars::new(COLUMNS, 1 + revision.ranking.len(), most)
}
