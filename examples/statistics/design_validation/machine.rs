//! Machines by differential equations of their own, in steps of a millisecond: neither the models
//! that are fitted nor the synthetic plant have a part in them.
//!
//! ```text
//! input → delay → soft dead band → gain of each direction → lag → × linkage × load → ∫ → stops
//!                                                                 leakage, sinking ↗
//! input → delay → soft dead band → gain of each direction → (T y' + y) → output
//! ```

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

/// Milliseconds of a sample.
pub(crate) const SAMPLE_MS: usize = 20;

/// Seconds of a step of the integration.
const STEP_S: f64 = 0.001;

/// A joint or an output that regulates itself.
#[derive(Clone, Debug)]
pub(crate) struct Machine {
    pub(crate) delay_s: f64,
    /// Gain of negative and of positive inputs.
    pub(crate) gain: (f64, f64),
    /// Ends of the dead band, and how soft they are.
    pub(crate) dead_band: (f64, f64),
    pub(crate) softness: f64,
    /// Time constant of the speed; of the output itself where it regulates itself.
    pub(crate) lag_s: f64,
    pub(crate) output: Output,
    /// Standard deviation of the noise.
    pub(crate) noise: f64,
}

/// What the gain makes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Output {
    /// A speed, pressure or position that follows the input, about that of no input.
    Regulating { at_zero: f64 },
    /// An angle, of which the speed follows the input.
    Angle(Joint),
}

/// Load and ends of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joint {
    /// Lowest and highest angle.
    pub(crate) stops: (f64, f64),
    /// Part of the speed that the linkage adds in the middle of the stroke.
    pub(crate) linkage: f64,
    /// Part by which the load slows the joint upward and speeds it up downward, at the ends of the
    /// stroke: it changes evenly between.
    pub(crate) load: (f64, f64),
    /// Part of the way to the lower stop that leaks in a second.
    pub(crate) leakage: f64,
    /// Speed at which it sinks, output units per second.
    pub(crate) sinking: f64,
}

impl Machine {
    /// What the valve lets through.
    fn opening(&self, input: f64) -> f64 {
        let soft = |x: f64| {
            let of = x / self.softness;
            if of > 30.0 { x } else { self.softness * of.exp().ln_1p() }
        };
        let (lower, upper) = self.dead_band;
        self.gain.1 * soft(input - upper) - self.gain.0 * soft(lower - input)
    }

    /// Where an output that regulates itself comes to rest.
    pub(crate) fn settled(&self, input: f64) -> Option<f64> {
        match self.output {
            Output::Regulating { at_zero } => Some(at_zero + self.opening(input)),
            Output::Angle(_) => None,
        }
    }

    /// The output at each sample of `input` from `start` on, where the first level was held for
    /// long; without noise.
    pub(crate) fn run(&self, input: &[f64], start: f64) -> Vec<f64> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small, ≥ 0")]
        let late = (self.delay_s / STEP_S).round() as usize;
        let mut state = (start, self.opening(input.first().copied().unwrap_or(0.0)));
        let mut output = Vec::with_capacity(input.len());
        for sample in 0..input.len() {
            output.push(state.0);
            for step in 0..SAMPLE_MS {
                let at = (sample * SAMPLE_MS + step).saturating_sub(late) / SAMPLE_MS;
                state = self.stepped(state, self.opening(input.get(at).copied().unwrap_or(0.0)));
            }
        }
        output
    }

    fn stepped(&self, (y, v): (f64, f64), driven: f64) -> (f64, f64) {
        let Output::Angle(joint) = self.output else {
            let Output::Regulating { at_zero } = self.output else { return (y, v) };
            return (y + STEP_S / self.lag_s * (at_zero + driven - y), v);
        };
        let v = v + (STEP_S / self.lag_s).min(1.0) * (driven - v);
        let (low, high) = joint.stops;
        let part = ((y - low) / (high - low)).clamp(0.0, 1.0);
        let linkage = 1.0 + joint.linkage * (std::f64::consts::PI * part).sin();
        let load = joint.load.0 + (joint.load.1 - joint.load.0) * part;
        let speed = v * linkage * (1.0 - load * v.signum()) - joint.leakage * (y - low);
        ((y + STEP_S * (speed - joint.sinking)).clamp(low, high), v)
    }

    /// `output` as a sensor has it.
    pub(crate) fn measured(&self, output: &[f64], random: &mut ChaCha8Rng) -> Vec<f64> {
        let mut noise = || -> f64 { StandardNormal.sample(random) };
        output.iter().map(|y| y + self.noise * noise()).collect()
    }
}
