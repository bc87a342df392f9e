//! The delay against what it may depend on: a point per accepted step, by its direction.

use super::panel::Place;
use crate::delay::StepState;

/// Where a step of the input goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    Down,
    Up,
}

impl Way {
    pub(crate) const BOTH: [Self; 2] = [Self::Down, Self::Up];

    pub(crate) fn of(step: &StepState) -> Self {
        if step.input_change > 0.0 { Self::Up } else { Self::Down }
    }

    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Down => "down",
            Self::Up => "up",
        }
    }
}

/// Points of all steps in one direction at which `value` is known: it, and the delay in
/// seconds.
pub(crate) fn points(
    steps: &[StepState],
    way: Way,
    value: impl Fn(&StepState) -> Option<f64>,
) -> Vec<Place> {
    let same = steps.iter().filter(|step| Way::of(step) == way);
    same.filter_map(|step| Some((value(step)?, step.delay_s))).collect()
}
