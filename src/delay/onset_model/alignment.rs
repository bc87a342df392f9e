//! About which delay all onsets of a joint have, before anything is known of its response.
//!
//! For each common delay `d` every window has a broken line whose corner is `d` after its step,
//! and a straight line. What the corners gain over all windows is their likelihood ratio,
//!
//! ```text
//! L(d) = Σ n ln(SSE of the line / SSE of the broken line) / Σ n
//! ```
//!
//! from sums over the record, whatever its length; a delay may be negative, or longer than holds.

use super::windows::{Pass, Run};
use crate::units::{ceil_to_index, floor_to_index};

/// A common delay in samples, and `L`.
pub(super) type Alignment = (f64, f64);

/// Delays in a hold that are compared.
const PER_HOLD: f64 = 60.0;

/// The longest delay that is looked for usually, and the longest lead, in holds.
pub(super) const LONGEST: f64 = 6.0;
const LEAD: f64 = 1.0;

/// Part of the largest gain from which another shows as well (chosen).
const ALIKE: f64 = 0.97;

/// Part of the windows that must be in the record at a delay.
const MOST: f64 = 0.6;

/// The delays at which `L` has its maxima, the largest first, of those alike the
/// nearest; `longest` is the
/// longest delay in holds.
pub(super) fn alignments(runs: &[Run], hold: f64, longest: f64, pass: &Pass) -> Vec<Alignment> {
    let sums: Vec<Sums> = runs.iter().map(|run| Sums::of(&run.output)).collect();
    let by = (hold / PER_HOLD).floor().max(1.0);
    let count = floor_to_index((longest + LEAD) * hold / by);
    let first = -((LEAD * hold / by).floor() * by);
    let curve: Vec<(f64, f64, f64)> = (0..=count)
        .map(|k| {
            let delay = first + k as f64 * by;
            let (gain, used) = gain(runs, &sums, delay, pass);
            (delay, gain, used)
        })
        .collect();
    let most = curve.iter().map(|(_, _, used)| *used).fold(0.0, f64::max);
    let curve: Vec<Alignment> = curve
        .into_iter()
        .filter(|(_, _, used)| *used > 0.0 && *used >= MOST * most)
        .map(|(delay, gain, _)| (delay, gain))
        .collect();
    let is_top = |k: &usize| {
        let near = k.saturating_sub(2)..(k + 3).min(curve.len());
        curve[near].iter().all(|(_, gain)| *gain <= curve[*k].1)
    };
    let mut tops: Vec<Alignment> =
        (0..curve.len()).filter(is_top).map(|index| curve[index]).collect();
    let most = tops.iter().map(|(_, gain)| *gain).fold(f64::NEG_INFINITY, f64::max);
    // Where holds are equally long a delay shows as well a few holds later: the nearest counts.
    let rank = |(delay, gain): &Alignment| -> (f64, f64) {
        if *gain >= ALIKE * most { (0.0, delay.abs()) } else { (1.0, -gain) }
    };
    tops.sort_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    tops
}

/// `L` at a delay, and the windows that it is of.
fn gain(runs: &[Run], sums: &[Sums], delay: f64, pass: &Pass) -> (f64, f64) {
    /// Samples on each side of a corner at least.
    const FEWEST: usize = 4;
    let (mut gain, mut samples, mut used) = (0.0, 0.0, 0.0);
    for (run, sums) in runs.iter().zip(sums) {
        let positions: Vec<f64> = run.steps.iter().map(|step| step.at + delay).collect();
        for (index, position) in positions.iter().enumerate() {
            if *position < 0.0 {
                continue;
            }
            let (start, end) = pass.window(run, &positions, index);
            let corner = ceil_to_index(*position);
            if corner < start + FEWEST || corner + FEWEST > end {
                continue;
            }
            let n = (end - start) as f64;
            let floor = n * (pass.noise * pass.noise).max(f64::MIN_POSITIVE);
            let (line, broken) = sums.errors(start, corner, end);
            gain += n * (line.max(floor) / broken.max(floor)).ln();
            samples += n;
            used += 1.0;
        }
    }
    (if samples > 0.0 { gain / samples } else { f64::NEG_INFINITY }, used)
}

/// Sums of the output, of its products with the index, and of its squares, before each sample.
struct Sums {
    y: Vec<f64>,
    ty: Vec<f64>,
    yy: Vec<f64>,
}

impl Sums {
    fn of(output: &[f64]) -> Self {
        let mean = output.iter().sum::<f64>() / (output.len() as f64).max(1.0);
        let running = |value: &dyn Fn(usize, f64) -> f64| {
            let mut sum = 0.0;
            let added = output.iter().enumerate().map(|(k, y)| {
                sum += value(k, y - mean);
                sum
            });
            std::iter::once(0.0).chain(added).collect::<Vec<f64>>()
        };
        Self {
            y: running(&|_, y| y),
            ty: running(&|k, y| k as f64 * y),
            yy: running(&|_, y| y * y),
        }
    }

    /// The squared errors of a line, and of a line that breaks at `corner`, over `start..end`.
    fn errors(&self, start: usize, corner: usize, end: usize) -> (f64, f64) {
        // Σ y and Σ (t − k) y from k on.
        let behind = |k: usize| {
            let y = self.y[end] - self.y[k];
            (y, self.ty[end] - self.ty[k] - k as f64 * y)
        };
        let powers = |n: f64| (n, n * (n - 1.0) / 2.0, n * (n - 1.0) * (2.0 * n - 1.0) / 6.0);
        let (n, t, tt) = powers((end - start) as f64);
        let (_, ramp, square) = powers((end - corner) as f64);
        let ramp_t = square + (corner - start) as f64 * ramp;
        let det = n * tt - t * t;
        let solve = |a: f64, b: f64| ((tt * a - t * b) / det, (n * b - t * a) / det);
        let ((y, ty), (_, ramp_y)) = (behind(start), behind(corner));
        let (level, slope) = solve(y, ty);
        let line = (self.yy[end] - self.yy[start] - level * y - slope * ty).max(0.0);
        let (a, b) = solve(ramp, ramp_t);
        let own = square - a * ramp - b * ramp_t;
        let gained = ramp_y - level * ramp - slope * ramp_t;
        let broken = if own > 1e-9 * square { line - gained * gained / own } else { line };
        (line, broken.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::super::dynamics::Before;
    use super::super::response::response_of;
    use super::super::shape::{Shape, Shapes};
    use super::super::windows::Step;
    use super::*;
    use crate::delay::neutral::Transition;
    use crate::numerics::testing::uniform;

    /// An integrator that reacts `delay` samples late.
    fn run(delay: f64) -> Run {
        let mut random = uniform(5);
        let (mut at, mut before, mut steps) = (40.0, 0.0, Vec::new());
        for _ in 0..20 {
            let after = 4.0 * random();
            steps.push(Step {
                kind: Transition::Change,
                at,
                before,
                after,
                first: 0.0,
                end: 2000.0,
                latest: 2000.0,
                rests: false,
            });
            before = after;
            at += (60.0 + 60.0 * random()).floor();
        }
        let value = |k: usize| {
            let ramp = |step: &Step| step.change() * (k as f64 - step.at - delay).max(0.0);
            steps.iter().map(ramp).sum::<f64>() + 0.01 * random()
        };
        Run { output: (0..1500).map(value).collect(), steps, is_window: false }
    }

    #[test]
    fn a_delay_a_lead_and_one_beyond_the_holds_are_found() {
        for delay in [-17.0, 0.0, 12.0, 150.0] {
            let (shape, before) = (Shape::BEND, Before::Any);
            let response = response_of(&shape, 45.0, 182);
            let (responses, shapes) = (vec![(shape, response)], Shapes::shared(shape));
            let pass = Pass { responses, shapes, reach: 90, typical: 0.0, noise: 0.005, before };
            let found = alignments(&[run(delay)], 60.0, LONGEST, &pass);
            assert!((found[0].0 - delay).abs() <= 1.0, "{delay}: {found:?}");
        }
    }
}
