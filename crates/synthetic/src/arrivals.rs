//! Which level acts when: the steps after their delays.

/// From `time_s` on the joint is driven at `speed`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arrival {
    /// When it begins to act, in seconds.
    pub(super) time_s: f64,
    /// Steady speed that it commands, in output units per second.
    pub(super) speed: f64,
    /// Angle of a joint without inertia at that time.
    pub(super) angle: f64,
}

/// The levels that act, in the order of time.
///
/// A later step that acts before an earlier one wins: the earlier level never
/// comes back.
#[derive(Clone, Debug)]
pub(super) struct Arrivals {
    first: Arrival,
    later: Vec<(usize, Arrival)>,
}

impl Arrivals {
    /// Only the level before the first step, at time 0.
    pub(super) fn new(angle: f64, speed: f64) -> Self {
        Self { first: Arrival { time_s: 0.0, speed, angle }, later: Vec::new() }
    }

    /// Lets step `index` act from `time_s` on; it must be the latest step.
    pub(super) fn push(&mut self, index: usize, time_s: f64, speed: f64) {
        while self.later.pop_if(|(_, earlier)| earlier.time_s >= time_s).is_some() {}
        let angle = self.angle_at(time_s);
        self.later.push((index, Arrival { time_s, speed, angle }));
    }

    /// What acts afterwards, with the number of the step, from 0.
    pub(super) fn later(&self) -> &[(usize, Arrival)] {
        &self.later
    }

    /// Angle that a joint without inertia has at `time_s`.
    pub(super) fn angle_at(&self, time_s: f64) -> f64 {
        let mut backwards = self.later.iter().rev().map(|(_, arrival)| arrival);
        let acting = backwards.find(|arrival| arrival.time_s < time_s).unwrap_or(&self.first);
        acting.angle + acting.speed * (time_s - acting.time_s)
    }

    /// Change of speed that each step causes, for those not overtaken.
    pub(super) fn speed_changes(&self) -> impl Iterator<Item = (usize, f64)> {
        let before = std::iter::once(&self.first).chain(self.later.iter().map(|(_, a)| a));
        self.later
            .iter()
            .zip(before)
            .map(|((index, now), before)| (*index, now.speed - before.speed))
    }
}
