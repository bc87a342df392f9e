//! Ranges of axes with their ticks, and signals thinned to what can be seen.

use crate::numerics::as_written;

/// Data range of an axis; never empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Span {
    pub(crate) fn new(low: f64, high: f64) -> Self {
        let room = match (high - low > 0.0, low.abs() > 0.0) {
            (true, _) => 0.0,
            (false, true) => 0.1 * low.abs(),
            (false, false) => 1.0,
        };
        Self { low: low - room, high: high + room }
    }

    /// The range of `values`, with a part of it added on both sides.
    pub(crate) fn around(values: impl Iterator<Item = f64>, margin: f64) -> Self {
        let wider = |(low, high): (f64, f64), y: f64| (low.min(y), high.max(y));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), wider);
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        let room = margin * (high - low);
        Self::new(low - room, high + room)
    }

    /// Where a value lies: 0 at the lower end, 1 at the upper one.
    pub(crate) fn part(self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Round numbers in the range, about `count` of them.
    pub(crate) fn ticks(self, count: f64) -> Vec<f64> {
        let rough = (self.high - self.low) / count;
        let power = 10f64.powf(rough.log10().floor());
        let coarse = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= rough);
        let ticks = self.multiples(coarse.unwrap_or(rough));
        // One alone says nothing of the scale.
        if ticks.len() > 1 { ticks } else { self.multiples(0.5 * coarse.unwrap_or(rough)) }
    }

    fn multiples(self, step: f64) -> Vec<f64> {
        let first = (self.low / step).ceil();
        let ticks = (0..100).map(|n| (first + f64::from(n)) * step);
        ticks.take_while(|tick| *tick <= self.high).collect()
    }
}

/// Indices that keep the shape of `values` with at most so many points: all of them, or of
/// each part the lowest and the highest.
pub(crate) fn thinned_to(values: &[f64], points: usize) -> Vec<usize> {
    if values.len() <= points.max(2) {
        return (0..values.len()).collect();
    }
    let part = values.len().div_ceil((points / 2).max(1));
    let mut kept = Vec::with_capacity(points);
    for (chunk, start) in values.chunks(part).zip((0..).step_by(part)) {
        let by_value = |a: &(usize, &f64), b: &(usize, &f64)| a.1.total_cmp(b.1);
        let lowest = chunk.iter().enumerate().min_by(by_value).map_or(0, |(index, _)| index);
        let highest = chunk.iter().enumerate().max_by(by_value).map_or(0, |(index, _)| index);
        kept.push(start + lowest.min(highest));
        if lowest != highest {
            kept.push(start + lowest.max(highest));
        }
    }
    kept
}

/// `places` thinned to at most so many points.
pub(crate) fn thinned_places<X: Copy>(places: &[(X, f64)], points: usize) -> Vec<(X, f64)> {
    let values: Vec<f64> = places.iter().map(|place| place.1).collect();
    thinned_to(&values, points).into_iter().filter_map(|k| places.get(k)).copied().collect()
}

/// What a tick of a logarithmic axis stands for, to two digits.
pub(crate) fn power_of_ten(tick: f64) -> f64 {
    as_written(10_f64.powf(tick), 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(Span::new(0.3, 4.2).ticks(5.0), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(Span::new(-3.0, 12.0).ticks(4.0), [0.0, 5.0, 10.0]);
        assert_eq!(Span::new(-9.0, 9.0).ticks(2.0), [-5.0, 0.0, 5.0]);
        assert_eq!(Span::new(7.0, 7.0).ticks(3.0), [6.5, 7.0, 7.5]);
    }
}
