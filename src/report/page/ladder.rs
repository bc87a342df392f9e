//! The ladder of errors: how the error falls from revision to revision.

use super::document::{Figure, Table};
use super::layout::WIDTH;
use super::palette::Role;
use super::plot::{Axis, Mark, Panel, PlotError, Shape, draw};
use crate::explain::Revision;
use crate::report::compare::figures;
use crate::report::span::Span;
use crate::report::{ImprovedJoint, change_in_words};
use crate::wording::bracketed;
use crate::wording::number;

/// A bar for the error of each revision, and the noise as a line.
pub(super) fn figure(improved: &ImprovedJoint<'_>, file: String) -> Result<Figure, PlotError> {
    let joint = improved.finding.compared.joint;
    let names: Vec<String> = improved
        .numbered()
        .map(|(number, revision)| format!("{number}: {}", change_in_words(revision)))
        .collect();
    let errors: Vec<f64> = improved.revisions.iter().map(error).collect();
    let bar =
        |(row, error): (u32, &f64)| ((0.0, -f64::from(row) - 0.3), (*error, 0.3 - f64::from(row)));
    let words = |(row, error): (u32, &f64)| ((*error, -f64::from(row)), number(*error));
    let largest = errors.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let noise = improved.finding.compared.comparison.noise_floor;
    let rows = || (0..).zip(&errors);
    let mut marks = vec![
        Mark::new(Role::Model, Shape::Bars(rows().map(bar).collect())).named(judged_on(improved)),
        Mark::new(Role::Ink, Shape::Words(rows().map(words).collect())),
    ];
    marks.extend(noise.map(|noise| {
        Mark::new(Role::Noise, Shape::Verticals(vec![noise], 1.2)).named("noise of the measurement")
    }));
    let name = bracketed("root-mean-square error", joint.output_unit.as_deref());
    let panel = Panel {
        x: Axis::new(Span::new(0.0, 1.15 * largest.max(noise.unwrap_or(0.0))), name, 6.0),
        y: Axis::of_names(&names, ""),
        height: 24 * u32::try_from(names.len()).unwrap_or(1) + 10,
        marks,
    };
    let svg = draw(&[panel], WIDTH, &format!("Errors of the revisions of {}", joint.name))?;
    let caption = "How the error falls from revision to revision.".to_owned();
    Ok(Figure { file, svg, caption })
}

/// A row per revision.
pub(super) fn table(improved: &ImprovedJoint<'_>) -> Table {
    let header = ["revision", "change", "training", "validation", "fit", "noise", "lack of fit"];
    let mut table = Table::new(header, &[0, 2, 3, 4, 5]);
    for (number, revision) in improved.numbered() {
        let [training, validation, fit, noise, lack] =
            figures(improved.finding.compared.joint, &revision.comparison);
        let change = change_in_words(revision);
        table.row([number.to_string(), change, training, validation, fit, noise, lack]);
    }
    table
}

/// The error by which a revision is judged.
fn error(revision: &Revision) -> f64 {
    let comparison = &revision.comparison;
    let judged = comparison.validation.or(comparison.training);
    judged.map_or(0.0, |error| error.rmse).max(0.0)
}

fn judged_on(improved: &ImprovedJoint<'_>) -> &'static str {
    let validated = improved.revisions.iter().all(|one| one.comparison.validation.is_some());
    if validated { "error on data that were not fitted" } else { "error" }
}
