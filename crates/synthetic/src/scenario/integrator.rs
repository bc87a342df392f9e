//! How far a record is from that of an integrator with a delay.

use crate::clock::whole;
use crate::simulate::Recorded;

/// Longest delay that is tried, in seconds.
const LONGEST_S: f64 = 2.0;

/// Distance of the delays that are tried first, in seconds: below the shortest hold, so
/// that the best of them lies in the right valley.
const COARSE_S: f64 = 0.05;

/// Halvings of that distance afterwards.
const REFINEMENTS: usize = 10;

/// Root mean square of `record` less the nearest integrator, in output units.
///
/// ```text
/// y(t) = y_i + gain ∫ u(t - delay) dt      from one step of the input to the next
/// ```
///
/// with a free start `y_i` for each level, and the best gain and delay.
pub(super) fn error(record: &Recorded) -> f64 {
    let way = Way::of(&record.input, record.period_s);
    let holds = holds(&record.input);
    let error = |delay_s: f64| squared(&way, &record.output, &holds, delay_s);
    let mut best = (error(0.0), 0.0);
    let mut k = 1.0;
    while k * COARSE_S <= LONGEST_S {
        let delay_s = k * COARSE_S;
        best = lower(best, (error(delay_s), delay_s));
        k += 1.0;
    }
    let mut distance = COARSE_S;
    for _ in 0..REFINEMENTS {
        distance /= 2.0;
        for delay_s in [best.1 - distance, best.1 + distance] {
            best = lower(best, (error(delay_s.max(0.0)), delay_s.max(0.0)));
        }
    }
    (best.0 / record.output.len() as f64).sqrt()
}

fn lower(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    if b.0 < a.0 { b } else { a }
}

/// The integral of a held input.
struct Way {
    /// At each sample.
    at: Vec<f64>,
    period_s: f64,
}

impl Way {
    fn of(input: &[f64], period_s: f64) -> Self {
        let mut way = 0.0;
        let at = input.iter().map(|level| {
            let now = way;
            way += level * period_s;
            now
        });
        Self { at: at.collect(), period_s }
    }

    /// At `delay_s` before sample `index`; the first level has long been held.
    fn before(&self, index: usize, delay_s: f64) -> f64 {
        let place = index as f64 - delay_s / self.period_s;
        let below = whole(place.floor()).min(self.at.len().saturating_sub(2));
        let [from, to] = [below, below + 1].map(|k| self.at.get(k).copied().unwrap_or(0.0));
        from + (to - from) * (place - below as f64)
    }
}

/// The stretches of constant input.
fn holds(input: &[f64]) -> Vec<std::ops::Range<usize>> {
    let changed = |k: &usize| input.get(*k) != input.get(k - 1);
    let mut borders: Vec<usize> = (1..input.len()).filter(changed).collect();
    borders.insert(0, 0);
    borders.push(input.len());
    borders.windows(2).filter_map(|pair| Some(*pair.first()?..*pair.last()?)).collect()
}

/// Sum of the squared differences with the best gain.
fn squared(way: &Way, output: &[f64], holds: &[std::ops::Range<usize>], delay_s: f64) -> f64 {
    let (mut way_2, mut product, mut output_2) = (0.0, 0.0, 0.0);
    for hold in holds {
        let count = hold.len() as f64;
        let (mut x_sum, mut y_sum, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let mut first = None;
        for (index, y) in hold.clone().zip(output.get(hold.clone()).unwrap_or_default()) {
            let x = way.before(index, delay_s);
            // Away from the first values, so that the sums keep their digits.
            let (x_0, y_0) = *first.get_or_insert((x, *y));
            let (x, y) = (x - x_0, y - y_0);
            (x_sum, y_sum) = (x_sum + x, y_sum + y);
            (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        }
        way_2 += xx - x_sum * x_sum / count;
        product += xy - x_sum * y_sum / count;
        output_2 += yy - y_sum * y_sum / count;
    }
    if way_2 > 0.0 { (output_2 - product * product / way_2).max(0.0) } else { output_2 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(output: impl Fn(f64) -> f64) -> Recorded {
        let input: Vec<f64> = (0..600).map(|k| f64::from((k / 100) % 3 - 1)).collect();
        let output = (0..600).map(|k| output(f64::from(k) * 0.01)).collect();
        Recorded { input, output, period_s: 0.01, ..Recorded::default() }
    }

    /// Integral of the input of [`record`], whose first level is -1.
    fn way(t: f64) -> f64 {
        let (turns, rest) = ((t / 3.0).floor(), t.rem_euclid(3.0));
        let _ = turns;
        -rest.min(1.0) + (rest - 2.0).max(0.0)
    }

    #[test]
    fn an_integrator_with_a_delay_has_no_error() {
        let error = error(&record(|t| {
            let late = t - 0.2137;
            7.0 + 3.0 * if late < 0.0 { -late } else { way(late) }
        }));
        assert!(error < 1e-3, "{error}");
    }

    #[test]
    fn an_error_is_that_about_the_start_of_each_hold() {
        // One degree up and down within each second.
        let error = error(&record(|t| 2.0 * way(t) + (std::f64::consts::TAU * t).sin()));
        // What of the sine looks like a slope or a delay is gone.
        assert!((0.5..=0.71).contains(&error), "{error}");
    }
}
