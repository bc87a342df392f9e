//! A mass that slides against a constant force, over one interval in closed form.
//!
//! ```text
//! T v' + c v = in − positive   while v > 0, c = 1
//! T v' + c v = in + negative   while v < 0, c = negative_viscous
//! v = 0                        while −negative ≤ in ≤ positive at rest
//! ```
//!
//! While it slides one way the equation is linear, with a time constant `T/c` and an end at
//! `(in ∓ level)/c`, so that the time of the stop is known, and the mean over the interval is
//! exact with any number of the events stop, rest and start in it:
//!
//! ```text
//! t_stop = T/c · ln(1 + c |v(0)| / |in ∓ level|)      ∫v dt = ((in ∓ level) · t − T · Δv) / c
//! ```

use super::band::shifted;
use super::decay::{DECAY_MEMORY, Decay};
use super::moment::Moment;

/// Numbers of memory: the speed in input units, and the decay that was computed last.
pub(super) const SLIDING_MEMORY: usize = 1 + DECAY_MEMORY;

/// What brakes the mass.
#[derive(Clone, Copy, Debug)]
struct Sliding {
    /// Level against positive motion, in input units.
    positive: f64,
    /// Level against negative motion, in input units.
    negative: f64,
    /// `T`, in seconds.
    time_constant: f64,
    /// Viscous friction of negative motion over that of positive motion.
    negative_viscous: f64,
}

/// The mean speed over the interval of `at`: [`Effect::step`](super::Effect::step).
pub(super) fn step(parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
    Sliding::of(parameters).map_or(at.signal, |sliding| sliding.step(memory, at))
}

/// The state after the signal of `at` has long been held.
pub(super) fn settle(parameters: &[f64], memory: &mut [f64], at: &Moment) {
    if let Some(sliding) = Sliding::of(parameters) {
        sliding.settle(memory, at.signal);
    }
}

impl Sliding {
    /// Of the two levels, the time constant, and, where it is not 1, the viscous friction of
    /// negative motion.
    fn of(parameters: &[f64]) -> Option<Self> {
        let (&[positive, negative, time_constant], rest) = parameters.split_first_chunk()?;
        let negative_viscous = rest.first().copied().unwrap_or(1.0);
        Some(Self { positive, negative, time_constant, negative_viscous })
    }

    fn step(&self, memory: &mut [f64], at: &Moment) -> f64 {
        let [speed, known @ ..] = memory else { return at.signal };
        let force = self.force(at.signal);
        if self.time_constant <= 0.0 {
            *speed = force / self.viscous(force);
            return *speed;
        }
        let drive = if *speed > 0.0 {
            at.signal - self.positive
        } else if *speed < 0.0 {
            at.signal + self.negative
        } else {
            force
        };
        let viscous = self.viscous(if *speed == 0.0 { drive } else { *speed });
        let (end, time_constant) = (drive / viscous, self.time_constant / viscous);
        let stop_s = stop_time(*speed, end, time_constant);
        if stop_s < at.dt_s {
            let braking = end * stop_s + time_constant * *speed;
            let rest_s = at.dt_s - stop_s;
            let viscous = self.viscous(force);
            let end = force / viscous;
            let decay = Decay::over(rest_s, self.time_constant / viscous);
            *speed = end * (1.0 - decay.left);
            return (braking + rest_s * end * (1.0 - decay.mean)) / at.dt_s;
        }
        let decay = Decay::recall(known, at.dt_s, time_constant);
        let deviation = *speed - end;
        *speed = end + deviation * decay.left;
        end + deviation * decay.mean
    }

    fn settle(&self, memory: &mut [f64], signal: f64) {
        if let [speed, ..] = memory {
            let force = self.force(signal);
            *speed = force / self.viscous(force);
        }
    }

    /// What is left of `signal` to start the mass with.
    fn force(&self, signal: f64) -> f64 {
        shifted(signal, -self.negative, self.positive)
    }

    /// `c` for a motion or a force of this sign.
    fn viscous(&self, motion: f64) -> f64 {
        if motion < 0.0 { self.negative_viscous } else { 1.0 }
    }
}

/// Seconds until the speed is zero, infinite where it does not move toward an `end` beyond zero.
fn stop_time(speed: f64, end: f64, time_constant: f64) -> f64 {
    let braked = if speed > 0.0 { end < 0.0 } else { speed < 0.0 && end > 0.0 };
    if braked { time_constant * (-speed / end).ln_1p() } else { f64::INFINITY }
}
