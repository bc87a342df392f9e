//! A joint whose output settles at a level that follows the input: a speed, a pressure, a
//! temperature. It begins as a first order with dead time instead of an integrator.
//!
//! ```text
//! T y' + y = K u(t − τ) + y0
//! ```
//!
//! As the models here are integrators, it is one of gain `K/T` with a leakage of rate `1/T`
//! toward `y0`.
//!
//! # References
//! Åström, K. J., and Hägglund, T., 2006, Advanced PID Control, section 2.4 (processes with
//! self-regulation; the time constant by the area above the step response).

use super::{Component, JointModel};
use crate::effect::by_id;
use crate::experiment::{Joint, Trial};
use crate::numerics::median;

/// How an output settles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Settling {
    /// Output per input where it has settled.
    pub(crate) static_gain: f64,
    /// Output where it has settled without input.
    pub(crate) at_zero: f64,
    /// Time constant in seconds, the dead time included.
    pub(crate) time_s: f64,
    /// Levels of the input that were held so long that the output settled.
    pub(crate) holds: usize,
    /// Share of the variance of the settled outputs that the straight line explains.
    pub(crate) r_squared: f64,
}

impl Settling {
    /// The first order with this dead time in seconds.
    pub(super) fn first_order(&self, joint: &Joint, delay_s: f64) -> Option<JointModel> {
        /// Shortest time constant in sample periods: shorter ones are not seen.
        const SHORTEST: f64 = 2.0;
        let periods = joint.trials.iter().map(|trial| trial.period().seconds());
        let shortest = SHORTEST * periods.fold(0.0, f64::max);
        let rate = 1.0 / (self.time_s - delay_s).max(shortest);
        let leakage = vec![rate.into(), self.at_zero.into()];
        let leakage = Component::new(by_id("leakage")?, leakage)?;
        Some(JointModel::integrator(self.static_gain * rate, delay_s).with(leakage))
    }
}

/// An input that is held.
struct Hold {
    level: f64,
    /// Mean output in the last fifth of it, and in the fifth before.
    end: f64,
    before_end: f64,
    /// The output of each sample, and what lies between two samples in seconds.
    output: Vec<f64>,
    period_s: f64,
}

/// Fewest samples of a hold: a fifth of them is a mean.
const SHORTEST: usize = 20;

/// Fewest holds, and fewest different levels of them: a line through two is no evidence.
const FEWEST: (usize, usize) = (6, 3);

/// What the output moves at the end of the holds, at most, in parts of how the ends scatter.
const STILL: f64 = 0.03;

/// Share of the variance from which settled outputs follow the level.
const FOLLOWS: f64 = 0.9;

/// How the output of `joint` settles; none where it goes on moving while the input is held, or
/// rests at ends that have nothing to do with the level.
pub(crate) fn settling(joint: &Joint) -> Option<Settling> {
    let trials: Vec<Vec<Hold>> = joint.trials.iter().map(holds).collect();
    let holds = || trials.iter().flatten();
    let (fewest_holds, fewest_levels) = FEWEST;
    let count = holds().count();
    if count < fewest_holds || levels(holds()) < fewest_levels {
        return None;
    }
    let scatter = variance(holds().map(|hold| hold.end));
    let moved = holds().map(|hold| (hold.end - hold.before_end).powi(2)).sum::<f64>();
    if scatter <= 0.0 || moved / count as f64 > STILL.powi(2) * scatter {
        return None;
    }
    let (static_gain, at_zero, left) = line(holds().map(|hold| (hold.level, hold.end)));
    // A joint that runs into its stops settles, too: where, the sign of the input says.
    let (_, _, by_sign) = line(holds().map(|hold| (sign(hold.level), hold.end)));
    let r_squared = 1.0 - left / scatter;
    if r_squared < FOLLOWS || left > 0.5 * by_sign {
        return None;
    }
    let times = trials.iter().flat_map(|holds| holds.windows(2).filter_map(response_s));
    let time_s = median(&times.collect::<Vec<_>>())?;
    (time_s > 0.0).then_some(Settling { static_gain, at_zero, time_s, holds: count, r_squared })
}

/// The holds of a trial.
fn holds(trial: &Trial) -> Vec<Hold> {
    let (output, period_s) = (trial.output(), trial.period().seconds());
    let mut start = 0;
    let hold = |same: &[f64]| {
        let held = output.get(start..start + same.len())?;
        start += same.len();
        let fifth = same.len() / 5;
        let (rest, end) = held.split_at(held.len() - fifth);
        let before_end = rest.get(rest.len() - fifth..)?;
        (same.len() >= SHORTEST).then(|| Hold {
            level: same[0],
            end: mean(end),
            before_end: mean(before_end),
            output: held.to_vec(),
            period_s,
        })
    };
    #[expect(clippy::float_cmp, reason = "a step is any change")]
    let runs = trial.input().chunk_by(|a, b| a == b);
    runs.map(hold).collect::<Vec<_>>().into_iter().flatten().collect()
}

/// The area above the response to a step, in parts of its height: time constant and dead time.
fn response_s(pair: &[Hold]) -> Option<f64> {
    let [before, after] = pair else { return None };
    let height = after.end - before.end;
    let above: f64 = after.output.iter().map(|output| (after.end - output) / height).sum();
    let response_s = above * after.period_s;
    (response_s.is_finite() && response_s > 0.0).then_some(response_s)
}

/// How many levels differ by more than a part of all.
fn levels<'a>(holds: impl Iterator<Item = &'a Hold>) -> usize {
    /// Levels that are nearer are one, in parts of the range.
    const ALIKE: f64 = 0.02;
    let mut levels: Vec<f64> = holds.map(|hold| hold.level).collect();
    levels.sort_by(f64::total_cmp);
    let range = levels.last().unwrap_or(&0.0) - levels.first().unwrap_or(&0.0);
    levels.dedup_by(|b, a| *b - *a <= ALIKE * range);
    levels.len()
}

fn sign(level: f64) -> f64 {
    if level == 0.0 { 0.0 } else { level.signum() }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean square about the mean.
fn variance(values: impl Iterator<Item = f64> + Clone) -> f64 {
    line(values.map(|value| (0.0, value))).2
}

/// Slope and intercept of the regression line, and the mean square that it leaves.
fn line(points: impl Iterator<Item = (f64, f64)> + Clone) -> (f64, f64, f64) {
    let count = points.clone().count() as f64;
    let sums = points.clone().fold((0.0, 0.0), |(x, y), point| (x + point.0, y + point.1));
    let (x_mean, y_mean) = (sums.0 / count, sums.1 / count);
    let products = points.clone().map(|(x, y)| ((x - x_mean) * (y - y_mean), (x - x_mean).powi(2)));
    let (with, square) = products.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let slope = if square > 0.0 { with / square } else { 0.0 };
    let intercept = y_mean - slope * x_mean;
    let left = points.map(|(x, y)| (y - intercept - slope * x).powi(2)).sum::<f64>() / count;
    (slope, intercept, left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    /// The output of `next`, from the input and the output before, at levels held 2 s.
    fn joint(levels: &[f64], next: impl Fn(f64, f64) -> f64) -> Joint {
        let input: Vec<f64> = levels.iter().flat_map(|level| [*level; 200]).collect();
        let mut y = 0.0;
        let step = |u: &f64| {
            let now = y;
            y = next(*u, y);
            now
        };
        let output = input.iter().map(step).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, period, input, output).unwrap();
        let trials = vec![trial];
        let (name, covariates) = ("motor".to_owned(), Vec::new());
        Joint { name, input_unit: None, output_unit: None, covariates, trials }
    }

    const LEVELS: [f64; 8] = [0.0, 2.0, -1.0, 3.0, 1.0, -2.0, -3.0, 0.5];

    #[test]
    fn a_first_order_is_recognised_with_its_time_constant_and_gain() {
        let of = joint(&LEVELS, |u, y| y + 0.05 * (3.0 * u + 1.0 - y));
        let found = settling(&of).unwrap();
        assert!((found.static_gain - 3.0).abs() < 0.01, "{found:?}");
        assert!((found.at_zero - 1.0).abs() < 0.01, "{found:?}");
        assert!((found.time_s - 0.2).abs() < 0.01, "{found:?}");
        assert_eq!(found.holds, 8);
    }

    #[test]
    fn an_integrator_and_a_joint_that_runs_into_its_stops_are_not_taken_for_one() {
        assert_eq!(settling(&joint(&LEVELS, |u, y| y + 0.05 * u)), None);
        assert_eq!(settling(&joint(&LEVELS, |u, y| (y + 0.5 * u).clamp(-10.0, 10.0))), None);
        // Too few levels show nothing.
        let relay = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0];
        assert_eq!(settling(&joint(&relay, |u, y| y + 0.05 * (u - y))), None);
    }
}
