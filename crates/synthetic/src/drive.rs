//! The steps of one joint's input, and when each begins to act.

/// One step of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// 1-based number of the sample that first shows the new level.
    pub(crate) sample: usize,
    /// Level before.
    pub(crate) before: f64,
    /// Level after.
    pub(crate) after: f64,
    /// Seconds until it acts.
    pub(crate) delay_s: f64,
    /// When it begins to act, in seconds since the first sample.
    pub(crate) acts_s: f64,
    /// Steady speed that it commands, in output units per second.
    pub(crate) speed: f64,
}

/// From `time_s` on `level` acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arrival {
    /// Number of the step, from 0; that of the level before the first step means nothing.
    step: usize,
    /// When it begins to act, in seconds.
    pub(crate) time_s: f64,
    /// Level of the input.
    pub(crate) level: f64,
    /// Steady speed that it commands, in output units per second.
    speed: f64,
    /// Angle of a joint without inertia at that time.
    angle: f64,
}

/// All steps of one joint, and the levels that act, in the order of time.
///
/// A later step that acts before an earlier one wins: the earlier level never
/// comes back.
#[derive(Clone, Debug)]
pub(crate) struct Drive {
    steps: Vec<Step>,
    first: Arrival,
    later: Vec<Arrival>,
}

impl Drive {
    /// Only the `level` before the first step, at time 0 and `angle`.
    pub(crate) fn new(level: f64, speed: f64, angle: f64) -> Self {
        let first = Arrival { step: 0, time_s: 0.0, level, speed, angle };
        Self { steps: Vec::new(), first, later: Vec::new() }
    }

    /// Adds the latest step.
    pub(crate) fn push(&mut self, step: Step) {
        let Step { acts_s: time_s, after: level, speed, .. } = step;
        while self.later.pop_if(|earlier| earlier.time_s >= time_s).is_some() {}
        let angle = self.angle_at(time_s);
        self.later.push(Arrival { step: self.steps.len(), time_s, level, speed, angle });
        self.steps.push(step);
    }

    /// The steps, in the order of time.
    pub(crate) fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// What acts after the level before the first step.
    pub(crate) fn later(&self) -> &[Arrival] {
        &self.later
    }

    /// The level after the last step so far, in input units.
    pub(crate) fn level(&self) -> f64 {
        self.steps.last().map_or(self.first.level, |step| step.after)
    }

    /// Angle that a joint without inertia has at `time_s`.
    pub(crate) fn angle_at(&self, time_s: f64) -> f64 {
        let mut backwards = self.later.iter().rev();
        let acting = backwards.find(|arrival| arrival.time_s < time_s).unwrap_or(&self.first);
        acting.angle + acting.speed * (time_s - acting.time_s)
    }

    /// Change of the steady speed that each step causes, in output units per second; none
    /// for one that was overtaken.
    pub(crate) fn speed_changes(&self) -> Vec<Option<f64>> {
        let before = std::iter::once(&self.first).chain(&self.later);
        self.by_step(self.later.iter().zip(before).map(|(now, before)| now.speed - before.speed))
    }

    /// `changes` that came with the [`later`](Self::later) levels, in the order of the steps;
    /// none for a step that was overtaken.
    pub(crate) fn by_step(&self, changes: impl Iterator<Item = f64>) -> Vec<Option<f64>> {
        let mut by_step = vec![None; self.steps.len()];
        for (arrival, change) in self.later.iter().zip(changes) {
            by_step[arrival.step] = Some(change);
        }
        by_step
    }
}
