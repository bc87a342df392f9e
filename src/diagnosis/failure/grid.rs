//! Every condition of one or two clauses, scored at once with cumulative sums.

use super::axis::Axis;
use super::feature::Feature;
use super::record::{ResidualRecord, Row, of_row};

/// Parts that a feature is cut into, so that a threshold is right to 3 % of the time.
const PARTS: usize = 32;

/// Parts about a threshold that is kept.
const FINE_PARTS: usize = 250;

/// What a second clause must add to the gain to be worth reading.
const CLAUSE_COST: f64 = 0.05;

/// What a clause on the speed must add to one on the input: the input was chosen, the speed
/// came of it.
const SPEED_COST: f64 = 0.02;

/// Parts `from .. to` of an axis, and the clauses it takes to say so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) from: u8,
    pub(super) to: u8,
    pub(super) clauses: u8,
}

impl Span {
    fn of<T: Copy + std::ops::Sub<Output = T>>(self, cumulative: &[T]) -> T {
        cumulative[usize::from(self.to)] - cumulative[usize::from(self.from)]
    }

    pub(super) fn contains(self, part: u8) -> bool {
        (self.from..self.to).contains(&part)
    }
}

/// A span of the axis with this number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Selection {
    pub(super) axis: usize,
    pub(super) span: Span,
}

/// A condition and its score.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Choice {
    /// Selections that all hold, one or two.
    pub(super) selections: Vec<Selection>,
    /// Share of the squared error minus share of the time, minus the cost of clauses and
    /// features.
    pub(super) score: f64,
}

impl Choice {
    const NONE: Self = Self { selections: Vec::new(), score: 0.0 };

    /// Keeps the better; the earlier where they tie to rounding.
    fn offer(&mut self, score: f64, selections: &[Selection]) {
        if score > self.score + 1e-12 {
            *self = Self { selections: selections.to_vec(), score };
        }
    }
}

/// Conditions on one feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// Of one clause.
    OneClause,
    /// Of one clause, or of two that make an interval.
    OneFeature,
}

/// The best score of each [`Family`].
pub(super) type BestScores = [f64; 2];

/// Features of a record, cut into parts.
#[derive(Debug)]
pub(super) struct Grid {
    pub(super) axes: Vec<Axis>,
    spans: Vec<Vec<Span>>,
}

impl Grid {
    pub(super) fn new(record: &ResidualRecord) -> Self {
        Self::of(record, |_| true)
    }

    /// Of all features but those that say how fast the joint is driven.
    pub(super) fn beside_motion(record: &ResidualRecord) -> Self {
        let drives = [Feature::Input, Feature::AbsInput, Feature::Speed, Feature::AbsSpeed];
        Self::of(record, |feature| !drives.contains(&feature))
    }

    fn of(record: &ResidualRecord, takes_part: impl Fn(Feature) -> bool) -> Self {
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
        let all = Feature::all().filter(|feature| takes_part(*feature));
        let features = all.filter(useful);
        let axes = features.filter_map(|feature| Axis::new(record, feature, PARTS));
        let axes: Vec<_> = axes.collect();
        let spans = axes.iter().map(spans).collect();
        Self { axes, spans }
    }

    /// The features of `choice` alone, cut finely, with all ways to move its thresholds no
    /// farther than to the next ones.
    pub(super) fn about(&self, record: &ResidualRecord, choice: &Choice) -> Option<Self> {
        let fine = |selection: &Selection| {
            let coarse = self.axes.get(selection.axis)?;
            let axis = Axis::new(record, coarse.feature, FINE_PARTS)?;
            let near = |cut: u8, fine: u8| coarse.is_near(cut, axis.bound(fine));
            let spans = spans(&axis).into_iter().filter(|span| {
                let Selection { span: old, .. } = selection;
                span.clauses == old.clauses && near(old.from, span.from) && near(old.to, span.to)
            });
            let spans = spans.collect();
            Some((axis, spans))
        };
        let fine: Option<Vec<_>> = choice.selections.iter().map(fine).collect();
        let (axes, spans) = fine?.into_iter().unzip();
        Some(Self { axes, spans })
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

    /// The best condition on one feature, from the sums in its parts.
    pub(super) fn best_of(&self, sums: &[Vec<f64>]) -> Choice {
        let mut best = Choice::NONE;
        for (axis, (sums, spans)) in sums.iter().zip(&self.spans).enumerate() {
            let cumulative = cumulative(sums);
            for &span in spans {
                let score = span.of(&cumulative) - self.cost(&[axis], span.clauses);
                best.offer(score, &[Selection { axis, span }]);
            }
        }
        best
    }

    /// The scores of the best conditions on one feature, of either family.
    pub(super) fn best_scores(&self, sums: &[Vec<f64>]) -> BestScores {
        let mut best = [0.0_f64; 2];
        for (axis, (sums, spans)) in sums.iter().zip(&self.spans).enumerate() {
            let cumulative = cumulative(sums);
            for span in spans {
                let score = span.of(&cumulative) - self.cost(&[axis], span.clauses);
                let families = if span.clauses == 1 { 0..2 } else { 1..2 };
                best[families].iter_mut().for_each(|best| *best = best.max(score));
            }
        }
        best
    }

    /// The best condition of one clause each on two features.
    pub(super) fn best_pair(&self, rows: &[Row], excess: impl Fn(Row) -> f64) -> Choice {
        let mut best = Choice::NONE;
        for first in 0..self.axes.len() {
            for second in first + 1..self.axes.len() {
                let table = self.table(first, second, rows, &excess);
                self.pairs(first, second, &table, &mut best);
            }
        }
        best
    }

    /// Offers every pair of clauses on two axes, from a table of sums over their parts.
    fn pairs(&self, first: usize, second: usize, table: &[f64], best: &mut Choice) {
        let width = self.axes[second].parts() + 2;
        let mut inside = vec![0.0; width];
        let cost = self.cost(&[first, second], 2);
        for &span in self.spans[first].iter().filter(|span| span.clauses == 1) {
            let (from, to) = (usize::from(span.from) * width, usize::from(span.to) * width);
            let rows = table[to..to + width].iter().zip(&table[from..from + width]);
            // Cumulative over the second axis, within the span of the first.
            inside.iter_mut().zip(rows).for_each(|(slot, (to, from))| *slot = to - from);
            for &other in self.spans[second].iter().filter(|span| span.clauses == 1) {
                let score = other.of(&inside) - cost;
                if score > best.score {
                    let first = Selection { axis: first, span };
                    best.offer(score, &[first, Selection { axis: second, span: other }]);
                }
            }
        }
    }

    /// What `clauses` clauses on `axes` cost.
    fn cost(&self, axes: &[usize], clauses: u8) -> f64 {
        let is_speed = |axis: &&usize| {
            let feature = self.axes.get(**axis).map(|axis| axis.feature);
            matches!(feature, Some(Feature::Speed | Feature::AbsSpeed))
        };
        let of_features = SPEED_COST * axes.iter().filter(is_speed).count() as f64;
        CLAUSE_COST * (f64::from(clauses) - 1.0) + of_features
    }

    /// Sums over all parts below `(j, k)` of two axes, row by row.
    fn table(
        &self,
        first: usize,
        second: usize,
        rows: &[Row],
        excess: impl Fn(Row) -> f64,
    ) -> Vec<f64> {
        let (first, second) = (&self.axes[first], &self.axes[second]);
        let width = second.parts() + 2;
        let mut table = vec![0.0; (first.parts() + 2) * width];
        for &row in rows {
            let (j, k) = (of_row(&first.part_of, row), of_row(&second.part_of, row));
            table[(usize::from(j) + 1) * width + usize::from(k) + 1] += excess(row);
        }
        for index in width..table.len() {
            if index % width > 0 {
                // S(j, k) = a(j, k) + S(j, k − 1) + S(j − 1, k) − S(j − 1, k − 1).
                table[index] += table[index - 1] + table[index - width] - table[index - width - 1];
            }
        }
        table
    }

    /// Those of `rows` for which all selections hold.
    pub(super) fn members(
        &self,
        selections: &[Selection],
        rows: impl IntoIterator<Item = Row>,
    ) -> Vec<Row> {
        let holds = |row: Row, selection: &Selection| {
            selection.span.contains(of_row(&self.axes[selection.axis].part_of, row))
        };
        let all_hold = |row: &Row| selections.iter().all(|one| holds(*row, one));
        rows.into_iter().filter(all_hold).collect()
    }
}

fn cumulative(sums: &[f64]) -> Vec<f64> {
    let running = sums.iter().scan(0.0, |sum, value| {
        *sum += value;
        Some(*sum)
    });
    std::iter::once(0.0).chain(running).collect()
}

/// All spans that can be said: each kind; or below, from, and between cuts.
fn spans(axis: &Axis) -> Vec<Span> {
    let parts = u8::try_from(axis.parts()).unwrap_or(u8::MAX);
    if axis.feature.has_kinds() {
        return (0..parts).map(|kind| Span { from: kind, to: kind + 1, clauses: 1 }).collect();
    }
    let ends = (1..parts).flat_map(|cut| [(0, cut), (cut, parts)]);
    let ends = ends.map(|(from, to)| Span { from, to, clauses: 1 });
    let between = (1..parts).flat_map(|from| (from + 1..parts).map(move |to| (from, to)));
    ends.chain(between.map(|(from, to)| Span { from, to, clauses: 2 })).collect()
}

#[cfg(test)]
mod tests {
    use rand::{Rng as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::diagnosis::failure::Samples;

    /// A small record of random columns, with few values each.
    fn record(seed: u64) -> ResidualRecord {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut column = |values: u32| -> Vec<f64> {
            (0..120).map(|_| f64::from(random.next_u32() % values) - 3.0).collect()
        };
        let samples = Samples {
            residual: column(9),
            input: column(6),
            output: column(90),
            speed: column(8),
            time_s: column(1000),
            since_step_s: column(4),
            hold_s: column(2),
            trial: column(3).into_iter().map(|value| u32::from(value > -2.0)).collect(),
            speed_error: Vec::new(),
        };
        ResidualRecord::new(samples, vec!["a".into(), "b".into()], Vec::new()).unwrap()
    }

    fn all_pairs(grid: &Grid) -> Vec<[Selection; 2]> {
        let axes = || 0..grid.axes.len();
        let one = |axis: usize| {
            let spans = grid.spans[axis].iter().filter(|span| span.clauses == 1);
            spans.map(move |span| Selection { axis, span: *span })
        };
        let axes = axes().flat_map(|a| axes().filter(move |b| a < *b).map(move |b| (a, b)));
        axes.flat_map(|(a, b)| one(a).flat_map(move |first| one(b).map(move |next| [first, next])))
            .collect()
    }

    #[test]
    fn the_best_is_that_of_going_through_all() {
        for seed in 0..8 {
            let record = record(seed);
            let grid = Grid::new(&record);
            let rows: Vec<Row> = (0..120).filter(|row| row % 7 > 0).collect();
            let excess = |row: Row| of_row(&record.samples().residual, row);
            let sum = |selections: &[Selection]| {
                let inside = |row: Row| {
                    let holds =
                        |s: &Selection| s.span.contains(of_row(&grid.axes[s.axis].part_of, row));
                    selections.iter().all(holds)
                };
                rows.iter().filter(|row| inside(**row)).map(|row| excess(*row)).sum::<f64>()
            };
            let value = |selections: &[Selection], clauses| {
                let axes: Vec<usize> = selections.iter().map(|one| one.axis).collect();
                sum(selections) - grid.cost(&axes, clauses)
            };
            let best = all_pairs(&grid).iter().map(|pair| value(pair, 2)).fold(0.0, f64::max);
            assert!((grid.best_pair(&rows, excess).score - best).abs() < 1e-9);

            let spans = grid.spans.iter().enumerate();
            let one = spans.flat_map(|(axis, spans)| {
                spans.iter().map(move |span| Selection { axis, span: *span })
            });
            let best = one.map(|one| value(&[one], one.span.clauses)).fold(0.0, f64::max);
            let sums = grid.part_sums(&rows, excess);
            assert!((grid.best_of(&sums).score - best).abs() < 1e-9);
            assert!((grid.best_scores(&sums)[Family::OneFeature as usize] - best).abs() < 1e-9);
        }
    }
}
