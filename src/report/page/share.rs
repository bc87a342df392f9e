//! How a model's error is shared: by the feature that it goes with most.

use super::document::Figure;
use super::layout::HALF;
use super::palette::Role;
use super::plot::{Axis, Mark, Panel, PlotError, Shape, draw};
use crate::diagnosis::failure::{Feature, Region, Units};
use crate::report::ComparedJoint;
use crate::report::span::Span;
use crate::wording::bracketed;
use crate::wording::rounded;

/// Shares of the squared error and of the time in each part of the feature whose parts
/// differ most in them.
pub(super) fn figure(
    compared: &ComparedJoint<'_>,
    file: String,
) -> Result<Option<Figure>, PlotError> {
    let regions = &compared.comparison.regions;
    let by_feature = regions.chunk_by(|a, b| a.feature == b.feature);
    let found = by_feature.max_by(|a, b| unevenness(a).total_cmp(&unevenness(b)));
    let Some((parts, first)) = found.and_then(|parts| Some((parts, parts.first()?))) else {
        return Ok(None);
    };
    let joint = compared.joint;
    let units = Units { input: joint.input_unit.clone(), output: joint.output_unit.clone() };
    let name = bracketed(first.feature.name(), first.feature.unit(&units).as_deref());
    let svg = draw(&[panel(parts)], HALF, &format!("Share of the error of {}", joint.name))?;
    let caption = format!(
        "Where the error is, by {name}: the squared error of the model restarted at every step \
         of the input. A bar beyond its mark is a part with too much of it."
    );
    Ok(Some(Figure { file, svg, caption }))
}

/// How much of the squared error would have to move to be spread as the time is.
fn unevenness(parts: &[Region]) -> f64 {
    parts.iter().map(|part| (part.share_of_squared_error - part.share_of_time).abs()).sum()
}

fn panel(parts: &[Region]) -> Panel {
    let names: Vec<String> = parts.iter().map(label).collect();
    let row = |index: usize| -(index as f64);
    let bar = |(index, part): (usize, &Region)| {
        let share = 100.0 * part.share_of_squared_error;
        ((0.0, row(index) - 0.3), (share, row(index) + 0.3))
    };
    let mark = |(index, part): (usize, &Region)| {
        let share = 100.0 * part.share_of_time;
        vec![(share, row(index) - 0.42), (share, row(index) + 0.42)]
    };
    let shares = parts.iter().flat_map(|part| [part.share_of_squared_error, part.share_of_time]);
    let x = Span::new(0.0, 104.0 * shares.fold(0.01, f64::max));
    let rows = || parts.iter().enumerate();
    Panel {
        x: Axis::new(x, "share [%]", 5.0),
        y: Axis::of_names(&names, ""),
        height: 20 * u32::try_from(parts.len()).unwrap_or(1) + 10,
        marks: vec![
            Mark::new(Role::Error, Shape::Bars(rows().map(bar).collect()))
                .named("of the squared error"),
            Mark::new(Role::Ink, Shape::Lines(rows().map(mark).collect(), 2.0))
                .named("of the time"),
        ],
    }
}

/// `2 to 3`; a level, a sign, or a trial as it is.
fn label(region: &Region) -> String {
    #[expect(clippy::float_cmp, reason = "a level has one value")]
    let is_level = region.from == region.to;
    match region.feature {
        Feature::Direction | Feature::Trial => region.label.clone(),
        _ if is_level => rounded(region.from),
        _ => format!("{} to {}", rounded(region.from), rounded(region.to)),
    }
}
