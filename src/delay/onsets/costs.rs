//! What the output between two onsets costs: the squared error of a line, or of the free
//! motion behind a lag.

use crate::delay::lag::FreeMotion;
use crate::numerics::moments;

/// Samples of a piece in which earlier steps may still be felt, at most.
pub(crate) const LONGEST_MOTION: usize = 2000;

/// What the output is between two reactions.
#[derive(Clone, Debug)]
pub(super) enum Pieces {
    /// About a line.
    Lines,
    /// The transients of earlier steps behind a lag.
    Motions(FreeMotion),
}

/// What a reaction after the next step of the input costs more than one before it.
pub(super) fn lateness(output: &[f64]) -> f64 {
    2.0 * second_difference_noise(output) * (output.len() as f64).ln()
}

/// Variance of white noise that would make the second differences of `output`.
fn second_difference_noise(output: &[f64]) -> f64 {
    /// The median of a normal variable's magnitude.
    const MEDIAN: f64 = 0.674_49;
    /// Differences that are enough to know it.
    const ENOUGH: usize = 10_000;
    let bend = |w: &[f64]| (w[0] - 2.0 * w[1] + w[2]).abs();
    let every = output.len().div_ceil(ENOUGH).max(1);
    let mut bends: Vec<f64> = output.windows(3).step_by(every).map(bend).collect();
    if bends.is_empty() {
        return 0.0;
    }
    let middle = bends.len() / 2;
    let median = *bends.select_nth_unstable_by(middle, f64::total_cmp).1;
    // 1² + 2² + 1² = 6 times the variance of white noise.
    (median / MEDIAN).powi(2) / 6.0
}

/// Sums of the output up to a position, about the first sample of all.
#[derive(Clone, Copy, Debug, Default)]
struct Mark {
    position: usize,
    /// Samples up to here.
    count: f64,
    /// `Σ y, Σ k·y, Σ y²`.
    sums: [f64; 3],
}

impl Mark {
    /// The marks at the positions of `from` and of `to`, both of which ascend; those before `first`,
    /// or behind the end, are left empty.
    fn all(output: &[f64], first: usize, from: &[usize], to: &[usize]) -> [Vec<Self>; 2] {
        let offset = output.get(first).copied().unwrap_or_default();
        let mut now = Self { position: first, ..Self::default() };
        let mut up_to = |position: usize| {
            if position < first || position > output.len() {
                return Self::default();
            }
            let values = output.get(now.position..position).unwrap_or_default();
            let (y, ky, yy) = moments(values, offset);
            let [y_sum, moment, square] = now.sums;
            let sums = [y_sum + y, moment + now.count * y + ky, square + yy];
            now = Self { position, count: now.count + values.len() as f64, sums };
            now
        };
        let mut marks = [Vec::with_capacity(from.len()), Vec::with_capacity(to.len())];
        let [starts, ends] = &mut marks;
        let mut later = to.iter().copied().peekable();
        for start in from.iter().copied() {
            while let Some(end) = later.next_if(|end| *end < start) {
                ends.push(up_to(end));
            }
            starts.push(up_to(start));
        }
        ends.extend(later.map(up_to));
        marks
    }

    /// The squared error of the line from here up to `end`.
    fn line(&self, end: &Self) -> f64 {
        let n = end.count - self.count;
        if n < 3.0 {
            return 0.0;
        }
        let part = |index: usize| end.sums[index] - self.sums[index];
        let (y, ky, yy) = (part(0), part(1), part(2));
        let middle = self.count + (n - 1.0) / 2.0;
        let moment = ky - middle * y;
        let spread = n * n - 1.0;
        // SSE = Σy² − (Σy)²/n − 12·(Σ(k − middle)·y)²/(n(n² − 1)).
        (yy - (y * y * spread + 12.0 * moment * moment) / (n * spread)).max(0.0)
    }
}

impl Pieces {
    /// The squared errors of the pieces from each position of `from` to each of `to`, both of
    /// which ascend; infinite where the two are too close. All of one start follow each other.
    pub(super) fn errors(&self, output: &[f64], from: &[usize], to: &[usize]) -> Vec<f64> {
        /// Samples between two reactions, at least.
        const APART: usize = 2;
        let first = from.first().copied().unwrap_or(0);
        let starts: Vec<usize> = match self {
            Self::Lines => from.to_vec(),
            Self::Motions(_) => from.iter().map(|start| start + LONGEST_MOTION).collect(),
        };
        let [low, high] = Mark::all(output, first, &starts, to);
        let mut errors = Vec::with_capacity(from.len() * to.len());
        for ((start, unfelt), low) in from.iter().zip(&starts).zip(&low) {
            let far = |end: &usize| start + APART <= *end;
            if matches!(self, Self::Lines) {
                let ends = high.iter().zip(to);
                let error = |(high, end)| if far(end) { low.line(high) } else { f64::INFINITY };
                errors.extend(ends.map(error));
                continue;
            }
            let felt = self.felt(output, *start, to).into_iter();
            let ends = felt.chain(std::iter::repeat(0.0)).zip(&high).zip(to);
            errors.extend(ends.map(|((felt, high), end)| {
                let rest = if unfelt < end { low.line(high) } else { 0.0 };
                if far(end) { felt + rest } else { f64::INFINITY }
            }));
        }
        errors
    }

    /// The squared errors while earlier reactions are felt; none for lines.
    fn felt(&self, output: &[f64], start: usize, ends: &[usize]) -> Vec<f64> {
        let Self::Motions(motion) = self else { return Vec::new() };
        let values = output.get(start..).unwrap_or_default();
        motion.errors(values, ends.iter().map(|end| end.saturating_sub(start)))
    }
}
