//! A feature cut into parts, and the part of every sample.

use super::feature::Feature;
use super::record::ResidualRecord;
use super::threshold::{cuts, levels};

/// A feature cut into parts.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub(super) feature: Feature,
    /// Ascending: part `k` is from cut `k - 1` to below cut `k`.
    pub(super) cuts: Vec<f64>,
    /// The only value of each part, where parts have one.
    pub(super) levels: Option<Vec<f64>>,
    /// The part of each sample; [`Axis::parts`] where the feature is not known.
    pub(super) part_of: Vec<u8>,
}

impl Axis {
    /// The feature cut into at most `parts` parts; `None` where that leaves only one.
    ///
    /// Trials beyond what a byte counts are not cut.
    pub(super) fn new(record: &ResidualRecord, feature: Feature, parts: usize) -> Option<Self> {
        let values: Vec<f64> = feature.values(record.samples()).collect();
        let most = if feature.has_kinds() { usize::from(u8::MAX) } else { parts };
        let levels = levels(&values, most);
        if feature.has_kinds() && levels.is_none() {
            return None;
        }
        let cuts = cuts(&values, most);
        if cuts.is_empty() {
            return None;
        }
        let part_of = values.iter().map(|value| part(&cuts, *value)).collect();
        Some(Self { feature, cuts, levels, part_of })
    }

    /// Number of parts.
    pub(super) fn parts(&self) -> usize {
        self.cuts.len() + 1
    }

    /// Where the part begins; no number for the first part and after the last one.
    pub(super) fn bound(&self, part: u8) -> Option<f64> {
        self.cuts.get(usize::from(part).checked_sub(1)?).copied()
    }

    /// Whether `bound` is between the cuts before and after the beginning of `part`.
    pub(super) fn is_near(&self, part: u8, bound: Option<f64>) -> bool {
        match (self.bound(part), bound) {
            (None, None) => true,
            (Some(_), Some(bound)) => {
                let before = part.checked_sub(1).and_then(|part| self.bound(part));
                let behind = part.checked_add(1).and_then(|part| self.bound(part));
                before.is_none_or(|cut| cut < bound) && behind.is_none_or(|cut| bound < cut)
            }
            _ => false,
        }
    }
}

/// The part of `value`, or one after the last for NaN. There are fewer than 256.
fn part(cuts: &[f64], value: f64) -> u8 {
    let part =
        if value.is_nan() { cuts.len() + 1 } else { cuts.partition_point(|cut| *cut <= value) };
    u8::try_from(part).unwrap_or(u8::MAX)
}
