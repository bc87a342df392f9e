//! What is stated of an effect that a plant can hide.

use crate::clock::Clock;
use crate::delay_law::Occasion;
use crate::error::Rule;

/// Where an effect acts; the signal passes the stages in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// On the delay of each step.
    Delay,
    /// On the command of the valve, in input units, with time.
    Spool,
    /// On the opening of the valve at a held level, in input units.
    Valve,
    /// On how the speed follows the opening, in input units.
    Dynamics,
    /// On the speed, in output units per second, before the load.
    Speed,
    /// On the speed, by what the joint moves and where it is.
    Load,
    /// On the angle as it is measured, in output units.
    Sensor,
}

/// What an effect sees of its joint beside the signal.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct At {
    /// Seconds since the first sample.
    pub(crate) time_s: f64,
    /// Angle of the joint, in output units.
    pub(crate) angle: f64,
    /// Length of a time step in seconds.
    pub(crate) substep_s: f64,
    /// Radians in an angle of one output unit.
    pub(crate) radians: f64,
    /// Width of the rounded corners, in input units.
    pub(crate) edge: f64,
    /// Their width in output units per second.
    pub(crate) speed_edge: f64,
    /// Direction of motion: 1 or -1 where the valve is far enough open to move the joint, 0
    /// where it sticks.
    pub(crate) direction: f64,
    /// Demand of the other joints, 0 to 1.
    pub(crate) others: f64,
}

/// The numbers of an effect in the order of its keys, then zeros.
pub(crate) type Numbers = [f64; 7];

/// What moves or remembers in an effect; those that it does not need stay zero.
pub(crate) type States = [f64; 4];

/// An effect that a plant can hide.
#[derive(Debug)]
pub(crate) struct Twin {
    pub(crate) name: &'static str,
    pub(crate) stage: Stage,
    /// Keys of its numbers in a plant file.
    pub(crate) keys: &'static [&'static str],
    /// What each number may be.
    pub(super) allowed: &'static [Rule],
    /// The last numbers, where a file leaves them out.
    pub(super) optional: &'static [f64],
    /// What a number may be beside another one: the index of the one that is not, and what is
    /// allowed.
    pub(super) related: fn(&Numbers, &Clock) -> Option<(usize, &'static str)>,
    /// An effect that does not act beside it.
    pub(super) instead_of: Option<&'static str>,
    /// Puts the states where a signal that is long held has brought them; the signal after.
    pub(crate) settle: fn(&Numbers, f64, &At, &mut States) -> f64,
    /// The signal after an effect with these numbers, for the signal before it and the states
    /// of the effect; the last is where the derivatives of the states go.
    pub(crate) act: fn(&Numbers, f64, &At, &States, &mut States) -> f64,
    /// Direction of motion at a level of the valve, 0 at rest, where it was the last one before.
    pub(crate) direction: Option<fn(&Numbers, f64, f64) -> f64>,
    /// Seconds that it adds to the delay of a step.
    pub(crate) delay_s: fn(&Numbers, &Occasion) -> f64,
    /// Seconds that it adds at most.
    pub(crate) longest_delay_s: fn(&Numbers) -> f64,
    /// Its numbers in a scenario.
    pub(crate) drawn: fn(&Draw) -> Vec<f64>,
}

impl Twin {
    /// An effect that does nothing yet.
    pub(super) const fn new(
        name: &'static str,
        stage: Stage,
        keys: &'static [&'static str],
        allowed: &'static [Rule],
    ) -> Self {
        Self {
            name,
            stage,
            keys,
            allowed,
            optional: &[],
            related: |_, _| None,
            instead_of: None,
            settle: |_, signal, _, _| signal,
            act: |_, signal, _, _, _| signal,
            direction: None,
            delay_s: |_, _| 0.0,
            longest_delay_s: |_| 0.0,
            drawn: |_| Vec::new(),
        }
    }
}

/// The states of lags, which in the end are the signal.
pub(super) fn followed(_: &Numbers, signal: f64, _: &At, states: &mut States) -> f64 {
    states.fill(signal);
    signal
}

/// The second number must be above the first.
pub(super) fn rises(&[from, to, ..]: &Numbers, _: &Clock) -> Option<(usize, &'static str)> {
    (to.is_nan() || to <= from).then_some((1, "finite, above the lower end"))
}

/// Largest level of the input that numbers are drawn for, in input units.
pub(crate) const LARGEST_LEVEL: f64 = 2.5;

/// How the numbers of an effect are drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draw {
    /// From 0, no effect, to 1, all that is plausible.
    pub(crate) strength: f64,
    /// What makes one instance of an effect differ from the next: drawn from 0 to 1.
    pub(crate) chances: [f64; 3],
    /// The [`valve_edge`](crate::JointSpec::valve_edge) of the joint.
    pub(crate) valve_edge: f64,
    /// Angle of the joint at the first sample.
    pub(crate) start: f64,
}

impl Draw {
    /// Chance `index`, below 3, between `from` and `to`.
    pub(super) fn between(&self, index: usize, from: f64, to: f64) -> f64 {
        from + (to - from) * self.chances[index]
    }

    /// 1 or -1.
    pub(super) fn sign(&self, index: usize) -> f64 {
        if self.between(index, -1.0, 1.0) < 0.0 { -1.0 } else { 1.0 }
    }
}
