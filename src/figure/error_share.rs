//! Where the error arises: its share in each part of a feature, beside the share of the time.

use super::panel::{Axis, Mark, Panel, Place, Role, Shape};
use super::span::Span;
use crate::diagnosis::Comparison;
use crate::diagnosis::failure::{Feature, Region};
use crate::experiment::Joint;
use crate::wording::{feature_with_unit, rounded};

/// The parts of each feature, in the order of `regions`.
pub(crate) fn by_feature(regions: &[Region]) -> impl Iterator<Item = &[Region]> {
    regions.chunk_by(|a, b| a.feature == b.feature)
}

/// The share of the error and of the time in one part, in percent.
fn share(region: &Region) -> [f64; 2] {
    [region.share_that_arises, region.share_of_time].map(|share| 100.0 * share)
}

/// How much of the squared error, in percent, would have to move to be spread as the time is, counted
/// where it leaves and where it arrives.
pub(crate) fn unevenness(parts: &[Region]) -> f64 {
    parts.iter().map(share).map(|[error, time]| (error - time).abs()).sum()
}

/// A panel for each feature, in the order of the regions of the first model.
pub(crate) fn panels(joint: &Joint, models: &[(Role, &Comparison)]) -> Vec<Panel> {
    let first = models.first().into_iter().flat_map(|(_, first)| by_feature(&first.regions));
    first.filter_map(|parts| panel(joint, parts, models)).collect()
}

/// A slot for each of the `parts` of a feature, in it a bar for each of `models`, and across it a line at
/// the share of the time. A model that has another number of parts, as its speeds may, has no bars.
pub(crate) fn panel(
    joint: &Joint,
    parts: &[Region],
    models: &[(Role, &Comparison)],
) -> Option<Panel> {
    /// Part of a slot that its bars fill.
    const FILLED: f64 = 0.7;
    let feature = parts.first()?.feature;
    let of_model = |(role, comparison): &(Role, &Comparison)| {
        let own = by_feature(&comparison.regions)
            .find(|own| own.first().is_some_and(|one| one.feature == feature));
        let own = own.filter(|own| own.len() == parts.len()).unwrap_or_default();
        (*role, own.iter().map(|region| share(region)[0]).collect::<Vec<f64>>())
    };
    let of_models: Vec<(Role, Vec<f64>)> = models.iter().map(of_model).collect();
    let width = FILLED / of_models.len().max(1) as f64;
    let bars = |(number, (role, errors)): (u32, &(Role, Vec<f64>))| {
        let left = (1.0 - FILLED) / 2.0 + width * f64::from(number);
        let bar = |(slot, error): (u32, &f64)| {
            let left = f64::from(slot) + left;
            ((left, 0.0), (left + width, *error))
        };
        let bars: Vec<(Place, Place)> = (0..).zip(errors).map(bar).collect();
        Mark::new(*role, Shape::Bars(bars)).named("squared error")
    };
    let across = |(slot, region): (u32, &Region)| {
        [0.04, 0.96].map(|x| (f64::from(slot) + x, share(region)[1])).to_vec()
    };
    let heights = of_models.iter().flat_map(|(_, errors)| errors).copied();
    let largest = heights.chain(parts.iter().flat_map(share)).fold(0.0, f64::max);
    let slots = Span::new(0.0, parts.len() as f64);
    let x =
        Axis { ticks: names(parts), ..Axis::new(slots, feature_with_unit(feature, joint), 1.0) };
    let mut marks: Vec<Mark> = (0..).zip(&of_models).map(bars).collect();
    let time = (0..).zip(parts).map(across).collect();
    marks.push(Mark::lines(Role::Ink, 1.6, time).named("time"));
    let y = Axis::new(Span::new(0.0, 1.08 * largest.max(1.0)), "share [%]", 4.0);
    Some(Panel { x, y, height: 190, marks })
}

/// The name of each slot, or of each border between two, and where it stands.
fn names(regions: &[Region]) -> Vec<(f64, String)> {
    if regions.iter().all(is_level) {
        let named = |(region, slot): (&Region, u32)| (f64::from(slot) + 0.5, name(region));
        return regions.iter().zip(0..).map(named).collect();
    }
    let first = regions.first().map(|region| (0.0, rounded(region.from)));
    let ends = regions.iter().zip(1..).map(|(r, slot): (_, u32)| (f64::from(slot), rounded(r.to)));
    first.into_iter().chain(ends).collect()
}

/// What a part is that has no extent.
fn name(region: &Region) -> String {
    /// Characters of a trial's label that have room.
    const LONGEST: usize = 10;
    match region.feature {
        Feature::Trial if region.label.chars().count() > LONGEST => {
            region.label.chars().take(LONGEST - 1).chain(['…']).collect()
        }
        Feature::Direction | Feature::Trial => region.label.clone(),
        _ => rounded(region.from),
    }
}

/// Whether a part is one level of its feature, not a range.
fn is_level(region: &Region) -> bool {
    #[expect(clippy::float_cmp, reason = "a level is both of its bounds")]
    let is_level = region.from == region.to;
    is_level
}

#[cfg(test)]
mod tests {
    use super::*;

    fn region(feature: Feature, label: &str, from: f64, to: f64) -> Region {
        let label = label.to_owned();
        let (share_of_time, share_of_squared_error, rmse, mean_residual) = (0.5, 0.5, 1.0, 0.0);
        Region {
            feature,
            label,
            from,
            to,
            share_of_time,
            share_of_squared_error,
            share_that_arises: share_of_squared_error,
            rmse,
            mean_residual,
        }
    }

    #[test]
    fn levels_are_named_in_their_middle_and_ranges_at_their_ends() {
        let levels = [-1.5, 2.0].map(|level| region(Feature::Input, "", level, level));
        let named = names(&levels);
        assert_eq!(named, [(0.5, "-1.5".to_owned()), (1.5, "2".to_owned())]);
        let ranges = [(0.0, 0.123_456), (0.123_456, 7.0)];
        let ranges = ranges.map(|(from, to)| region(Feature::Hold, "", from, to));
        let named = names(&ranges);
        let expected = [(0.0, "0"), (1.0, "0.123"), (2.0, "7")];
        assert_eq!(named, expected.map(|(x, name)| (x, name.to_owned())));
    }

    #[test]
    fn a_long_label_is_cut_where_it_can_be_seen() {
        assert_eq!(name(&region(Feature::Trial, "monday/morning", 0.0, 0.0)), "monday/mo…");
        assert_eq!(name(&region(Feature::Direction, "positive", 1.0, 1.0)), "positive");
    }
}
