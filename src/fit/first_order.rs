//! Whether an output follows its input itself and not its integral: a speed, a pressure, a
//! temperature, a servo's position. With an integrator its model is then a first order with dead
//! time, by a leakage of rate `1/T` toward `y0`.
//!
//! ```text
//! T y' + y = K u(t − τ) + y0
//! ```
//!
//! # References
//! Åström, K. J., and Hägglund, T., 2006, Advanced PID Control, section 2.4 (processes with
//! self-regulation).

use crate::effect::by_id;
use crate::experiment::{Joint, Trial};
use crate::model::{Component, JointModel};

/// Squared correlation of output and input from which the output follows the input. Chosen: of
/// measured machines, servos and speeds have 0.94 and more, angles and positions that are driven
/// by a speed 0.36 and less.
const FOLLOWS: f64 = 0.7;

/// Samples that a correlation needs.
const FEWEST: usize = 200;

/// The squared correlation of the output of `joint` with its input some samples before, where the
/// output follows the input.
///
/// A joint that runs into its stops follows the sign of the input as well as the input, and is
/// none of these.
pub(crate) fn follows_input(joint: &Joint) -> Option<f64> {
    Some(followed(joint)?.1)
}

/// The lag in samples at which the output follows the input best, and the squared correlation
/// there; none where it does not follow it.
fn followed(joint: &Joint) -> Option<(usize, f64)> {
    let samples: usize = joint.trials.iter().map(Trial::len).sum();
    if samples < FEWEST {
        return None;
    }
    let best = |of: fn(f64) -> f64| {
        let tried = lags(joint).map(|lag| (lag, correlation(joint, lag, of)));
        tried.max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let follows = best(|input| input).filter(|(_, squared)| *squared >= FOLLOWS)?;
    (follows.1 > best(sign)?.1).then_some(follows)
}

/// Samples that the output may lag behind.
fn lags(joint: &Joint) -> impl Iterator<Item = usize> + use<> {
    /// Longest lag as a part of the shortest trial, and each lag of the one before.
    const PART: usize = 10;
    const RATIO: f64 = 1.25;
    let longest = joint.trials.iter().map(Trial::len).min().unwrap_or(0) / PART;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small, above 0")]
    let next = |lag: &usize| Some((*lag as f64 * RATIO) as usize + 1);
    std::iter::successors(Some(0), next).take_while(move |lag| *lag <= longest)
}

/// Squared correlation of the output with what `of` makes of the input `lag` samples before.
fn correlation(joint: &Joint, lag: usize, of: fn(f64) -> f64) -> f64 {
    let mut sums = Moments::default();
    for trial in &joint.trials {
        let behind = trial.output().get(lag..).unwrap_or_default();
        trial.input().iter().zip(behind).for_each(|(input, output)| sums.push(of(*input), *output));
    }
    sums.r_squared()
}

fn sign(input: f64) -> f64 {
    if input == 0.0 { 0.0 } else { input.signum() }
}

/// A first order `T y' + y = K u(t − τ) + y0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FirstOrder {
    time_constant_s: f64,
    dead_time_s: f64,
    static_gain: f64,
    at_zero: f64,
}

impl FirstOrder {
    /// The one that follows the output of `joint` best; none where the output does not follow the
    /// input.
    pub(crate) fn of(joint: &Joint) -> Option<Self> {
        /// Time constants: the shortest in sample periods, each of the one before, and how many.
        const SHORTEST: f64 = 2.0;
        const RATIO: f64 = 1.5;
        const COUNT: usize = 16;
        // The whole lag is a dead time and the time constant behind it.
        let (longest, _) = followed(joint)?;
        let dead = || lags(joint).take_while(|lag| *lag <= longest);
        let periods = joint.trials.iter().map(|trial| trial.period().seconds());
        let period_s = periods.fold(0.0, f64::max);
        let times = std::iter::successors(Some(SHORTEST * period_s), |time| Some(RATIO * time));
        let pairs = times.take(COUNT).flat_map(|time_s| dead().map(move |lag| (time_s, lag)));
        let tried = pairs.map(|(time_s, lag)| (time_s, lag, lagging(joint, time_s, lag)));
        let best = tried.max_by(|a, b| a.2.r_squared().total_cmp(&b.2.r_squared()));
        let (time_constant_s, lag, sums) = best?;
        let (static_gain, at_zero) = sums.line();
        Some(Self { time_constant_s, dead_time_s: lag as f64 * period_s, static_gain, at_zero })
    }

    /// Where the output settles at `input`.
    pub(crate) fn settled_at(&self, input: f64) -> f64 {
        self.at_zero + self.static_gain * input
    }

    /// Seconds after which the output has settled to 5 %.
    pub(crate) fn settling_s(&self) -> f64 {
        /// Time constants: ln 20.
        const CONSTANTS: f64 = 3.0;
        self.dead_time_s + CONSTANTS * self.time_constant_s
    }

    /// `model` as this first order, and the id of the effect that makes it one.
    pub(crate) fn started_at(self, model: &JointModel) -> Option<(&'static str, JointModel)> {
        let leakage = by_id("leakage")?;
        let rate = self.time_constant_s.recip();
        let component = Component::new(leakage, vec![rate.into(), self.at_zero.into()])?;
        let mut model = model.with(component);
        if !model.gain.fixed {
            model.gain.value = self.static_gain * rate;
        }
        if !model.delay.fixed {
            model.delay.value = self.dead_time_s;
        }
        Some((leakage.spec().id, model))
    }
}

/// How the output goes with the input `dead` samples before, behind a lag of the first order.
fn lagging(joint: &Joint, time_s: f64, dead: usize) -> Moments {
    let mut sums = Moments::default();
    for trial in &joint.trials {
        let left = (-trial.period().seconds() / time_s).exp();
        let mut state = trial.input().first().copied().unwrap_or(0.0);
        let behind = trial.output().get(dead..).unwrap_or_default();
        for (input, output) in trial.input().iter().zip(behind) {
            sums.push(state, *output);
            state = input + (state - input) * left;
        }
    }
    sums
}

/// Means, variances and covariance of pairs, updated one by one.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    count: f64,
    mean: (f64, f64),
    /// Sums of squares and of products about the means.
    xx: f64,
    yy: f64,
    xy: f64,
}

impl Moments {
    /// Welford's update; pairs that are not numbers are left out.
    fn push(&mut self, x: f64, y: f64) {
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        self.count += 1.0;
        let (dx, dy) = (x - self.mean.0, y - self.mean.1);
        self.mean.0 += dx / self.count;
        self.mean.1 += dy / self.count;
        self.xx += dx * (x - self.mean.0);
        self.yy += dy * (y - self.mean.1);
        self.xy += dx * (y - self.mean.1);
    }

    fn r_squared(&self) -> f64 {
        let scale = self.xx * self.yy;
        if scale > 0.0 { self.xy * self.xy / scale } else { 0.0 }
    }

    /// Slope and intercept of the regression of the second on the first.
    fn line(&self) -> (f64, f64) {
        let slope = if self.xx > 0.0 { self.xy / self.xx } else { 0.0 };
        (slope, self.mean.1 - slope * self.mean.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    /// The output of `next`, from the input and the output before, at levels held 1 s.
    fn joint(levels: &[f64], next: impl Fn(f64, f64) -> f64) -> Joint {
        let input: Vec<f64> = levels.iter().flat_map(|level| [*level; 100]).collect();
        let mut y = 0.0;
        let step = |u: &f64| {
            let now = y;
            y = next(*u, y);
            now
        };
        let output = input.iter().map(step).collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let trials = vec![Trial::new("1", 0.0, period, input, output).unwrap()];
        let (name, covariates) = ("motor".to_owned(), Vec::new());
        Joint { name, input_unit: None, output_unit: None, covariates, trials }
    }

    const LEVELS: [f64; 8] = [0.0, 2.0, -1.0, 3.0, 1.0, -2.0, -3.0, 0.5];

    #[test]
    fn a_first_order_is_recognised_with_its_time_constant() {
        // y' = (3 u + 1 − y)/T with T = 0.1 s, sampled exactly.
        let left = (-0.01_f64 / 0.1).exp();
        let of = joint(&LEVELS, |u, y| 3.0 * u + 1.0 + (y - 3.0 * u - 1.0) * left);
        assert!(follows_input(&of).unwrap() > 0.8);
        let found = FirstOrder::of(&of).unwrap();
        assert!((0.08..0.13).contains(&found.time_constant_s), "{found:?}");
        assert!((found.at_zero - 1.0).abs() < 0.3, "{found:?}");
        assert!((found.static_gain - 3.0).abs() < 0.3, "{found:?}");
    }

    #[test]
    fn a_dead_time_is_told_from_the_time_constant() {
        let left = (-0.01_f64 / 0.1).exp();
        let mut of = joint(&LEVELS, |u, y| 3.0 * u + (y - 3.0 * u) * left);
        let trial = &of.trials[0];
        let late: Vec<f64> =
            [0.0; 8].into_iter().chain(trial.output().iter().copied()).take(trial.len()).collect();
        let input = trial.input().to_vec();
        of.trials = vec![Trial::new("1", 0.0, trial.period(), input, late).unwrap()];
        let found = FirstOrder::of(&of).unwrap();
        assert!((found.dead_time_s - 0.08).abs() < 0.015, "{found:?}");
        assert!((0.08..0.13).contains(&found.time_constant_s), "{found:?}");
    }

    #[test]
    fn an_integrator_and_a_joint_that_runs_into_its_stops_do_not_follow_their_input() {
        assert_eq!(follows_input(&joint(&LEVELS, |u, y| y + 0.01 * u)), None);
        let stops = joint(&LEVELS, |u, y| (y + 0.5 * u).clamp(-10.0, 10.0));
        assert_eq!(follows_input(&stops), None);
        // Two levels cannot tell the one from the other.
        let relay = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0];
        assert_eq!(follows_input(&joint(&relay, |u, y| y + 0.05 * (u - y))), None);
        assert_eq!(follows_input(&joint(&[1.0], |u, _| u)), None);
    }
}
