//! A joint as a simulation moves it on, from one instant to the next.

use super::{Arrival, Component, JointModel};
use crate::effect::{Effect, Moment, Pace, Stage};
use crate::experiment::Signal;
use crate::numerics::settle_at_root;

/// Where the simulated output is set anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restart {
    /// Index of the sample, from 0.
    pub sample: usize,
    /// The output there, output units.
    pub output: f64,
    /// The speed there in output units per second, where it is known from elsewhere; the
    /// simulation goes on with its own where it is not.
    pub speed: Option<f64>,
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
    /// Further signals that were measured.
    pub signals: Signals<'a>,
}

/// The further measured signals of a trial.
#[derive(Clone, Copy, Debug, Default)]
pub struct Signals<'a> {
    /// What they are.
    pub signals: &'a [Signal],
    /// Their values, one per sample.
    pub values: &'a [Vec<f64>],
    /// Index of the sample with which the simulation begins.
    pub from: usize,
}

impl<'a> Signals<'a> {
    /// The values of the signal with this name, from where the simulation begins; none where it was
    /// not measured.
    fn named(&self, name: &str) -> &'a [f64] {
        let index = self.signals.iter().position(|signal| signal.name == name);
        let values = index.and_then(|index| self.values.get(index));
        values.and_then(|values| values.get(self.from..)).unwrap_or_default()
    }
}

/// The level that acts, and those that are to come.
pub(super) struct Input<'a> {
    pub(super) level: f64,
    pub(super) coming: &'a [Arrival],
}

impl Input<'_> {
    /// The next change, where it comes before `end`.
    fn before(&mut self, end: f64) -> Option<Arrival> {
        let (first, rest) = self.coming.split_first()?;
        (first.time_s < end).then(|| {
            self.coming = rest;
            *first
        })
    }

    /// Lets all changes act that have come at `time_s`: what arrives at a sample acts
    /// from it on.
    pub(super) fn advance(&mut self, time_s: f64) {
        while let Some((first, rest)) = self.coming.split_first() {
            if first.time_s > time_s {
                break;
            }
            (self.level, self.coming) = (first.level, rest);
        }
    }
}

/// An effect with its values and its memory, ready to run.
#[derive(Clone)]
struct Running<'a> {
    effect: &'static dyn Effect,
    parameters: Vec<f64>,
    memory: Vec<f64>,
    /// The measured signal on which it depends, one value per sample, and the one of now.
    signal: &'a [f64],
    measured: f64,
}

impl<'a> Running<'a> {
    fn new(component: &Component, signals: Signals<'a>) -> Self {
        let effect = component.effect();
        let memory = vec![0.0; effect.spec().memory];
        let signal = effect.measured_signal().map_or(&[][..], |name| signals.named(name));
        Self { effect, parameters: component.plain(), memory, signal, measured: f64::NAN }
    }

    fn settle(&mut self, at: &Moment) {
        self.effect.settle(&self.parameters, &mut self.memory, at);
    }

    fn step(&mut self, at: &Moment) -> f64 {
        self.effect.step(&self.parameters, &mut self.memory, at)
    }

    /// What a step would give; the memory stays as it is.
    fn foreseen(&self, at: &Moment) -> f64 {
        self.effect.step(&self.parameters, &mut self.memory.clone(), at)
    }
}

/// The state of a joint between two instants.
pub(super) struct Joint<'a> {
    gain: f64,
    /// Effects of the spool, on the input, and of the dynamics: all before the gain.
    drive: Vec<Running<'a>>,
    /// How many of them, from the front, do the same again as long as the input is held.
    steady: usize,
    /// The input that was last held, and what these made of it.
    held: Option<(f64, f64)>,
    load: Vec<Running<'a>>,
    /// Effects that limit the angle itself.
    limits: Vec<Running<'a>>,
    /// Effects between the angle and its sensor.
    sensor: Vec<Running<'a>>,
    /// What the load added to the commanded velocity in the last interval.
    load_adds: f64,
    surroundings: Surroundings<'a>,
    pub(super) others: f64,
    pub(super) angle: f64,
    velocity: f64,
    /// The angle as the sensor shows it.
    pub(super) measured: f64,
}

impl<'a> Joint<'a> {
    pub(super) fn new(model: &JointModel, surroundings: Surroundings<'a>) -> Self {
        let running = |component| Running::new(component, surroundings.signals);
        let stage = |stage| model.stage(stage).map(running);
        let output = model.stage(Stage::Output);
        let (limits, sensor): (Vec<_>, Vec<_>) =
            output.partition(|component| component.effect().spec().acts_on_state);
        let drive = [Stage::Spool, Stage::Input, Stage::Dynamics];
        let drive: Vec<_> = drive.into_iter().flat_map(stage).collect();
        let is_steady = |running: &&Running<'_>| running.effect.is_steady();
        Self {
            gain: model.gain.value,
            steady: drive.iter().take_while(is_steady).count(),
            held: None,
            drive,
            load: stage(Stage::Load).collect(),
            load_adds: 0.0,
            limits: limits.into_iter().map(running).collect(),
            sensor: sensor.into_iter().map(running).collect(),
            surroundings,
            others: 0.0,
            angle: 0.0,
            velocity: 0.0,
            measured: 0.0,
        }
    }

    /// Lets the effects see what was measured with the sample of this index.
    pub(super) fn observe(&mut self, sample: usize) {
        let stages = [&mut self.drive, &mut self.load, &mut self.limits, &mut self.sensor];
        for running in stages.into_iter().flatten().filter(|running| !running.signal.is_empty()) {
            running.measured = running.signal.get(sample).copied().unwrap_or(f64::NAN);
        }
    }

    /// Puts all memory into the state of an input that has long been held.
    pub(super) fn settle(&mut self, input: f64, period_s: f64) {
        self.settle_drive(input, period_s);
        let mut at = self.moment(self.angle, 0.0, period_s);
        for running in &mut self.limits {
            running.settle(&at);
            at.signal = running.step(&at);
        }
        self.angle = at.signal;
        let mut at = self.moment(self.angle, 0.0, period_s);
        for running in &mut self.sensor {
            running.settle(&at);
            at.signal = running.step(&at);
        }
        self.measured = at.signal;
    }

    /// Puts the memory of the drive into the state after `signal` has long been held.
    fn settle_drive(&mut self, signal: f64, period_s: f64) {
        self.held = None;
        let mut at = self.moment(signal, 0.0, period_s);
        for running in &mut self.drive {
            running.settle(&at);
            at.signal = running.step(&at);
        }
    }

    /// Sets the output anew, and the speed where it is known.
    ///
    /// The joint keeps its position in the play between angle and sensor: the sensor settles
    /// at the output, and then the joint moves to that position.
    pub(super) fn restart(&mut self, restart: &Restart, time_s: f64, period_s: f64) {
        let play = self.angle - self.measured;
        let mut at = self.moment(restart.output, time_s, period_s);
        for running in &mut self.sensor {
            running.settle(&at);
            at.signal = running.step(&at);
        }
        self.angle = restart.output + play;
        self.measure(time_s, period_s);
        if let Some(speed) = restart.speed {
            self.settle_at_speed(speed, time_s, period_s);
        }
    }

    /// Puts the dynamics into the state of a held signal that makes `speed` here. What is before them and
    /// remembers the turns of the input, as a play, stays as it is; so does a memory that is slower than
    /// the speed, of which the speed of now says nothing.
    ///
    /// The speed rises with the signal, or falls if the gain is negative; where it can not be
    /// reached the nearest one is taken.
    fn settle_at_speed(&mut self, speed: f64, time_s: f64, period_s: f64) {
        let sign = self.gain.signum();
        self.held = None;
        let above = |signal: f64| sign * (self.steady_speed(signal, time_s, period_s) - speed);
        settle_at_root(above);
        self.velocity = speed;
    }

    /// The speed after `signal` has long been held before the dynamics, whose memory is as after it.
    fn steady_speed(&mut self, signal: f64, time_s: f64, period_s: f64) -> f64 {
        let mut at = self.moment(signal, time_s, period_s);
        for running in self.drive.iter_mut().skip(self.steady) {
            at.signal = if running.effect.spec().pace == Pace::Slower {
                running.foreseen(&at)
            } else {
                running.settle(&at);
                running.step(&at)
            };
        }
        at.signal *= self.gain;
        for running in &self.load {
            at.measured = running.measured;
            at.signal = running.foreseen(&at);
        }
        at.signal
    }

    fn moment(&self, signal: f64, time_s: f64, dt: f64) -> Moment {
        Moment {
            signal,
            position: self.angle,
            velocity: self.velocity,
            time_s: self.surroundings.start_s + time_s,
            dt_s: dt,
            others: self.others,
            measured: f64::NAN,
            radians_per_output_unit: self.surroundings.radians_per_output_unit,
        }
    }

    /// Lets the time from `start` to `end` pass, in parts where changes arrive in it.
    pub(super) fn interval(&mut self, input: &mut Input<'_>, start: f64, end: f64, period_s: f64) {
        let Some(mut change) = input.before(end) else {
            // Not `end − start`: effects keep what they computed for the same length.
            return self.pass(input.level, start, period_s);
        };
        let mut now = start;
        loop {
            self.pass(input.level, now, change.time_s - now);
            (now, input.level) = (change.time_s, change.level);
            let Some(next) = input.before(end) else { break };
            change = next;
        }
        self.pass(input.level, now, end - now);
    }

    /// Lets `dt` seconds pass with a constant input.
    fn pass(&mut self, input: f64, time_s: f64, dt: f64) {
        if dt <= 0.0 {
            return;
        }
        if let Some((held, signal)) = self.held
            && self.steady == self.drive.len()
            && self.load.is_empty()
            && held.to_bits() == input.to_bits()
        {
            self.velocity = self.gain * signal;
        } else {
            let mut at = self.moment(input, time_s, dt);
            at.signal = self.gain * self.driven(at);
            self.velocity = if self.load.is_empty() { at.signal } else { self.loaded(at) };
        }
        self.angle += self.velocity * dt;
        if !self.limits.is_empty() {
            self.limit(time_s, dt);
        }
        self.measure(time_s, dt);
    }

    /// The input after the effects on it and those of the dynamics.
    fn driven(&mut self, mut at: Moment) -> f64 {
        let (steady, others) = self.drive.split_at_mut(self.steady);
        let known = self.held.filter(|(input, _)| input.to_bits() == at.signal.to_bits());
        let input = at.signal;
        at.signal = known.map_or_else(|| through(steady, at), |(_, signal)| signal);
        self.held = Some((input, at.signal));
        through(others, at)
    }

    /// The velocity that the load leaves of the commanded one, by the midpoint rule: half an
    /// interval ahead the joint is where it comes if the load does what it did before.
    fn loaded(&mut self, start: Moment) -> f64 {
        let half = 0.5 * start.dt_s;
        let position = start.position + half * (start.signal + self.load_adds);
        let middle = Moment { position, time_s: start.time_s + half, ..start };
        let loaded = through(&mut self.load, middle);
        self.load_adds = loaded - start.signal;
        loaded
    }

    fn limit(&mut self, time_s: f64, dt: f64) {
        let free = self.angle;
        let at = self.moment(free, time_s, dt);
        self.angle = through(&mut self.limits, at);
        // At a stop the joint stands still, whatever drives it.
        #[expect(clippy::float_cmp, reason = "a stop changes the angle or leaves it")]
        if self.angle != free {
            self.velocity = 0.0;
        }
    }

    /// Moves the sensor on to the present angle.
    fn measure(&mut self, time_s: f64, dt: f64) {
        self.measured = if self.sensor.is_empty() {
            self.angle
        } else {
            let at = self.moment(self.angle, time_s, dt);
            through(&mut self.sensor, at)
        };
    }
}

/// The signal after all of `effects`.
fn through(effects: &mut [Running<'_>], mut at: Moment) -> f64 {
    for running in effects {
        at.measured = running.measured;
        at.signal = running.step(&at);
    }
    at.signal
}
