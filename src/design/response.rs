//! What a model says of the joint's response: how long it takes, and where it rests.

use super::predict::TestRig;
use super::schedule::{Hold, Schedule, samples_in};
use crate::effect::Stage;
use crate::model::{Component, JointModel};
use crate::numerics::halved;

/// Seconds in which a joint of this kind has its speed.
const SETTLED_S: f64 = 3.0;

/// Seconds from a step of the input from zero to `level` until the speed is within 5 % of
/// what it comes to, the delay included.
///
/// Effects of load and output, which change the speed as the joint moves, are left out.
pub(crate) fn response_s(model: &JointModel, rig: &TestRig, level: f64) -> f64 {
    /// A speed that is as near is settled.
    const NEAR: f64 = 0.05;
    let speeds = speeds(&driven(model), rig, level);
    let end = speeds.last().copied().unwrap_or_default();
    let settled = |speed: &f64| (speed - end).abs() <= NEAR * end.abs();
    let last = speeds.iter().rposition(|speed| !settled(speed)).map_or(0, |last| last + 1);
    (last as f64 * rig.period.seconds()).max(model.delay.value)
}

/// The inputs between which the joint rests, where that is more than `largest / 100` wide.
pub(crate) fn resting_band(model: &JointModel, rig: &TestRig, largest: f64) -> Option<(f64, f64)> {
    /// A narrower band is none.
    const LEAST: f64 = 0.01;
    let model = driven(model);
    let edge = |largest: f64| edge(&model, rig, largest);
    // The edge of each direction by itself: a band need not lie about zero.
    let (lower, upper) = (-edge(-largest), edge(largest));
    (upper - lower > LEAST * largest).then_some((lower, upper))
}

/// The largest magnitude of the input in the direction of `largest` at which the joint rests.
fn edge(model: &JointModel, rig: &TestRig, largest: f64) -> f64 {
    /// Of the speed at the largest input: less is rest.
    const REST: f64 = 0.01;
    const HALVINGS: usize = 12;
    let speed = |level: f64| speeds(model, rig, level).last().copied().unwrap_or_default();
    let at_most = REST * speed(largest).abs();
    let (rests, _) = halved((0.0, 1.0), HALVINGS, |part| speed(part * largest).abs() <= at_most);
    // An edge at zero is found a little above it, and one of a straight line at the limit.
    if rests <= 2.0 * REST { 0.0 } else { rests * largest.abs() }
}

/// The speed at each sample after a step from rest to `level`.
fn speeds(model: &JointModel, rig: &TestRig, level: f64) -> Vec<f64> {
    let samples = samples_in(SETTLED_S + model.delay.value, rig.period);
    let holds = vec![Hold { level: 0.0, samples: 1 }, Hold { level, samples }];
    let output = rig.output(model, &Schedule::new(rig.period, holds));
    let period_s = rig.period.seconds();
    let speed = |pair: &[f64]| match pair {
        [a, b] => (b - a) / period_s,
        _ => 0.0,
    };
    output.get(1..).unwrap_or_default().windows(2).map(speed).collect()
}

/// `model` without its effects of load and output.
fn driven(model: &JointModel) -> JointModel {
    let is_behind = |component: &&Component| {
        matches!(component.effect().spec().stage, Stage::Load | Stage::Output)
    };
    let behind: Vec<_> = model.components().iter().filter(is_behind).collect();
    behind.iter().fold(model.clone(), |model, c| model.without(c.effect().spec().id))
}

#[cfg(test)]
mod tests {
    use super::super::predict::tests::rig;
    use super::*;
    use crate::effect::{ActuatorLag, DeadBand, EndStop};

    #[test]
    fn a_response_is_delay_and_three_time_constants() {
        let lag = Component::new(&ActuatorLag, vec![0.2.into()]).unwrap();
        let stops = Component::new(&EndStop, vec![(-1.0).into(), 1.0.into()]).unwrap();
        let plain = JointModel::integrator(10.0, 0.15).with(stops);
        assert!((response_s(&plain, &rig(None), 1.0) - 0.15).abs() < 0.011);
        let found = response_s(&plain.with(lag), &rig(None), 1.0);
        // ln 20 = 2.996 time constants.
        assert!((found - 0.15 - 0.6).abs() < 0.02, "{found}");
    }

    #[test]
    fn a_joint_rests_in_its_dead_band() {
        let band = Component::new(&DeadBand, vec![(-0.4).into(), 0.6.into()]).unwrap();
        let model = JointModel::integrator(10.0, 0.15).with(band);
        let (lower, upper) = resting_band(&model, &rig(None), 2.0).unwrap();
        assert!((lower + 0.4).abs() < 0.03 && (upper - 0.6).abs() < 0.03, "{lower} {upper}");
        assert_eq!(resting_band(&JointModel::integrator(10.0, 0.1), &rig(None), 2.0), None);
    }
}
