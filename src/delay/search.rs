//! Every candidate breakpoint of a segment: both lines and their squared error.

use crate::numerics::{Line, RunningLine};

/// Difference of two squared errors, as a part of the segment's total sum of squares,
/// below which they tie and the earlier candidate wins. Rounding is four orders below.
const TIE: f64 = 1e-12;

/// All pairs of lines through a segment, the evidence for a decision.
///
/// The segment is the matrix Φ of `rows` rows with β samples each. Candidate
/// `f = 1 … rows − 1` fits one line to rows `1 … f` and another to rows `f+1 … rows`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidates {
    first_sample: usize,
    beta: usize,
    /// Candidates that were compared.
    count: usize,
    best: Option<Candidate>,
    second: Option<Candidate>,
    spread: f64,
    /// The squared error of one line through all rows.
    one_line: f64,
    /// Squared errors of all, where these were kept.
    sse: Vec<f64>,
    /// Lines before and after each breakpoint, where these were kept.
    lines: Vec<(Line, Line)>,
}

/// Weight of a candidate in the [spread](Candidates::spread): its squared error as a part of the
/// best one's, to this power. The noise after a low-pass is correlated, so that the power of
/// independent samples, half their number, would leave the best candidate alone. Chosen on
/// synthetic records: from 4 to a tenth of the samples the order of doubt hardly changes.
const POWER: f64 = 4.0;

/// One pair of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// `f`: rows of Φ before the breakpoint.
    pub f: usize,
    /// `q = r + f·β`: the first sample of the second line.
    pub breakpoint: usize,
    /// Sum of squared errors of both lines, output units squared.
    pub sse: f64,
    /// The line before the breakpoint.
    pub before: Line,
    /// The line from the breakpoint on.
    pub after: Line,
}

impl Candidate {
    /// Slope after minus slope before, output units per sample.
    pub fn slope_change(&self) -> f64 {
        self.after.slope - self.before.slope
    }
}

impl Candidates {
    /// Fits every pair of lines to `values`, the samples from `first_sample` on, in rows
    /// of `beta`; what remains after the last whole row is dropped.
    ///
    /// Time and memory grow with the number of samples and candidates, not their product.
    pub fn search(values: &[f64], first_sample: usize, beta: usize) -> Self {
        Self::search_until(values, first_sample, beta, usize::MAX)
    }

    /// Fits every pair of lines, the best of those that break by the sample `latest`.
    ///
    /// Later ones are evidence only. See [`search`](Self::search).
    pub(crate) fn search_until(
        values: &[f64],
        first_sample: usize,
        beta: usize,
        latest: usize,
    ) -> Self {
        let beta = beta.max(1);
        let rows = values.len() / beta;
        let values = values.get(..rows * beta).unwrap_or_default();
        let mut found = Self { first_sample, beta, ..Self::default() };
        let Some(&offset) = values.first() else {
            return found;
        };
        if rows < 2 {
            return found;
        }
        // Equations are in Σ y and Σ k·y about the first sample: a joint far from zero keeps its
        // digits.
        found.fit_before(values, offset);
        found.fit_after(values, offset);
        let mut all = RunningLine::default();
        for y in values {
            all.push(y - offset);
        }
        found.one_line = all.sse();
        // Algorithm 1: q_i is where SSE_f is least.
        let best = found.lowest(TIE * sum_of_squares(values, offset), latest);
        found.count = found.sse.len();
        found.best = best.and_then(|best| found.get(best));
        found.second = best.and_then(|best| found.get(found.second_to(best)?));
        found.spread = found.best.map_or(0.0, |best| found.spread_about(&best));
        found
    }

    /// These without the errors and lines of all: the best, the second-best and the spread remain.
    pub(super) fn with_best_alone(self) -> Self {
        Self { sse: Vec::new(), lines: Vec::new(), ..self }
    }

    /// Fits the lines before each breakpoint, from the front.
    fn fit_before(&mut self, values: &[f64], offset: f64) {
        let count = values.len() / self.beta - 1;
        self.sse.reserve_exact(count);
        self.lines.reserve_exact(count);
        let mut line = RunningLine::default();
        for (row, f) in values.chunks_exact(self.beta).take(count).zip(1..) {
            for y in row {
                line.push(y - offset);
            }
            // The regression line goes through the mean, in the middle of its f·β samples.
            let middle = self.first_sample as f64 + ((f * self.beta) as f64 - 1.0) / 2.0;
            self.sse.push(line.sse());
            let before = line_through(middle, line.mean() + offset, line.slope());
            self.lines.push((before, Line::default()));
        }
    }

    /// Fits the lines after each breakpoint, from the back.
    fn fit_after(&mut self, values: &[f64], offset: f64) {
        let last = self.first_sample as f64 + values.len() as f64 - 1.0;
        let mut line = RunningLine::default();
        let slots = self.lines.iter_mut().rev().zip(self.sse.iter_mut().rev());
        for ((row, (lines, sse)), count) in values.rchunks_exact(self.beta).zip(slots).zip(1..) {
            for y in row.iter().rev() {
                line.push(y - offset);
            }
            let middle = last - ((count * self.beta) as f64 - 1.0) / 2.0;
            // Grown towards the front: its own slope has the other sign.
            lines.1 = line_through(middle, line.mean() + offset, -line.slope());
            // SSE_f = SSE of rows 1 … f + SSE of rows f+1 … M.
            *sse += line.sse();
        }
    }

    /// The first candidate within `tie` of the lowest squared error up to `latest`.
    fn lowest(&self, tie: f64, latest: usize) -> Option<usize> {
        // Candidate f breaks at q = r + f·β ≤ latest.
        let in_time = latest.saturating_sub(self.first_sample) / self.beta;
        let sse = self.sse.get(..in_time).unwrap_or(&self.sse);
        let lowest = sse.iter().copied().fold(f64::INFINITY, f64::min);
        sse.iter().position(|&sse| sse <= lowest + tie)
    }

    /// Number of candidates: rows of Φ less one.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether the segment was too short for two lines.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The candidate at `index`, which is `f − 1`; none where only the best were kept.
    pub fn get(&self, index: usize) -> Option<Candidate> {
        let (f, sse, (before, after)) = (index + 1, *self.sse.get(index)?, *self.lines.get(index)?);
        Some(Candidate { f, breakpoint: self.first_sample + f * self.beta, sse, before, after })
    }

    /// All candidates, in the order of their breakpoints; none where only the best were kept.
    pub fn iter(&self) -> impl Iterator<Item = Candidate> + '_ {
        (0..self.sse.len()).filter_map(|index| self.get(index))
    }

    /// The candidate with the lowest squared error, the first of those that tie.
    pub fn best(&self) -> Option<Candidate> {
        self.best
    }

    /// The best candidate in another valley of the squared error; where there is only one
    /// valley, the better neighbour of the best.
    pub fn second(&self) -> Option<Candidate> {
        self.second
    }

    /// The index of the second-best candidate, the best being at `chosen`.
    fn second_to(&self, chosen: usize) -> Option<usize> {
        let at = |index: usize| self.sse.get(index).copied().unwrap_or(f64::INFINITY);
        let is_valley = |index: &usize| {
            let before = index.checked_sub(1).map_or(f64::INFINITY, at);
            *index != chosen && at(*index) < before && at(*index) <= at(index + 1)
        };
        let least = |a: &usize, b: &usize| at(*a).total_cmp(&at(*b));
        let apart = |index: &usize| index.abs_diff(chosen) > 1;
        let valley = (0..self.sse.len()).filter(apart).filter(is_valley).min_by(least);
        let neighbours = chosen.checked_sub(1).into_iter().chain([chosen + 1]);
        let neighbour = neighbours.filter(|index| *index < self.sse.len()).min_by(least);
        valley.or(neighbour)
    }

    /// The part of the squared error of one line that the best pair removes: `1 − SSE₂ / SSE₁`.
    pub(super) fn explained(&self) -> f64 {
        let left = self.best.map_or(0.0, |best| best.sse);
        if self.one_line > 0.0 { (1.0 - left / self.one_line).max(0.0) } else { 0.0 }
    }

    /// Samples from one candidate to the next.
    pub(super) fn spacing(&self) -> usize {
        if self.is_empty() { 1 } else { self.beta.max(1) }
    }

    /// How far from the best candidate those lie that fit nearly as well, samples: the root mean
    /// square distance of all, weighted by `(SSE_best / SSE)⁴`.
    pub(super) fn spread(&self) -> f64 {
        self.spread
    }

    fn spread_about(&self, best: &Candidate) -> f64 {
        let (mut weights, mut squares) = (0.0, 0.0);
        for (index, sse) in self.sse.iter().enumerate() {
            let ratio = if *sse > 0.0 { best.sse / sse } else { 1.0 };
            // The likelihood of independent normal residuals is SSE^(−n/2); see POWER.
            let weight = ratio.min(1.0).powf(POWER);
            let distance = ((index + 1).abs_diff(best.f) * self.beta) as f64;
            weights += weight;
            squares += weight * distance * distance;
        }
        if weights > 0.0 { (squares / weights).sqrt() } else { 0.0 }
    }

    /// Squared errors, output units squared, in the order of the breakpoints; none where only
    /// the best were kept.
    pub fn sse(&self) -> &[f64] {
        &self.sse
    }
}

/// The line of `slope` through `value` at sample `k`.
fn line_through(k: f64, value: f64, slope: f64) -> Line {
    Line { slope, intercept: value - slope * k }
}

/// Total sum of squares about the mean.
fn sum_of_squares(values: &[f64], offset: f64) -> f64 {
    let mean = values.iter().map(|y| y - offset).sum::<f64>() / values.len() as f64;
    values.iter().map(|y| (y - offset - mean) * (y - offset - mean)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A level line, then a slope of 2 from `kink` (an index) on.
    fn kinked(length: usize, kink: usize) -> Vec<f64> {
        (0..length).map(|k| 2.0 * (k.saturating_sub(kink)) as f64).collect()
    }

    #[test]
    fn the_best_alone_and_the_second_are_those_of_all() {
        for (length, kink) in [(9, 4), (10, 5), (48, 25), (48, 3), (400, 390)] {
            let all = Candidates::search(&kinked(length, kink), 79, 5);
            let few = all.clone().with_best_alone();
            assert_eq!((few.best(), few.len()), (all.best(), all.len()));
            let error = |found: &Candidates| found.second().map(|it| (it.breakpoint, it.sse));
            assert_eq!(error(&few), error(&all));
            assert_eq!((few.is_empty(), few.sse().len()), (all.is_empty(), 0));
            assert!((few.spread() - all.spread()).abs() <= 0.0);
        }
    }

    #[test]
    fn a_tie_goes_to_the_first() {
        let flat = Candidates::search(&[3.25; 60], 1, 5);
        assert_eq!(flat.best().unwrap().f, 1);
        let line: Vec<f64> = (0..60).map(|k| 0.1 * f64::from(k)).collect();
        assert_eq!(Candidates::search(&line, 1, 5).best().unwrap().f, 1);
    }

    #[test]
    fn fewer_than_two_rows_have_no_candidate() {
        for length in 0..10 {
            assert!(Candidates::search(&vec![1.0; length], 1, 5).is_empty());
        }
        assert_eq!(Candidates::search(&[1.0; 10], 1, 5).len(), 1);
    }
}
