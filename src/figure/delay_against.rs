//! The delay against what it may depend on: a point per accepted step, by its direction.

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
