//! Joints with something to find: effects hidden at a strength that is known in advance.
//!
//! A joint of random gain, delay and levels is driven for two minutes by random steps, a
//! second one beside it. The effects are scaled until the nearest integrator with a delay
//! is wrong by a multiple of the noise. That takes no model of the effects: whatever
//! explains them later is judged by other formulas.

mod integrator;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::delay_law::DelayLaw;
use crate::effects::{self, Draw, LARGEST_LEVEL, Twin};
use crate::error::PlantError;
use crate::input::InputSpec;
use crate::random::{Purpose, stream};
use crate::simulate::{Simulated, simulate};
use crate::spec::{JointSpec, PlantSpec};

/// Length of a record in seconds.
const DURATION_S: f64 = 120.0;

/// Time steps in a sample of 10 ms: a millisecond each.
const SUBSTEPS: u32 = 10;

/// Angles within which the experimenter keeps the joint, in degrees.
const RANGE: [f64; 2] = [-52.0, 52.0];

/// Angle that is not exceeded either way where an effect is sized, in degrees.
const FARTHEST: f64 = 60.0;

/// Shortest and longest hold of a level in seconds.
const HOLD_S: [f64; 2] = [0.5, 3.0];

/// Levels of each sign.
const LEVELS: usize = 5;

/// How clearly an effect shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Strength {
    /// The nearest integrator is wrong by about 3 times the noise, and 1.5 to 5 times.
    Weak,
    /// The nearest integrator is wrong by about 12 times the noise, and 8 times or more.
    Clear,
}

/// The noise of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Standard deviation, in output units.
    pub deviation: f64,
    /// Correlation of neighbouring samples; 0 is white.
    pub correlation: f64,
}

/// Why there is no such scenario.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// No plausible size of the effect makes the error that is wanted.
    #[error(
        "`{name}` makes an error of {found:.2} times the noise where {wanted} is wanted; choose \
         another seed or another noise"
    )]
    OutOfReach {
        /// The effect.
        name: &'static str,
        /// The nearest error, in deviations of the noise.
        found: f64,
        /// The error that is wanted, in the same.
        wanted: f64,
    },
    /// An effect is unknown or there twice, or the plant cannot be simulated.
    #[error(transparent)]
    Plant {
        /// Why.
        #[from]
        source: PlantError,
    },
}

/// A plant, and what is hidden in its first joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// The plant: [`simulate`] makes its log, and its numbers are the truth. The second
    /// joint hides nothing.
    pub plant: PlantSpec,
    /// Names of what the first joint hides.
    pub hidden: Vec<&'static str>,
    /// Root mean square of the angle less that of the nearest integrator, which starts
    /// anew at each step of the input, in deviations of the noise.
    pub error_over_noise: f64,
}

/// Numbers of the random numbers that choose effects, and those that make a joint without any.
const CHOICE: usize = 23;
const BARE: usize = 24;

/// `count` effects of the catalogue, drawn by `seed`, no two of which look alike; at most
/// five.
pub fn draw(count: usize, seed: u64) -> Vec<&'static str> {
    let mut random = stream(seed, CHOICE, Purpose::Scenario);
    let mut families = effects::families();
    let mut drawn = Vec::new();
    while drawn.len() < count && !families.is_empty() {
        let family = families.swap_remove(random.random_range(0..families.len()));
        drawn.extend(family.get(random.random_range(0..family.len())));
    }
    drawn
}

impl Strength {
    /// Least, wanted and largest error of the nearest integrator, in deviations of the noise.
    fn errors(self) -> [f64; 3] {
        match self {
            Self::Weak => [1.5, 3.0, 5.0],
            Self::Clear => [8.0, 12.0, f64::INFINITY],
        }
    }

    /// Whether an error is what the strength means.
    fn holds(self, error: f64) -> bool {
        let [least, _, largest] = self.errors();
        (least..=largest).contains(&error)
    }
}

impl Noise {
    /// White noise.
    pub fn white(deviation: f64) -> Self {
        Self { deviation, correlation: 0.0 }
    }

    /// Noise of which neighbouring samples correlate.
    pub fn correlated(deviation: f64, correlation: f64) -> Self {
        Self { deviation, correlation }
    }
}

/// An effect that is hidden, and how much of it.
#[derive(Clone, Debug)]
struct HiddenEffect {
    twin: &'static Twin,
    /// Drawn from 0 to 1.
    chances: [f64; 3],
    amount: f64,
    /// Where the next chances come from.
    random: ChaCha8Rng,
}

impl HiddenEffect {
    /// The effect `name`, its particulars drawn by `seed`.
    fn new(name: &str, seed: u64) -> Result<Self, PlantError> {
        let row = effects::find(name)?;
        let mut random = stream(seed, row.number, Purpose::Scenario);
        Ok(Self { twin: row.twin, chances: random.random(), amount: FIRST_AMOUNT, random })
    }
}

/// Amount of an effect before it is known what it does.
const FIRST_AMOUNT: f64 = 0.1;

/// Least amount that is tried.
const LEAST_AMOUNT: f64 = 1e-4;

/// Ratio of two amounts below which nothing between is tried: an effect that only depends
/// on which level is beyond a threshold jumps.
const DISTINCT: f64 = 1.02;

/// Counts more than any distance: an error that is not what the strength means.
const MISSED: f64 = 100.0;

/// Amounts of one effect that are tried on one input.
const TRIES: usize = 14;

/// Distance of the error from what is wanted at which no further amount is tried, as a
/// natural logarithm.
const NEAR: f64 = 0.1;

/// Inputs that are tried until amount and input fit together.
const ROUNDS: usize = 9;

/// Inputs that are tried with the same particulars of an effect.
const ROUNDS_EACH: usize = 3;

impl Scenario {
    /// A joint that hides the effects of the given names, of [`CATALOGUE`](effects::CATALOGUE),
    /// [`FINER`](effects::FINER) or [`OUTSIDE`](effects::OUTSIDE), each at `strength`; no name,
    /// no effect. The same arguments give the same scenario.
    ///
    /// # Errors
    /// [`ScenarioError`]: for a name that is unknown or there twice, or where an effect
    /// cannot be that strong.
    ///
    /// # Examples
    /// ```
    /// use tauscope_synthetic::scenario::{Noise, Scenario, Strength};
    /// use tauscope_synthetic::simulate;
    ///
    /// let hidden = Scenario::new(&["dead_band"], Strength::Clear, Noise::white(0.05), 1)?;
    /// assert!(hidden.plant.joints[0].effect.get("dead_band").is_some());
    /// assert!(hidden.error_over_noise > 8.0);
    /// let log = simulate(&hidden.plant)?;
    /// assert_eq!(log.joints[0].output.len(), 12_000);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        hidden: &[&str],
        strength: Strength,
        noise: Noise,
        seed: u64,
    ) -> Result<Self, ScenarioError> {
        Self::within(&ideal(seed), hidden, strength, noise)
    }

    /// As [`new`](Self::new), in the first joint of `bare`, which hides nothing yet: what is
    /// drawn follows its seed.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    ///
    /// # Examples
    /// A valve with softly rounded corners:
    /// ```
    /// use tauscope_synthetic::scenario::{Noise, Scenario, Strength, ideal};
    ///
    /// let mut bare = ideal(1);
    /// bare.joints[0].valve_edge = 0.03;
    /// let noise = Noise::white(0.05);
    /// let hidden = Scenario::within(&bare, &["dead_band"], Strength::Clear, noise)?;
    /// assert_eq!(hidden.plant.joints[0].valve_edge, 0.03);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn within(
        bare: &PlantSpec,
        hidden: &[&str],
        strength: Strength,
        noise: Noise,
    ) -> Result<Self, ScenarioError> {
        let effects = hidden.iter().map(|name| HiddenEffect::new(name, bare.seed));
        let mut effects = effects.collect::<Result<Vec<_>, _>>()?;
        for (index, effect) in effects.iter().enumerate() {
            if effects.iter().skip(index + 1).any(|other| other.twin.name == effect.twin.name) {
                return Err(PlantError::Twice { name: effect.twin.name }.into());
            }
        }
        let mut alone = None;
        for effect in &mut effects {
            alone = Some(settle(effect, bare, strength, noise.deviation)?);
        }
        let (given, error_over_noise) = match alone {
            Some(alone) if effects.len() == 1 => alone,
            _ => {
                let given = with_input_for(bare, &effects)?;
                let error = error(&simulate(&with(&given, &effects))?);
                (given, error / noise.deviation)
            }
        };
        let mut plant = with(&given, &effects);
        for joint in &mut plant.joints {
            (joint.noise, joint.noise_correlation) = (noise.deviation, noise.correlation);
        }
        let hidden = effects.iter().map(|effect| effect.twin.name).collect();
        Ok(Self { plant, hidden, error_over_noise })
    }
}

/// A joint that hides nothing, and another one beside it, without noise: gains, delays and
/// levels are drawn by `seed`.
pub fn ideal(seed: u64) -> PlantSpec {
    let mut random = stream(seed, BARE, Purpose::Scenario);
    let joints = ["joint", "other"].map(|name| {
        let input = InputSpec::Levels { levels: levels(&mut random), hold_s: HOLD_S };
        let delay = DelayLaw::Constant { seconds: random.random_range(0.05..0.3) };
        let gain = random.random_range(6.0..12.0);
        JointSpec { gain, range: Some(RANGE), ..JointSpec::new(name, input, delay) }
    });
    PlantSpec { substeps: SUBSTEPS, ..PlantSpec::new(seed, DURATION_S, joints.to_vec()) }
}

/// Zero and some levels of both signs, of which the smallest are small.
fn levels(random: &mut ChaCha8Rng) -> Vec<f64> {
    let step = LARGEST_LEVEL / LEVELS as f64;
    let mut levels = vec![0.0];
    for sign in [1.0, -1.0] {
        for k in 0..LEVELS {
            // What sticks at the smallest only must be a weak effect.
            let part = if k == 0 { (0.16, 0.24) } else { (0.2, 1.0) };
            let level = step * (k as f64 + random.random_range(part.0..part.1));
            levels.push(sign * (100.0 * level).round() / 100.0);
        }
    }
    levels
}

/// `ideal` with `effects` in its first joint.
fn with(ideal: &PlantSpec, effects: &[HiddenEffect]) -> PlantSpec {
    let mut plant = ideal.clone();
    if let Some(joint) = plant.joints.first_mut() {
        let (valve_edge, start) = (joint.valve_edge, joint.start);
        for HiddenEffect { twin, chances, amount, .. } in effects {
            let draw = Draw { strength: *amount, chances: *chances, valve_edge, start };
            joint.put(twin, &(twin.drawn)(&draw));
        }
    }
    plant
}

/// `bare` with given steps, such that the joint with `effects` keeps its range.
fn with_input_for(bare: &PlantSpec, effects: &[HiddenEffect]) -> Result<PlantSpec, PlantError> {
    let made = simulate(&with(bare, effects))?;
    let mut given = bare.clone();
    for joint in &mut given.joints {
        let steps = made.truth.iter().filter(|step| step.joint == joint.name);
        let steps = steps.map(|step| (step.p, step.input_after)).collect();
        (joint.input, joint.range) = (InputSpec::Steps { steps, initial: 0.0 }, None);
    }
    Ok(given)
}

/// Finds the amount of `effect` that makes the error which `strength` means; the plant
/// with the input that goes with it, and the error in deviations of the noise.
///
/// An input that was drawn for another amount may lead the joint too far: then one is drawn
/// for this amount, and the amount found for that input. Where that does not help, the
/// effect gets other particulars.
fn settle(
    effect: &mut HiddenEffect,
    bare: &PlantSpec,
    strength: Strength,
    deviation: f64,
) -> Result<(PlantSpec, f64), ScenarioError> {
    let mut nearest = 0.0;
    for round in 1..=ROUNDS {
        let given = with_input_for(bare, std::slice::from_ref(effect))?;
        let sized = calibrated(effect.clone(), &given, strength, deviation)?;
        (effect.amount, nearest) = (sized.amount, sized.error);
        if strength.holds(sized.error) && sized.reach <= FARTHEST {
            return Ok((given, sized.error));
        }
        if round % ROUNDS_EACH == 0 {
            effect.chances = effect.random.random();
        }
    }
    let (name, [_, wanted, _]) = (effect.twin.name, strength.errors());
    Err(ScenarioError::OutOfReach { name, found: nearest, wanted })
}

/// An amount of an effect, and what it does.
#[derive(Clone, Copy, Debug)]
struct Size {
    amount: f64,
    /// In deviations of the noise.
    error: f64,
    /// Farthest angle, in output units.
    reach: f64,
}

/// The amount of `effect` whose error on one input is nearest to what is wanted.
///
/// The error grows with the amount, about in proportion: the next amount follows from the
/// last one, and where that leaves what is known the middle is taken.
fn calibrated(
    mut effect: HiddenEffect,
    ideal: &PlantSpec,
    strength: Strength,
    deviation: f64,
) -> Result<Size, PlantError> {
    let [_, wanted, _] = strength.errors();
    let (mut too_little, mut too_much) = (LEAST_AMOUNT, 1.0);
    let mut best = Size { amount: effect.amount, error: 0.0, reach: 0.0 };
    let mut nearest = f64::INFINITY;
    for _ in 0..TRIES {
        let made = simulate(&with(ideal, std::slice::from_ref(&effect)))?;
        let found = error(&made) / deviation;
        let ratio = found / wanted;
        let missed = if strength.holds(found) { 0.0 } else { MISSED };
        let distance = ratio.ln().abs() + missed;
        if distance < nearest {
            nearest = distance;
            best = Size { amount: effect.amount, error: found, reach: reach(&made) };
        }
        let side = if ratio < 1.0 { &mut too_little } else { &mut too_much };
        *side = effect.amount;
        if distance < NEAR || too_much / too_little < DISTINCT {
            break;
        }
        let next = effect.amount / ratio;
        let inside = next > too_little && next < too_much;
        effect.amount = if inside { next } else { (too_little * too_much).sqrt() };
    }
    Ok(best)
}

/// Error of the nearest integrator, in output units.
fn error(made: &Simulated) -> f64 {
    made.joints.first().map_or(0.0, integrator::error)
}

/// The farthest that the first joint comes from angle 0, in output units.
fn reach(made: &Simulated) -> f64 {
    let output = made.joints.first().map_or(&[][..], |joint| &joint.output);
    output.iter().fold(0.0, |farthest, angle| angle.abs().max(farthest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scenario(hidden: &[&str], strength: Strength, seed: u64) -> Scenario {
        Scenario::new(hidden, strength, Noise::white(0.05), seed).unwrap()
    }

    #[test]
    fn where_nothing_is_hidden_the_nearest_integrator_is_right() {
        let nothing = scenario(&[], Strength::Clear, 1);
        assert!(nothing.error_over_noise < 0.01, "{}", nothing.error_over_noise);
        assert!(nothing.plant.joints[0].is_plain());
    }

    #[test]
    fn the_same_arguments_give_the_same_plant() {
        let again = || scenario(&["variable_delay"], Strength::Weak, 7);
        assert_eq!(again(), again());
        assert_ne!(again().plant, scenario(&["variable_delay"], Strength::Weak, 8).plant);
    }

    #[test]
    fn what_is_drawn_together_comes_from_different_families() {
        for seed in 0..50 {
            let drawn = draw(3, seed);
            let families = effects::families();
            let family = |name| families.iter().position(|family| family.contains(name));
            let mut families: Vec<_> = drawn.iter().map(family).collect();
            families.sort_unstable();
            families.dedup();
            assert_eq!(families.len(), 3, "{drawn:?}");
        }
    }
}
