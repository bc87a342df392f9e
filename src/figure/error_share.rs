//! Where the error arises: its share in each part of a feature, beside the share of the time.

use super::panel::{Axis, Mark, Panel, Place, Shape};
use super::role::Role;
use super::span::Span;
use crate::diagnosis::Comparison;
use crate::diagnosis::failure::{Feature, Region};
use crate::experiment::Joint;
use crate::wording::{feature_with_unit, rounded};

/// All parts of one feature.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FeatureShares<'r> {
    pub(crate) regions: &'r [Region],
}

/// The share of the error and of the time in one part, in percent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Share {
    pub(crate) error: f64,
    pub(crate) time: f64,
}

impl Share {
    pub(crate) fn of(region: &Region) -> Self {
        Self { error: 100.0 * region.share_that_arises, time: 100.0 * region.share_of_time }
    }
}

impl<'r> FeatureShares<'r> {
    /// Feature by feature, in the order of `regions`.
    pub(crate) fn all(regions: &'r [Region]) -> impl Iterator<Item = Self> {
        regions.chunk_by(|a, b| a.feature == b.feature).map(|regions| Self { regions })
    }

    pub(crate) fn feature(&self) -> Option<Feature> {
        self.regions.first().map(|region| region.feature)
    }

    pub(crate) fn shares(&self) -> impl Iterator<Item = Share> {
        self.regions.iter().map(Share::of)
    }

    /// The largest share in percent.
    pub(crate) fn largest(&self) -> f64 {
        self.shares().flat_map(|share| [share.error, share.time]).fold(0.0, f64::max)
    }

    /// How much of the squared error, in percent, would have to move to be spread as the time
    /// is, counted where it leaves and where it arrives.
    pub(crate) fn unevenness(&self) -> f64 {
        self.shares().map(|share| (share.error - share.time).abs()).sum()
    }
}

/// A panel for each feature, in the order of the regions of the first model.
pub(crate) fn panels(joint: &Joint, models: &[(Role, &Comparison)]) -> Vec<Panel> {
    let first =
        models.first().into_iter().flat_map(|(_, first)| FeatureShares::all(&first.regions));
    first.filter_map(|shares| shares.panel(joint, models)).collect()
}

impl FeatureShares<'_> {
    /// A slot for each part of the feature, in it a bar for each of `models`, and across it a line
    /// at the share of the time. A model that has another number of parts, as its speeds may, has no
    /// bars.
    pub(crate) fn panel(&self, joint: &Joint, models: &[(Role, &Comparison)]) -> Option<Panel> {
        /// Part of a slot that its bars fill.
        const FILLED: f64 = 0.7;
        let feature = self.feature()?;
        let of_model = |(role, comparison): &(Role, &'_ Comparison)| {
            let mut all = FeatureShares::all(&comparison.regions);
            let own = all.find(|shares| shares.feature() == Some(feature));
            let own = own.filter(|own| own.regions.len() == self.regions.len());
            (*role, own.map_or_else(Vec::new, |own| own.shares().collect::<Vec<_>>()))
        };
        let of_models: Vec<(Role, Vec<Share>)> = models.iter().map(of_model).collect();
        let width = FILLED / of_models.len().max(1) as f64;
        let bars = |(number, (role, shares)): (u32, &(Role, Vec<Share>))| {
            let left = (1.0 - FILLED) / 2.0 + width * f64::from(number);
            let bar = |(slot, share): (u32, &Share)| {
                let left = f64::from(slot) + left;
                ((left, 0.0), (left + width, share.error))
            };
            let bars: Vec<(Place, Place)> = (0..).zip(shares).map(bar).collect();
            Mark::new(*role, Shape::Bars(bars)).named("squared error")
        };
        let across = |(slot, share): (u32, Share)| {
            [0.04, 0.96].map(|x| (f64::from(slot) + x, share.time)).to_vec()
        };
        let time = Shape::Lines((0..).zip(self.shares()).map(across).collect(), 1.6);
        let heights = of_models.iter().flat_map(|(_, shares)| shares).map(|share| share.error);
        let largest = heights.fold(self.largest(), f64::max);
        let slots = Span::new(0.0, self.regions.len() as f64);
        let x = Axis {
            ticks: names(self.regions),
            ..Axis::new(slots, feature_with_unit(feature, joint), 1.0)
        };
        let mut marks: Vec<Mark> = (0..).zip(&of_models).map(bars).collect();
        marks.push(Mark::new(Role::Ink, time).named("time"));
        let y = Axis::new(Span::new(0.0, 1.08 * largest.max(1.0)), "share [%]", 4.0);
        Some(Panel { x, y, height: 190, marks })
    }
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
