//! Every condition of one clause, scored at once with cumulative sums.

use super::axis::Axis;
use super::feature::Feature;
use super::record::{ResidualRecord, Row, of_row};

/// Parts that a feature is cut into, so that a threshold is right to 1 % of the time.
const PARTS: usize = 100;

/// What a clause on the speed must add to one on the input: the input was chosen, the speed
/// came of it.
const SPEED_COST: f64 = 0.02;

/// Parts `from .. to` of the axis with this number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Selection {
    pub(super) axis: usize,
    pub(super) from: usize,
    pub(super) to: usize,
}

/// Features of a record, cut into parts.
#[derive(Debug)]
pub(super) struct Grid {
    pub(super) axes: Vec<Axis>,
}

impl Grid {
    /// Of the features of which `takes_part` is true.
    pub(super) fn of(record: &ResidualRecord, takes_part: impl Fn(Feature) -> bool) -> Self {
        let turns = |values: &[f64]| {
            values.iter().any(|value| *value > 0.0) && values.iter().any(|value| *value < 0.0)
        };
        let samples = record.samples();
        // Where the sign never changes, the magnitude says nothing more.
        let useful = |feature: &Feature| match feature {
            Feature::AbsInput => turns(&samples.input),
            Feature::AbsSpeed => turns(&samples.speed),
            _ => true,
        };
        let features = Feature::all().filter(|feature| takes_part(*feature)).filter(useful);
        Self { axes: features.filter_map(|feature| Axis::new(record, feature, PARTS)).collect() }
    }

    /// The sum of `excess` in each part of each axis, at the samples `rows`.
    pub(super) fn part_sums(&self, rows: &[Row], excess: impl Fn(Row) -> f64) -> Vec<Vec<f64>> {
        let sum = |axis: &Axis| {
            let mut sums = vec![0.0; axis.parts() + 1];
            for &row in rows {
                sums[usize::from(of_row(&axis.part_of, row))] += excess(row);
            }
            sums
        };
        self.axes.iter().map(sum).collect()
    }

    /// The best clause and its score, from the sums in the parts of each axis; none where nothing
    /// scores above 0.
    pub(super) fn best(&self, sums: &[Vec<f64>]) -> (Option<Selection>, f64) {
        /// Scores that differ by less tie; the earlier clause is taken.
        const TIE: f64 = 1e-12;
        let (mut best, mut most) = (None, 0.0);
        for (number, (axis, sums)) in self.axes.iter().zip(sums).enumerate() {
            let is_speed = matches!(axis.feature, Feature::Speed | Feature::AbsSpeed);
            let cost = if is_speed { SPEED_COST } else { 0.0 };
            let mut offer = |from: usize, to: usize, sum: f64| {
                if sum - cost > most + TIE {
                    (best, most) = (Some(Selection { axis: number, from, to }), sum - cost);
                }
            };
            let (parts, mut below) = (axis.parts(), 0.0);
            if axis.feature.has_kinds() {
                (0..parts).for_each(|kind| offer(kind, kind + 1, sums[kind]));
                continue;
            }
            let all: f64 = sums[..parts].iter().sum();
            for cut in 1..parts {
                below += sums[cut - 1];
                offer(0, cut, below);
                offer(cut, parts, all - below);
            }
        }
        (best, most)
    }

    /// Those of `rows` for which all selections hold.
    pub(super) fn members(
        &self,
        selections: &[Selection],
        rows: impl IntoIterator<Item = Row>,
    ) -> Vec<Row> {
        let holds = |row: Row, one: &Selection| {
            let part = usize::from(of_row(&self.axes[one.axis].part_of, row));
            (one.from..one.to).contains(&part)
        };
        let all_hold = |row: &Row| selections.iter().all(|one| holds(*row, one));
        rows.into_iter().filter(all_hold).collect()
    }
}
