//! How often the interval of a dead time holds the true one, on joints driven by a joystick.
//!
//! Plants that the fit's own structure is not: rounded dead bands, asymmetric gain, saturation,
//! leakage, gravity, friction, a ringing actuator; with noise of the sensor, an encoder, and a
//! stick of 8 bits that is read at its own rate.

use std::f64::consts::TAU;

use anyhow::Context as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use tauscope::delay::{DeadTime, InputMotion, Settings, dead_time};
use tauscope::synthetic::{PlantSpec, simulate};

/// Records per plant where no number is given.
const RECORDS: u64 = 40;
const SECONDS: f64 = 60.0;

/// A plant: what its joint has, seconds between samples, and samples between looks at the stick.
struct Plant {
    name: &'static str,
    joint: &'static str,
    period_s: f64,
    stick: usize,
}

const PLANTS: [Plant; 10] = [
    Plant { name: "plain", joint: "", period_s: 0.01, stick: 1 },
    Plant { name: "lag", joint: "lag_s = 0.06", period_s: 0.02, stick: 1 },
    Plant {
        name: "dead_band",
        joint: "lag_s = 0.04\ndead_band = [-0.4, 0.3]\nsaturation = 1.5",
        period_s: 0.01,
        stick: 2,
    },
    Plant {
        name: "asymmetric",
        joint: "effect = { direction_gain = { negative_factor = 0.6 }, \
                actuator_lag = { time_constant = 0.05 } }",
        period_s: 0.02,
        stick: 1,
    },
    Plant {
        name: "flow_curve",
        joint: "effect = { flow_curve = { exponent = 1.5 }, dead_band = { lower = -0.3, upper = 0.3 }, \
                actuator_lag = { time_constant = 0.08 } }",
        period_s: 0.05,
        stick: 1,
    },
    Plant {
        name: "leakage",
        joint: "effect = { leakage = { rate = 0.3, rest = 5.0 }, gravity_load = { strength = 0.3, angle = 10.0, \
                creep = 1.0 }, actuator_lag = { time_constant = 0.05 } }",
        period_s: 0.02,
        stick: 1,
    },
    Plant {
        name: "ringing",
        joint: "ringing = { period_s = 0.4, damping = 0.6 }",
        period_s: 0.01,
        stick: 1,
    },
    Plant { name: "slow_log", joint: "lag_s = 0.1", period_s: 0.1, stick: 1 },
    Plant {
        name: "encoder",
        joint: "lag_s = 0.03\nresolution = 0.1\ndead_band = [-0.5, 0.5]",
        period_s: 0.02,
        stick: 3,
    },
    Plant {
        name: "coloured",
        joint: "lag_s = 0.05\nnoise_correlation = 0.8",
        period_s: 0.02,
        stick: 1,
    },
];

/// A stick that somebody moves: sines that come and go, rests in between.
fn joystick(random: &mut ChaCha8Rng, samples: usize, plant: &Plant) -> Vec<f64> {
    let waves: Vec<(f64, f64)> = (0..6)
        .map(|k| {
            (0.08 * 1.7_f64.powi(k) * random.random_range(0.8..1.25), random.random_range(0.0..6.3))
        })
        .collect();
    let rest = random.random_range(0.3..1.0);
    let stick = |k: usize| {
        let time_s = (k / plant.stick * plant.stick) as f64 * plant.period_s;
        let sum: f64 = waves.iter().map(|(hz, phase)| (TAU * hz * time_s + phase).sin()).sum();
        let moved = sum.signum() * (sum.abs() - rest).max(0.0);
        (moved.clamp(-2.0, 2.0) * 64.0).round() / 64.0
    };
    (0..samples).map(stick).collect()
}

/// The dead time of a record with this seed, and the true one.
fn record(plant: &Plant, seed: u64) -> anyhow::Result<(DeadTime, f64, bool)> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let samples = (SECONDS / plant.period_s).round();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand")]
    let input = joystick(&mut random, samples as usize, plant);
    let truth_s = random.random_range(0.04..0.25);
    let mut steps = Vec::new();
    let mut level = 0.0;
    for (value, sample) in input.iter().zip(1..).skip(1) {
        if (value - level).abs() > 0.0 {
            steps.push(format!("[{sample}, {value:?}]"));
            level = *value;
        }
    }
    let spec = PlantSpec::from_toml(&format!(
        "schema = \"tauscope/plant/1\"\nseed = {seed}\nduration_s = {SECONDS}\n\
         sample_period_s = {}\n[[joint]]\nname = \"boom\"\nnoise = 0.05\n\
         input = {{ steps = [{}] }}\ndelay = {{ law = \"constant\", seconds = {truth_s} }}\n{}\n",
        plant.period_s,
        steps.join(", "),
        plant.joint,
    ))?;
    let made = simulate(&spec)?;
    let joint = made.joints.first().context("a joint")?;
    let moves = InputMotion::of(&joint.trials).is_continuous();
    Ok((dead_time(&joint.trials, &Settings::default()), truth_s, moves))
}

/// How often the interval of a dead time holds the true one
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Records of each plant
    #[arg(default_value_t = RECORDS)]
    records: u64,

    /// Only these plants
    #[arg(value_name = "PLANT")]
    plants: Vec<String>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let (records, names) = (args.records, &args.plants);
    let asked = |plant: &&Plant| names.is_empty() || names.iter().any(|name| name == plant.name);
    println!("plant         known  held  median error  median half width  windows known  held");
    for plant in PLANTS.iter().filter(asked) {
        let (mut known, mut held, mut errors, mut halves) = (0, 0, Vec::new(), Vec::new());
        let (mut windows, mut windows_known, mut windows_held) = (0, 0, 0);
        for seed in 1..=records {
            let (found, truth_s, moves) = record(plant, seed)?;
            anyhow::ensure!(moves, "{}: a joystick taken for steps", plant.name);
            let holds = |b: tauscope::delay::Bounds| b.low_s <= truth_s && truth_s <= b.high_s;
            if let Some(bounds) = found.bounds() {
                known += 1;
                held += u32::from(holds(bounds));
                errors.push(bounds.value_s - truth_s);
                halves.push(0.5 * (bounds.high_s - bounds.low_s));
            }
            windows += found.windows.len();
            for bounds in found.windows.iter().filter_map(|window| window.estimate) {
                windows_known += 1;
                windows_held += u32::from(holds(bounds));
            }
        }
        let median = |values: &mut Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
        };
        println!(
            "{:12} {known:6} {:4.0} % {:11.4} s {:16.4} s {windows_known:6} of {windows} {:4.0} %",
            plant.name,
            100.0 * f64::from(held) / f64::from(known.max(1)),
            median(&mut errors),
            median(&mut halves),
            100.0 * f64::from(windows_held) / f64::from(windows_known.max(1)),
        );
    }
    Ok(())
}

#[test]
fn runs() {
    let (found, truth_s, _) = record(&PLANTS[1], 1).unwrap();
    let bounds = found.bounds().unwrap();
    assert!((bounds.value_s - truth_s).abs() < 0.02, "{bounds:?} {truth_s}");
}
