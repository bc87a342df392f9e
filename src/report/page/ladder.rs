//! The ladder of errors: how the error falls from revision to revision.

use super::document::Figure;
use super::layout::WIDTH;
use super::plot::{PlotError, draw};
use crate::diagnosis::sensor_noise;
use crate::figure::Role;
use crate::figure::Span;
use crate::figure::{Axis, Mark, Panel, Shape};
use crate::report::ImprovedJoint;
use crate::report::ladder::LadderRow;
use crate::units::floor_to_index;
use crate::wording::{bracketed, number};

/// A bar for the error of each revision, and the noise as a line.
pub(super) fn figure(improved: &ImprovedJoint<'_>, file: String) -> Result<Figure, PlotError> {
    let joint = improved.finding.compared.joint;
    let ladder = improved.ladder();
    let name = |row: &LadderRow| format!("{}: {}", row.number, row.change);
    let names: Vec<String> = ladder.iter().map(name).collect();
    let errors: Vec<f64> = ladder.iter().map(|row| row.errors.judged().unwrap_or(0.0)).collect();
    let bar =
        |(row, error): (u32, &f64)| ((0.0, -f64::from(row) - 0.3), (*error, 0.3 - f64::from(row)));
    let words = |(row, error): (u32, &f64)| ((*error, -f64::from(row)), number(*error));
    let largest = errors.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let noise = sensor_noise(&joint.trials);
    let rows = || (0..).zip(&errors);
    // A revision has its colour in all figures, and in the recording.
    let bars = rows().map(|(row, error)| {
        let role = Role::of_revision(floor_to_index(f64::from(row)));
        Mark::new(role, Shape::Bars(vec![bar((row, error))]))
    });
    let mut marks: Vec<Mark> = bars.collect();
    if let Some(first) = marks.first_mut() {
        first.name = Some(judged_on(&ladder).to_owned());
    }
    marks.push(Mark::new(Role::Ink, Shape::Words(rows().map(words).collect())));
    marks.extend(noise.map(|noise| {
        Mark::new(Role::Noise, Shape::Verticals(vec![noise], 1.2)).named("noise of the sensor")
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

fn judged_on(ladder: &[LadderRow]) -> &'static str {
    let validated = ladder.iter().all(|row| row.errors.validation_rmse.is_some());
    if validated { "error on data that were not fitted" } else { "error" }
}
