//! How a model's error is shared: by the feature that it goes with most.

use super::document::Figure;
use super::layout::HALF;
use super::plot::{PlotError, draw};
use crate::diagnosis::failure::{Feature, Region, Units};
use crate::figure::Role;
use crate::figure::Span;
use crate::figure::error_share::{FeatureShares, Share, is_level};
use crate::figure::{Axis, Mark, Panel, Shape};
use crate::report::ComparedJoint;
use crate::wording::bracketed;
use crate::wording::rounded;

/// Shares of the squared error and of the time in each part of the feature whose parts
/// differ most in them.
pub(super) fn figure(
    compared: &ComparedJoint<'_>,
    file: String,
) -> Result<Option<Figure>, PlotError> {
    let features = FeatureShares::all(&compared.comparison.regions);
    let found = features.max_by(|a, b| a.unevenness().total_cmp(&b.unevenness()));
    let Some((shares, feature)) = found.and_then(|found| Some((found, found.feature()?))) else {
        return Ok(None);
    };
    let joint = compared.joint;
    let units = Units { input: joint.input_unit.clone(), output: joint.output_unit.clone() };
    let name = bracketed(feature.name(), feature.unit(&units).as_deref());
    let svg = draw(&[panel(shares)], HALF, &format!("Share of the error of {}", joint.name))?;
    let caption = format!(
        "Where the error arises, by {name}: the squared error of the speed, {}. A bar beyond its mark is \
         a part with too much of it.",
        compared.comparison.arising
    );
    Ok(Some(Figure { file, svg, caption }))
}

fn panel(shares: FeatureShares<'_>) -> Panel {
    let names: Vec<String> = shares.regions.iter().map(label).collect();
    let row = |index: usize| -(index as f64);
    let bar =
        |(index, share): (usize, Share)| ((0.0, row(index) - 0.3), (share.error, row(index) + 0.3));
    let mark = |(index, share): (usize, Share)| {
        vec![(share.time, row(index) - 0.42), (share.time, row(index) + 0.42)]
    };
    let x = Span::new(0.0, 1.04 * shares.largest().max(1.0));
    let rows = || shares.shares().enumerate();
    Panel {
        x: Axis::new(x, "share [%]", 5.0),
        y: Axis::of_names(&names, ""),
        height: 20 * u32::try_from(names.len()).unwrap_or(1) + 10,
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
    match region.feature {
        Feature::Direction | Feature::Trial => region.label.clone(),
        _ if is_level(region) => rounded(region.from),
        _ => format!("{} to {}", rounded(region.from), rounded(region.to)),
    }
}
