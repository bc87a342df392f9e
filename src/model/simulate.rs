//! What a model says the output is.

use super::{Arrivals, Component, JointModel};
use crate::effect::{Effect, Moment, Stage};

/// Where the simulated angle is set anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restart {
    /// Index of the sample, from 0.
    pub sample: usize,
    /// The angle there, output units.
    pub output: f64,
}

/// What a joint's model needs to know of the rest.
#[derive(Clone, Copy, Debug, Default)]
pub struct Surroundings<'a> {
    /// Activity of the other joints, 0 to 1, one value per sample; none: at rest.
    pub others: &'a [f64],
    /// Radians in one output unit, for effects that depend on the direction of gravity.
    pub radians_per_output_unit: f64,
    /// Seconds of the record before the trial's first sample.
    pub start_s: f64,
}

/// A simulated trial, one value per sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Simulated {
    /// The output as it would be measured, output units.
    pub output: Vec<f64>,
    /// Its mean speed until the next sample, output units per second.
    pub velocity: Vec<f64>,
    /// The input that acts, its delay taken into account, input units.
    pub acting: Vec<f64>,
}

/// Simulates `samples` samples at `period_s` from the levels that arrive.
///
/// Between two samples the input is constant or changes at arrivals; each part is treated
/// on its own, so that delays need not be multiples of the period. Stages before the gain
/// are exact for a constant input. Effects that depend on the angle are integrated with
/// the midpoint rule: the error per second falls with the square of the period.
///
/// `restarts` set the angle anew; the first must be at sample 0, else the angle starts at
/// zero.
pub fn simulate(
    model: &JointModel,
    arrivals: &Arrivals,
    samples: usize,
    period_s: f64,
    restarts: &[Restart],
    surroundings: &Surroundings<'_>,
) -> Simulated {
    let mut joint = Joint::new(model, surroundings);
    joint.angle = restarts.first().map_or(0.0, |restart| restart.output);
    joint.settle(arrivals.initial, period_s);
    let mut simulated = Simulated::with_capacity(samples);
    let mut restarts = restarts.iter().peekable();
    let mut coming = arrivals.changes.iter().peekable();
    let mut level = arrivals.initial;
    for sample in 0..samples {
        while let Some(restart) = restarts.next_if(|restart| restart.sample <= sample) {
            joint.angle = restart.output;
        }
        joint.others = surroundings.others.get(sample).copied().unwrap_or_default();
        let (start, end) = (sample as f64 * period_s, (sample + 1) as f64 * period_s);
        // What arrives exactly at a sample acts from it on.
        while let Some(change) = coming.next_if(|change| change.time_s <= start) {
            level = change.level;
        }
        simulated.output.push(joint.measure(start));
        simulated.acting.push(level);
        let (before, mut now) = (joint.angle, start);
        while let Some(change) = coming.next_if(|change| change.time_s < end) {
            joint.pass(level, now, change.time_s - now);
            (now, level) = (change.time_s, change.level);
        }
        joint.pass(level, now, end - now);
        simulated.velocity.push((joint.angle - before) / period_s);
    }
    simulated
}

impl Simulated {
    fn with_capacity(samples: usize) -> Self {
        Self {
            output: Vec::with_capacity(samples),
            velocity: Vec::with_capacity(samples),
            acting: Vec::with_capacity(samples),
        }
    }
}

/// An effect with its values and its memory, ready to run.
struct Running {
    effect: &'static dyn Effect,
    parameters: Vec<f64>,
    memory: Vec<f64>,
}

impl Running {
    fn new(component: &Component) -> Self {
        let effect = component.effect();
        let memory = vec![0.0; effect.spec().memory];
        Self { effect, parameters: component.plain(), memory }
    }

    fn settle(&mut self, at: &Moment) {
        self.effect.settle(&self.parameters, &mut self.memory, at);
    }

    fn step(&mut self, at: &Moment) -> f64 {
        self.effect.step(&self.parameters, &mut self.memory, at)
    }
}

/// The state of a joint between two instants.
struct Joint<'a> {
    gain: f64,
    /// Effects on the input, then those of the dynamics: both before the gain.
    drive: Vec<Running>,
    load: Vec<Running>,
    /// Effects that limit the angle itself.
    limits: Vec<Running>,
    /// Effects between the angle and its sensor.
    sensor: Vec<Running>,
    surroundings: &'a Surroundings<'a>,
    others: f64,
    angle: f64,
    velocity: f64,
}

impl<'a> Joint<'a> {
    fn new(model: &JointModel, surroundings: &'a Surroundings<'a>) -> Self {
        let stage = |stage| model.stage(stage).map(Running::new);
        let output = model.stage(Stage::Output);
        let (limits, sensor): (Vec<_>, Vec<_>) =
            output.partition(|component| component.effect().spec().acts_on_state);
        Self {
            gain: model.gain.value,
            drive: stage(Stage::Input).chain(stage(Stage::Dynamics)).collect(),
            load: stage(Stage::Load).collect(),
            limits: limits.into_iter().map(Running::new).collect(),
            sensor: sensor.into_iter().map(Running::new).collect(),
            surroundings,
            others: 0.0,
            angle: 0.0,
            velocity: 0.0,
        }
    }

    /// Puts all memory into the state of an input that has long been held.
    fn settle(&mut self, input: f64, period_s: f64) {
        let mut at = self.moment(input, 0.0, period_s);
        for running in &mut self.drive {
            running.settle(&at);
            at.signal = running.step(&at);
        }
        at.signal = self.angle;
        for running in self.limits.iter_mut().chain(&mut self.sensor) {
            running.settle(&at);
            at.signal = running.step(&at);
        }
    }

    fn moment(&self, signal: f64, time_s: f64, dt: f64) -> Moment {
        Moment {
            signal,
            position: self.angle,
            velocity: self.velocity,
            time_s: self.surroundings.start_s + time_s,
            dt_s: dt,
            others: self.others,
            radians_per_output_unit: self.surroundings.radians_per_output_unit,
        }
    }

    /// Lets `dt` seconds pass with a constant input.
    fn pass(&mut self, input: f64, time_s: f64, dt: f64) {
        if dt <= 0.0 {
            return;
        }
        let mut at = self.moment(input, time_s, dt);
        for running in &mut self.drive {
            at.signal = running.step(&at);
        }
        let command = self.gain * at.signal;
        let mut velocity = self.loaded(command, at, 0.0);
        if !self.load.is_empty() {
            velocity = self.loaded(command, at, 0.5 * velocity * dt);
        }
        self.angle += velocity * dt;
        self.velocity = velocity;
        self.limit(time_s, dt);
    }

    /// The velocity that the load leaves of `command`, `ahead` of the present angle.
    fn loaded(&mut self, command: f64, mut at: Moment, ahead: f64) -> f64 {
        at.signal = command;
        at.position += ahead;
        for running in &mut self.load {
            at.signal = running.step(&at);
        }
        at.signal
    }

    fn limit(&mut self, time_s: f64, dt: f64) {
        let free = self.angle;
        let mut at = self.moment(free, time_s, dt);
        for running in &mut self.limits {
            at.signal = running.step(&at);
        }
        self.angle = at.signal;
        // At a stop the joint stands still, whatever drives it.
        #[expect(clippy::float_cmp, reason = "a stop changes the angle or leaves it")]
        if self.angle != free {
            self.velocity = 0.0;
        }
    }

    /// The angle as the sensor shows it.
    fn measure(&mut self, time_s: f64) -> f64 {
        let mut at = self.moment(self.angle, time_s, 0.0);
        for running in &mut self.sensor {
            at.signal = running.step(&at);
        }
        at.signal
    }
}
