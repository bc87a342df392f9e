//! Levels and holds that suit a joint.

use super::predict::TestRig;
use super::response::{response_s, resting_band};
use crate::explain::two_digits;
use crate::model::JointModel;

/// Largest level where nothing is known of the joint.
const LARGEST: f64 = 2.0;

/// The largest level for a joint: three times the end of its dead band, and no less than for a
/// joint of which nothing is known.
pub(crate) fn default_largest(model: Option<&JointModel>, rig: &TestRig) -> f64 {
    const TIMES_EDGE: f64 = 3.0;
    let band = model.and_then(|model| resting_band(model, rig, 2.0 * LARGEST));
    let edge = band.map_or(0.0, |(lower, upper)| upper.max(-lower));
    two_digits(LARGEST.max(TIMES_EDGE * edge))
}

/// Rest, a full and a middle level of either sign: with a model the middle lies between the end
/// of its dead band and the full level.
pub(crate) fn default_levels(model: Option<&JointModel>, rig: &TestRig, largest: f64) -> Vec<f64> {
    let band = model.and_then(|model| resting_band(model, rig, largest));
    let (lower, upper) = band.unwrap_or((0.0, 0.0));
    let middle = |edge: f64| two_digits(0.5 * (edge + largest));
    vec![-largest, -middle(-lower), 0.0, middle(upper), largest]
}

/// Longest hold over the shortest, as in the paper's records.
const LONGEST: f64 = 2.5;

/// Shorter holds leave too few samples for two lines.
const SHORTEST_S: f64 = 0.5;

/// Shortest and longest hold of an output that regulates itself, in `settling_s`: each level is
/// seen to settle.
pub(super) fn settling_hold_s(settling_s: f64) -> (f64, f64) {
    let shortest = two_digits(settling_s.max(SHORTEST_S));
    (shortest, two_digits(LONGEST * shortest))
}

/// Shortest and longest hold: with a model longer than it takes the joint to respond, so that
/// no level overtakes the one before and each is seen for as long again.
pub(crate) fn default_hold_s(
    model: Option<&JointModel>,
    rig: &TestRig,
    largest: f64,
) -> (f64, f64) {
    let Some(model) = model else { return (1.0, LONGEST) };
    let shortest = two_digits((2.0 * response_s(model, rig, largest)).max(SHORTEST_S));
    (shortest, two_digits(LONGEST * shortest))
}

#[cfg(test)]
mod tests {
    use super::super::predict::tests::rig;
    use super::*;
    use crate::effect::{ActuatorLag, DeadBand};
    use crate::model::Component;

    fn banded() -> JointModel {
        let band = Component::new(&DeadBand, vec![(-0.8).into(), 1.0.into()]).unwrap();
        JointModel::integrator(10.0, 0.2).with(band)
    }

    #[test]
    fn levels_lie_beyond_the_dead_band() {
        let rig = rig(None);
        assert_eq!(default_levels(None, &rig, 2.0), [-2.0, -1.0, 0.0, 1.0, 2.0]);
        let largest = default_largest(Some(&banded()), &rig);
        assert!((2.9..3.3).contains(&largest), "{largest}");
        let levels = default_levels(Some(&banded()), &rig, 3.0);
        assert_eq!(levels, [-3.0, -1.9, 0.0, 2.0, 3.0]);
    }

    #[test]
    fn holds_are_longer_than_the_response() {
        let rig = rig(None);
        assert_eq!(default_hold_s(None, &rig, 2.0), (1.0, 2.5));
        let lag = Component::new(&ActuatorLag, vec![0.3.into()]).unwrap();
        let (shortest, longest) = default_hold_s(Some(&banded().with(lag)), &rig, 3.0);
        assert!(shortest > 2.0 * (0.2 + 0.9) - 0.1 && longest > 2.0 * shortest);
    }
}
