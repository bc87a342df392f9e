//! The errors of revisions of a model, or of candidates, as bars one below another, down to the noise.

use super::panel::{Axis, Mark, Panel, Role, Shape};
use super::span::Span;
use crate::wording::measure;

/// A revision or a candidate.
#[derive(Clone, Debug)]
pub(crate) struct Rung {
    pub(crate) name: String,
    /// On data that were not fitted, where there are any; none where its simulation diverges.
    pub(crate) error: Option<f64>,
    pub(crate) training: Option<f64>,
    pub(crate) role: Role,
}

/// What stands beside the bar of a rung.
pub(crate) fn value(rung: &Rung, unit: Option<&str>) -> String {
    rung.error.map_or_else(|| "diverges".to_owned(), |error| measure(error, unit))
}

/// A row for each rung, and the `noise` of the sensor as a line; beyond the longest bar there is so much
/// `room` for its value, in its own length. Programs find the bars by `part`.
pub(crate) fn panel(
    (name, part): (String, &'static str),
    rungs: &[Rung],
    (noise, unit): (Option<f64>, Option<&str>),
    room: f64,
) -> Panel {
    let numbered = || (0..).map(|row: u32| -f64::from(row)).zip(rungs);
    let bar = |(row, rung): (f64, &Rung)| {
        let bar = rung.error.map(|error| ((0.0, row - 0.3), (error, row + 0.3)));
        Mark::new(rung.role, Shape::Bars(bar.into_iter().collect())).part(part)
    };
    let mut marks: Vec<Mark> = numbered().map(bar).collect();
    let training = numbered().filter_map(|(row, rung)| {
        let error = rung.training?;
        Some(vec![(error, row - 0.38), (error, row + 0.38)])
    });
    let training: Vec<_> = training.collect();
    if !training.is_empty() {
        marks.push(Mark::lines(Role::Ink, 1.6, training).named("training"));
    }
    let word = |(row, rung): (f64, &Rung)| {
        let end = rung.error.unwrap_or(0.0).max(rung.training.unwrap_or(0.0));
        ((end, row), value(rung, unit))
    };
    marks.push(Mark::new(Role::Ink, Shape::Words(numbered().map(word).collect())));
    marks.extend(noise.map(|noise| {
        let name = format!("noise {}", measure(noise, unit));
        Mark::new(Role::Noise, Shape::Verticals(vec![noise], 1.2)).named(name).part("noise")
    }));
    let ends = rungs.iter().flat_map(|rung| [rung.error, rung.training]).flatten().chain(noise);
    let span = Span::new(0.0, room * ends.fold(f64::MIN_POSITIVE, f64::max));
    let names: Vec<String> = rungs.iter().map(|rung| rung.name.clone()).collect();
    let height = 24 * u32::try_from(names.len()).unwrap_or(1) + 10;
    Panel { x: Axis::new(span, name, 6.0), y: Axis::of_names(&names, ""), height, marks }
}
