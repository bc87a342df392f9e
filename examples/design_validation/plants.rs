//! Joints with physics of their own.

use anyhow::Context as _;
use rand::RngExt as _;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use tauscope::synthetic::{CylinderSpec, DelayLaw, InputSpec, JointSpec, PlantSpec};

/// A joint to be logged, and what is special about it.
pub(crate) struct Drawn {
    pub(crate) plant: PlantSpec,
    /// What moves it, in a word: the rows of the table.
    pub(crate) kind: &'static str,
    /// Everything that is hidden in it.
    pub(crate) hidden: Vec<&'static str>,
}

/// Samples per second of a log.
const RATE_HZ: f64 = 50.0;

/// Every how many joints one is moved by a cylinder.
const CYLINDERS: u64 = 5;

/// The joint number `seed`.
pub(crate) fn drawn(seed: u64) -> anyhow::Result<Drawn> {
    let mut chance = Chance(ChaCha8Rng::seed_from_u64(seed));
    let is_cylinder = seed.is_multiple_of(CYLINDERS);
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
    Ok(Drawn { plant: PlantSpec { sample_period_s: 1.0 / RATE_HZ, ..plant }, kind, hidden })
}

/// Random numbers.
struct Chance(ChaCha8Rng);

impl Chance {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    fn is(&mut self, probability: f64) -> bool {
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
