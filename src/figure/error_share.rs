//! Where the error arises: its share in each part of a feature, beside the share of the time.

use crate::diagnosis::failure::{Feature, Region};

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

/// Whether a part is one level of its feature, not a range.
pub(crate) fn is_level(region: &Region) -> bool {
    #[expect(clippy::float_cmp, reason = "a level is both of its bounds")]
    let is_level = region.from == region.to;
    is_level
}
