//! The record cut by each feature, and the error in each part.

use serde::Serialize;

use super::axis::Axis;
use super::feature::Feature;
use super::record::ResidualRecord;

/// Parts that a feature is cut into; where it has no more levels, each is a part.
const PARTS: usize = 10;

/// A part of the record in which a feature is between two bounds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Region {
    /// The feature.
    pub feature: Feature,
    /// What it is there, in words: `0.5 to 1.2`, a level, a trial's label.
    pub label: String,
    /// Lower bound, in the feature's unit; the level where it has levels.
    pub from: f64,
    /// Upper bound, in the feature's unit; the level where it has levels.
    pub to: f64,
    /// Share of the samples.
    pub share_of_time: f64,
    /// Share of the sum of squared residuals; 0 when there is no error at all.
    pub share_of_squared_error: f64,
    /// Share of the sum of squared errors of the speed, from which residuals arise, as in
    /// [`FailsWhere`](super::FailsWhere); that of residuals where the speed is not known.
    #[serde(skip)]
    pub share_that_arises: f64,
    /// Root mean square of the residual there, output units.
    pub rmse: f64,
    /// Mean of the residual there, output units.
    pub mean_residual: f64,
}

/// The features that regions are of.
const FEATURES: [Feature; 8] = [
    Feature::Input,
    Feature::Direction,
    Feature::Output,
    Feature::Speed,
    Feature::SinceStep,
    Feature::Hold,
    Feature::Time,
    Feature::Trial,
];

/// The regions of every feature that varies, feature by feature, each in ascending order.
///
/// The regions of a feature do not overlap. They cover all samples where it is known.
pub fn regions(record: &ResidualRecord) -> Vec<Region> {
    let axes = FEATURES.into_iter().filter_map(|feature| Axis::new(record, feature, PARTS));
    let arises = record.shares_of_what_arises().unwrap_or_default();
    axes.flat_map(|axis| of_axis(record, &axis, &arises)).collect()
}

/// Sums over the samples of a part.
#[derive(Clone, Copy, Debug)]
struct Sums {
    count: f64,
    residual: f64,
    square: f64,
    /// Share of what arises.
    arises: f64,
    low: f64,
    high: f64,
}

impl Sums {
    const NONE: Self = Self {
        count: 0.0,
        residual: 0.0,
        square: 0.0,
        arises: 0.0,
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
    };

    fn add(&mut self, residual: f64, arises: f64, value: f64) {
        self.count += 1.0;
        self.arises += arises;
        self.residual += residual;
        self.square += residual * residual;
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }
}

fn of_axis(record: &ResidualRecord, axis: &Axis, arises: &[f64]) -> Vec<Region> {
    let mut parts = vec![Sums::NONE; axis.parts()];
    let values = axis.feature.values(record.samples());
    // Where there is no error at all, none arises.
    let arises = arises.iter().copied().chain(std::iter::repeat(0.0));
    let samples = record.samples().residual.iter().zip(arises).zip(values).zip(&axis.part_of);
    for (((residual, arises), value), part) in samples {
        if let Some(sums) = parts.get_mut(usize::from(*part)) {
            sums.add(*residual, arises, value);
        }
    }
    let squares: f64 = record.samples().residual.iter().map(|r| r * r).sum();
    let numbered = parts.iter().enumerate().filter(|(_, sums)| sums.count > 0.0);
    numbered.map(|(part, sums)| region(record, axis, part, *sums, squares)).collect()
}

fn region(record: &ResidualRecord, axis: &Axis, part: usize, sums: Sums, squares: f64) -> Region {
    let below = part.checked_sub(1).and_then(|before| axis.cuts.get(before)).copied();
    let above = axis.cuts.get(part).copied();
    let level = axis.levels.as_ref().and_then(|levels| levels.get(part)).copied();
    // The outermost parts have no cut: what was measured there.
    let from = level.or(below).unwrap_or(sums.low);
    let to = level.or(above).unwrap_or(sums.high);
    Region {
        feature: axis.feature,
        label: label(record, axis.feature, level, from, to),
        from,
        to,
        share_of_time: sums.count / record.len() as f64,
        share_of_squared_error: if squares > 0.0 { sums.square / squares } else { 0.0 },
        share_that_arises: sums.arises,
        rmse: (sums.square / sums.count).sqrt(),
        mean_residual: sums.residual / sums.count,
    }
}

fn label(
    record: &ResidualRecord,
    feature: Feature,
    level: Option<f64>,
    from: f64,
    to: f64,
) -> String {
    match (feature, level) {
        (Feature::Direction, _) if from < 0.0 => "negative".to_owned(),
        (Feature::Direction, _) if from > 0.0 => "positive".to_owned(),
        (Feature::Direction, _) => "zero".to_owned(),
        (Feature::Trial, Some(level)) => trial_label(record, level).to_owned(),
        (_, Some(level)) => level.to_string(),
        (_, None) => format!("{from} to {to}"),
    }
}

/// The label of the trial whose index is `level`.
pub(super) fn trial_label(record: &ResidualRecord, level: f64) -> &str {
    let mut labels = record.trials().iter().zip(0_u32..);
    let found = labels.find(|(_, index)| (f64::from(*index) - level).abs() < 0.5);
    found.map_or("", |(label, _)| label)
}
