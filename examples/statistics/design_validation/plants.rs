//! Joints with physics of their own.

use anyhow::Context as _;
use rand::RngExt as _;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use tauscope::design::Schedule;
use tauscope::synthetic::{CylinderSpec, DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};
use tauscope::{Joint, Trial};

use super::machine::Machine;
use super::machines::{Source, log, machine};

/// A joint that was logged, and what is special about it.
pub(crate) struct Drawn {
    pub(crate) plant: Plant,
    pub(crate) log: Joint,
    /// What moves it, in a word: the rows of the table.
    pub(crate) kind: &'static str,
    /// Everything that is hidden in it.
    pub(crate) hidden: Vec<&'static str>,
}

/// Samples per second of a log.
const RATE_HZ: f64 = 50.0;

/// What is played on.
pub(crate) enum Plant {
    /// One of the synthetic plants.
    Synthetic(Box<PlantSpec>),
    /// One by equations of its own.
    Machine(Machine),
}

/// The kinds of joints, of which each makes up its part of ten.
pub(crate) const KINDS: [&str; 6] =
    ["catalogue", "outside the catalogue", "cylinder", "strokes", "steps", "first order"];

/// The joint number `seed`.
pub(crate) fn drawn(seed: u64) -> anyhow::Result<Drawn> {
    match seed % 10 {
        0..=3 => synthetic(seed),
        4 | 5 => of_machine(seed, Source::Strokes, "strokes"),
        6 | 7 => of_machine(seed, Source::Steps, "steps"),
        _ => of_machine(seed, Source::FirstOrder, "first order"),
    }
}

/// A machine with a log of it.
fn of_machine(seed: u64, source: Source, kind: &'static str) -> anyhow::Result<Drawn> {
    let mut chance = Chance(ChaCha8Rng::seed_from_u64(seed));
    let (machine, hidden) = machine(source, &mut chance);
    let log = log(&machine, source, &mut chance)?;
    Ok(Drawn { plant: Plant::Machine(machine), log, kind, hidden })
}

impl Plant {
    /// The output, without noise, while `schedule` is played as the trial number `trial`, from
    /// `start` on, or from where it settles.
    pub(crate) fn played(
        &self,
        start: f64,
        schedule: &Schedule,
        trial: u64,
    ) -> anyhow::Result<Vec<f64>> {
        /// The delays of the play are others than those of the log.
        const ANOTHER: u64 = 1_000_000;
        let input = schedule.input();
        let mut plant = match self {
            Self::Machine(machine) => {
                let settled = machine.settled(input.first().copied().unwrap_or(0.0));
                return Ok(machine.run(&input, settled.unwrap_or(start)));
            }
            Self::Synthetic(plant) => plant.clone(),
        };
        let joint = plant.joints.first_mut().context("a joint")?;
        let steps = schedule.starts().into_iter().skip(1).collect();
        joint.input = InputSpec::Steps { steps, initial: 0.0 };
        (joint.start, joint.range, joint.noise) = (start, None, 0.0);
        plant.duration_s = schedule.duration_s();
        plant.seed += ANOTHER * (trial + 1);
        let trials = simulate(&plant)?.joints.remove(0).trials;
        Ok(trials.first().map_or(&[][..], Trial::output).to_vec())
    }
}

/// A synthetic plant with a log of it.
fn synthetic(seed: u64) -> anyhow::Result<Drawn> {
    let mut chance = Chance(ChaCha8Rng::seed_from_u64(seed));
    let is_cylinder = seed.is_multiple_of(10);
    let mut joint = if is_cylinder { cylinder(&mut chance) } else { joint(&mut chance) };
    let mut hidden = Vec::new();
    if !is_cylinder {
        hidden = hide(&mut joint, &mut chance)?;
    }
    let duration_s = chance.between(40.0, 70.0).round();
    let outside = ["creep_memory", "sticky_spot", "input_notch", "sensor_nonlinearity"];
    let is_outside = hidden.iter().any(|name| outside.contains(name));
    let kind = if is_cylinder {
        "cylinder"
    } else if is_outside {
        "outside the catalogue"
    } else {
        "catalogue"
    };
    let plant = PlantSpec::new(seed, duration_s, vec![joint]);
    let plant = PlantSpec { sample_period_s: 1.0 / RATE_HZ, ..plant };
    let log = simulate(&plant).with_context(|| format!("seed {seed}"))?.joints.remove(0);
    Ok(Drawn { plant: Plant::Synthetic(Box::new(plant)), log, kind, hidden })
}

/// Random numbers.
pub(crate) struct Chance(pub(crate) ChaCha8Rng);

impl Chance {
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    pub(crate) fn is(&mut self, probability: f64) -> bool {
        self.0.random::<f64>() < probability
    }
}

/// A joint with a gain, a dead band and a lag.
fn joint(chance: &mut Chance) -> JointSpec {
    let middle = chance.between(0.8, 1.4);
    let levels = vec![-2.0, -middle, 0.0, middle, 2.0];
    let input = InputSpec::Levels { levels, hold_s: [0.5, chance.between(1.5, 2.5)] };
    let shortest = chance.between(0.05, 0.25);
    let delay = DelayLaw::Uniform { min: shortest, max: shortest + chance.between(0.0, 0.05) };
    JointSpec {
        gain: chance.between(5.0, 15.0),
        range: Some([-45.0, 45.0]),
        dead_band: chance.is(0.5).then(|| [-chance.between(0.1, 0.5), chance.between(0.1, 0.5)]),
        lag_s: chance.is(0.5).then(|| chance.between(0.05, 0.25)),
        noise: chance.between(0.02, 0.1),
        ..JointSpec::new("boom", input, delay)
    }
}

/// A joint that a cylinder moves, of which some numbers differ from one to the next.
fn cylinder(chance: &mut Chance) -> JointSpec {
    let full = chance.between(6.0, 10.0).round();
    let levels = vec![-full, -0.5 * full, 0.0, 0.5 * full, full];
    let input = InputSpec::Levels { levels, hold_s: [0.5, 2.0] };
    let delay = DelayLaw::Constant { seconds: chance.between(0.05, 0.15) };
    let usual = CylinderSpec::default();
    let cylinder = CylinderSpec {
        overlap: chance.between(0.02, 0.08),
        supply_bar: chance.between(160.0, 220.0),
        mass_kg: chance.between(400.0, 1200.0),
        leakage_l_min: chance.between(0.05, 1.0),
        ..usual
    };
    JointSpec {
        start: 20.0,
        range: Some([-15.0, 60.0]),
        cylinder: Some(cylinder),
        noise: chance.between(0.02, 0.05),
        ..JointSpec::new("boom", input, delay)
    }
}

/// Hides two to four effects in `joint`, of which one may be none of the catalogue.
fn hide(joint: &mut JointSpec, chance: &mut Chance) -> anyhow::Result<Vec<&'static str>> {
    let mut names = vec![
        "direction_gain",
        "gravity_load",
        "leakage",
        "flow_curve",
        "thermal_drift",
        "input_saturation",
        "stiction",
        "coulomb_friction",
        "position_gain",
        "backlash",
        "resonance",
        "input_offset",
        "creep_memory",
        "sticky_spot",
        "input_notch",
        "sensor_nonlinearity",
    ];
    let count = 2 + usize::from(chance.is(0.5)) + usize::from(chance.is(0.5));
    let mut hidden = Vec::new();
    for _ in 0..count {
        let place = chance.0.random_range(0..names.len());
        let name = names.swap_remove(place);
        let numbers = numbers(name, chance);
        let numbers: Vec<(String, f64)> =
            numbers.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        joint.hide(name, &numbers).with_context(|| name.to_owned())?;
        hidden.push(name);
    }
    Ok(hidden)
}

/// The numbers of an effect that a machine may have.
fn numbers(name: &str, chance: &mut Chance) -> Vec<(&'static str, f64)> {
    match name {
        "direction_gain" => vec![("negative_factor", chance.between(0.6, 1.5))],
        "gravity_load" => vec![
            ("kappa", chance.between(0.1, 0.4)),
            ("y0", chance.between(-30.0, 30.0)),
            ("creep", chance.between(0.0, 0.6)),
        ],
        "leakage" => vec![("rate", chance.between(0.01, 0.1)), ("y0", chance.between(-20.0, 20.0))],
        "flow_curve" => vec![("exponent", chance.between(0.7, 1.6))],
        "thermal_drift" => {
            let change = chance.between(-0.2, 0.3);
            vec![("change", change), ("time_constant", chance.between(30.0, 70.0))]
        }
        "input_saturation" => vec![("limit", chance.between(1.2, 2.2)), ("sharpness", 8.0)],
        "stiction" => {
            let start = chance.between(0.2, 0.6);
            vec![("start", start), ("stop", 0.5 * start)]
        }
        "coulomb_friction" => vec![
            ("positive", chance.between(0.1, 0.4)),
            ("negative", chance.between(0.1, 0.4)),
            ("time_constant", chance.between(0.05, 0.2)),
        ],
        "position_gain" => vec![
            ("ratio", chance.between(0.2, 0.4)),
            ("mount", 90.0 + chance.between(-35.0, 35.0)),
            ("leverage", chance.between(0.2, 0.6)),
            ("reference", 0.0),
        ],
        "backlash" => vec![("width", chance.between(0.2, 1.5))],
        "resonance" => {
            vec![("period", chance.between(0.2, 0.8)), ("damping", chance.between(0.1, 0.3))]
        }
        "input_offset" => vec![("offset", chance.between(-0.15, 0.15))],
        "creep_memory" => vec![("share", chance.between(0.05, 0.25))],
        "sticky_spot" => {
            let from = chance.between(-20.0, 15.0);
            vec![("from", from), ("to", from + 10.0), ("share", chance.between(0.4, 0.8))]
        }
        "input_notch" => {
            let from = chance.between(0.6, 1.2);
            vec![("from", from), ("to", from + 0.5), ("share", chance.between(0.4, 0.8))]
        }
        _ => vec![
            ("amplitude", chance.between(0.5, 2.0)),
            ("period", chance.between(30.0, 60.0)),
            ("zero", chance.between(-40.0, 40.0)),
        ],
    }
}
