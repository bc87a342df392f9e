//! The error of each dead time, its least one, and the interval that follows from it.

use super::record::Whitened;
use super::search::{FROM_GRID, FROM_NEIGHBOUR, Fitted, at_lags, least, with_best_lags};

/// The best fit of each dead time, found where it is asked for.
pub(super) struct Profile<'a> {
    trials: &'a [Whitened],
    /// Longest dead time and longest lag, samples.
    longest: f64,
    longest_lag: f64,
    /// From a grid of lags.
    pub(super) coarse: &'a [Fitted],
    /// With the best lags, by dead time.
    pub(super) refined: Vec<Fitted>,
}

impl<'a> Profile<'a> {
    pub(super) fn new(
        trials: &'a [Whitened],
        coarse: &'a [Fitted],
        longest: f64,
        longest_lag: f64,
    ) -> Self {
        Self { trials, longest, longest_lag, coarse, refined: Vec::new() }
    }

    /// The fit with the best lags at `delay`.
    fn at(&mut self, delay: f64) -> Option<Fitted> {
        let distance = |fitted: &Fitted| (fitted.delay - delay).abs();
        let nearest =
            |all: &[Fitted]| all.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(known) = nearest(&self.refined).filter(|one| distance(one) < 1e-9) {
            return Some(known);
        }
        let starts = [(nearest(self.coarse), FROM_GRID), (nearest(&self.refined), FROM_NEIGHBOUR)];
        let tried = starts.into_iter().filter_map(|(fitted, steps)| {
            let fitted = fitted?;
            Some((at_lags(self.trials, Fitted { delay, ..fitted }, fitted.lags), steps))
        });
        let (best, steps) = tried.min_by(|a, b| a.0.error.total_cmp(&b.0.error))?;
        let best = with_best_lags(self.trials, best, self.longest_lag, steps);
        let place = self.refined.partition_point(|one| one.delay < delay);
        self.refined.insert(place, best);
        Some(best)
    }

    fn error_at(&mut self, delay: f64) -> f64 {
        self.at(delay).map_or(f64::INFINITY, |fitted| fitted.error)
    }

    /// The least error within a sample of the coarse one, to a hundredth of a sample.
    pub(super) fn least(&mut self) -> Option<Fitted> {
        const FIRST: f64 = 0.5;
        const LAST: f64 = 0.02;
        let start = least(self.coarse)?;
        let mut best = self.at(start.delay)?;
        let mut step = FIRST;
        while step > LAST {
            let sides = [best.delay - step, best.delay + step];
            let tried = sides.map(|delay| self.at(delay.clamp(0.0, self.longest)));
            match tried.iter().flatten().find(|one| one.error < best.error) {
                Some(better) => best = *better,
                None => step *= 0.5,
            }
        }
        Some(best)
    }

    /// Where the error grows to `limit` on both sides of `best`; none where it does not within
    /// the dead times that are tried. At 0 it ends.
    pub(super) fn ends(&mut self, best: Fitted, limit: f64) -> (Option<f64>, Option<f64>) {
        let low = self.end(best, limit, -1.0);
        let high = self.end(best, limit, 1.0);
        // Another dead time may fit as well.
        let others = self.coarse.iter().filter(|one| one.error <= limit).map(|one| one.delay);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        others.for_each(|delay| (least, most) = (least.min(delay), most.max(delay)));
        // Beyond the longest dead time that is tried it may fit still.
        let high = high.filter(|_| most < self.longest);
        (Some(low.unwrap_or(0.0).min(least)), high.map(|high| high.max(most)))
    }

    fn end(&mut self, best: Fitted, limit: f64, direction: f64) -> Option<f64> {
        const FIRST: f64 = 0.05;
        const HALVINGS: usize = 6;
        let (mut inside, mut step) = (best.delay, FIRST);
        let mut outside = loop {
            let next = (inside + direction * step).clamp(0.0, self.longest);
            if (next - inside).abs() < 1e-9 {
                return None;
            }
            if self.error_at(next) > limit {
                break next;
            }
            (inside, step) = (next, 2.0 * step);
        };
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(inside, outside);
            if (inside - outside).abs() < 0.01 {
                break;
            }
            if self.error_at(middle) > limit { outside = middle } else { inside = middle }
        }
        // The nearest one that is known to be too far.
        Some(outside)
    }
}
