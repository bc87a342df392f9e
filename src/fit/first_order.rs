//! The model of an output that follows its input itself and not its integral: a speed, a pressure,
//! a temperature, a servo's position. With an integrator it is a first order with dead time, by a
//! leakage of rate `1/T` toward `y0`.
//!
//! ```text
//! T y' + y = K u(t − τ) + y0
//! ```
//!
//! # References
//! Åström, K. J., and Hägglund, T., 2006, Advanced PID Control, section 2.4 (processes with
//! self-regulation).

use crate::delay::{FirstOrder, followed, tracking};
use crate::effect::{Effect as _, Leakage, RateLimit};
use crate::experiment::{Joint, Property, Record, Trial};
use crate::model::{Component, JointModel};
use crate::numerics::quantile;

/// The squared correlation of the output of `joint` with its input some samples before, where the
/// output follows the input; of where it comes to rest, where the limit of its rate hides that.
///
/// A joint that runs into its stops follows the sign of the input as well as the input, and is
/// none of these.
pub(crate) fn follows_input(joint: &Joint) -> Option<f64> {
    let by_rests = || Some(tracking(&joint.trials)?.r_squared());
    followed(&joint.trials).map(|(_, squared)| squared).or_else(by_rests)
}

/// The output of a joint that follows its input itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Follower {
    first_order: FirstOrder,
    /// The limit of its rate, output units per second, where that hides the first order.
    rate: Option<f64>,
}

impl Property for Option<Follower> {
    fn find(record: &Record) -> Self {
        Follower::shown(record).or_else(|| Follower::likely(record))
    }
}

impl Follower {
    /// How the output of a joint follows its input, or is likely to; none where it does not.
    pub(crate) fn of(record: &Record) -> Option<Self> {
        *record.property()
    }

    /// Where a fit of a first order may start, though no correlation alone shows one.
    fn likely(record: &Record) -> Option<Self> {
        Some(Self { first_order: FirstOrder::likely(record)?, rate: None })
    }

    /// As its correlation with the input shows, or where it comes to rest.
    fn shown(trials: &Record) -> Option<Self> {
        if let Some(first_order) = FirstOrder::of(trials) {
            return Some(Self { first_order, rate: None });
        }
        let tracking = tracking(trials)?;
        let periods = trials.iter().map(|trial| trial.period().seconds());
        let shortest_s = SAMPLES * periods.fold(0.0, f64::max);
        let first_order = FirstOrder {
            time_constant_s: shortest_s,
            dead_time_s: shortest_s,
            static_gain: tracking.gain(),
            at_zero: tracking.offset(),
        };
        Some(Self { first_order, rate: usual_rate(trials) })
    }

    /// `model` as this first order, and the ids of the effects that make it one.
    pub(crate) fn started_at(self, model: &JointModel) -> Option<(Vec<&'static str>, JointModel)> {
        let (id, model) = self.first_order.started_at(model)?;
        let Some(rate) = self.rate else { return Some((vec![id], model)) };
        let seconds_per_input = self.first_order.static_gain.abs() / rate;
        let component = Component::new(&RateLimit, vec![seconds_per_input.into(), 0.0.into()])?;
        Some((vec![id, RateLimit.spec().id], model.with(component)))
    }
}

/// Samples of a time constant, and of a dead time, that hardly show after a limited rate.
const SAMPLES: f64 = 3.0;

/// The rate of an output that mostly moves at its limit or rests, output units per second.
fn usual_rate(trials: &[Trial]) -> Option<f64> {
    /// Samples over which a rate is taken, and the part of them that is below the limit.
    const OVER: usize = 5;
    const BELOW: f64 = 0.95;
    let rates = trials.iter().flat_map(|trial| {
        let length_s = OVER as f64 * trial.period().seconds();
        let ways = trial.output().iter().zip(trial.output().iter().skip(OVER));
        ways.map(move |(from, to)| (to - from).abs() / length_s)
    });
    quantile(&rates.collect::<Vec<_>>(), BELOW).filter(|rate| *rate > 0.0)
}

impl FirstOrder {
    /// `model` as this first order, and the id of the effect that makes it one.
    fn started_at(self, model: &JointModel) -> Option<(&'static str, JointModel)> {
        let rate = self.time_constant_s.recip();
        let component = Component::new(&Leakage, vec![rate.into(), self.at_zero.into()])?;
        let mut model = model.with(component);
        if !model.gain.fixed {
            model.gain.value = self.static_gain * rate;
        }
        if !model.delay.fixed {
            model.delay.value = self.dead_time_s;
        }
        Some((Leakage.spec().id, model))
    }
}

/// Whether an effect is the one that makes a first order of an integrator.
pub(crate) fn makes_first_order(id: &str) -> bool {
    id == Leakage.spec().id
}

/// The time constant `T` of the first order that `model` is, seconds; none where it is none.
pub(crate) fn time_constant_s(model: &JointModel) -> Option<f64> {
    let of_first_order = |component: &&Component| makes_first_order(component.effect().spec().id);
    let leakage = model.components().iter().find(of_first_order)?;
    let rate = leakage.parameters().first()?.value;
    (rate > 0.0).then(|| rate.recip())
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
        Joint { name, input_unit: None, output_unit: None, covariates, trials: trials.into() }
    }

    const LEVELS: [f64; 8] = [0.0, 2.0, -1.0, 3.0, 1.0, -2.0, -3.0, 0.5];

    #[test]
    fn a_first_order_is_recognised_with_its_time_constant() {
        // y' = (3 u + 1 − y)/T with T = 0.1 s, sampled exactly.
        let left = (-0.01_f64 / 0.1).exp();
        let of = joint(&LEVELS, |u, y| 3.0 * u + 1.0 + (y - 3.0 * u - 1.0) * left);
        assert!(follows_input(&of).unwrap() > 0.8);
        let found = FirstOrder::of(&of.trials).unwrap();
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
        of.trials = [Trial::new("1", 0.0, trial.period(), input, late).unwrap()].into();
        let found = FirstOrder::of(&of.trials).unwrap();
        assert!((found.dead_time_s - 0.08).abs() < 0.015, "{found:?}");
        assert!((0.08..0.13).contains(&found.time_constant_s), "{found:?}");
    }

    #[test]
    fn a_time_constant_longer_than_the_holds_is_where_a_fit_starts() {
        let left = (-0.01_f64 / 2.0).exp();
        let slow = joint(&LEVELS, |u, y| 3.0 * u + (y - 3.0 * u) * left);
        assert_eq!(follows_input(&slow), None);
        let found = FirstOrder::likely(&slow.trials).unwrap();
        assert!((1.3..3.0).contains(&found.time_constant_s), "{found:?}");
        let integrator = joint(&LEVELS, |u, y| y + 0.01 * u);
        assert_eq!(FirstOrder::likely(&integrator.trials), None);
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
