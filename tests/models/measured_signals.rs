//! What a further column of the log has to do with the gain: the pressure of the supply, a force.

use std::fmt::Write as _;

use crate::desk::Desk;
use crate::sample::size;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

/// What the signal does to the joint.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Signal {
    /// Pressure of the supply: the flow follows its root, in both directions.
    Supply,
    /// Force on the joint: it helps in one direction and hinders in the other.
    Force,
    /// Temperature of the room.
    None,
}

/// Two minutes at 100 Hz of a joint with its signal, by Torricelli's law and no equation of a model:
/// `v = 8 u √((p ∓ F) / 200)` with steps of a fine time, a pressure about 200 and a force about 0.
fn log(seed: u64, signal: Signal) -> String {
    const FINE: u32 = 10;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut text = String::from("time_s,boom.input [V],boom.output [deg],boom.p [bar]\n");
    let (mut level, mut until) = (0.0_f64, 0.0);
    let (mut angle, mut waiting) = (0.0_f64, Vec::new());
    let phases: [f64; 3] = std::array::from_fn(|_| random.random_range(0.0..6.0));
    for sample in 0..12_000_u32 {
        let time_s = f64::from(sample) * 0.01;
        if time_s >= until {
            level = f64::from(random.random_range(-8..=8)) * 0.25;
            if angle.abs() > 30.0 && level * angle > 0.0 {
                level = -level;
            }
            until = time_s + random.random_range(0.4..1.6);
        }
        // It wanders with periods that the steps do not have.
        let waves = [11.0, 27.0, 70.0];
        let wave =
            |(period, phase): (&f64, &f64)| (time_s * std::f64::consts::TAU / period + phase).sin();
        let wander: f64 = waves.iter().zip(&phases).map(wave).sum();
        let (middle, size) = if signal == Signal::Force { (0.0, 25.0) } else { (200.0, 20.0) };
        let value = middle + size * wander;
        let noise = random.random_range(-0.08..0.08);
        let measured = value + random.random_range(-1.0..1.0);
        writeln!(text, "{time_s:.2},{level},{},{measured:.2}", angle + noise).unwrap();
        waiting.push(level);
        let acting = waiting[waiting.len().saturating_sub(15)];
        let drop = match signal {
            Signal::Supply => value,
            Signal::Force => 200.0 - acting.signum() * value,
            Signal::None => 200.0,
        };
        let speed = 8.0 * acting * (drop / 200.0).max(0.0).sqrt();
        for _ in 0..FINE {
            angle += speed * 0.01 / f64::from(FINE);
        }
    }
    text
}

fn improved(log: &str) -> (Value, String) {
    let desk = Desk::of_log(log);
    let found = desk.json("improve log.csv --write model.toml --quiet", 0);
    (found["joints"][0].clone(), desk.read("model.toml"))
}

fn value(joint: &Value, name: &str) -> f64 {
    joint["parameters"][format!("signal_gain[p].{name}")]["value"].as_f64().unwrap()
}

#[test]
fn a_pressure_of_the_supply_is_found() {
    let (joint, model) = improved(&log(1, Signal::Supply));
    assert_eq!(joint["effects"], serde_json::json!(["signal_gain[p]"]), "{}", joint["conclusion"]);
    // The root of p / 200 rises by 1 / 400 for each bar at 200.
    for direction in ["positive", "negative"] {
        let slope = value(&joint, direction);
        assert!((slope - 1.0 / 400.0).abs() < 3e-4, "{direction}: {slope}");
    }
    assert_eq!(joint["parameters"]["signal_gain[p].positive"]["unit"], "1/bar");
    assert!(model.contains("kind = \"signal_gain[p]\""), "{model}");
}

#[test]
fn a_force_makes_one_direction_faster_and_the_other_slower() {
    let (joint, _) = improved(&log(2, Signal::Force));
    assert_eq!(joint["effects"], serde_json::json!(["signal_gain[p]"]), "{}", joint["conclusion"]);
    let (positive, negative) = (value(&joint, "positive"), value(&joint, "negative"));
    assert!((positive + 1.0 / 400.0).abs() < 4e-4, "{positive}");
    assert!((negative - 1.0 / 400.0).abs() < 4e-4, "{negative}");
}

#[test]
fn a_signal_that_does_nothing_is_not_named() {
    for seed in 3..size(5, 9) {
        let (joint, _) = improved(&log(seed, Signal::None));
        assert_eq!(joint["effects"], serde_json::json!([]), "{seed}: {}", joint["conclusion"]);
    }
}
