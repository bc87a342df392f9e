//! Logs that are started by the step that they are to record, or paused while the valve is switched.

use std::fmt::Write as _;
use std::process::Command;

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

const DELAY_S: f64 = 0.18;
const GAIN: f64 = 7.0;
/// Down it is faster.
const FACTOR: f64 = 1.2;

/// A step up from the neutral of 7.5 % duty for 1.5 s, a second at neutral of which nothing is logged,
/// and a step down, in four runs with other levels, at 50 Hz; the output in steps of 0.05.
fn log() -> String {
    let mut random = ChaCha8Rng::seed_from_u64(8);
    let mut text = "run,t_s,boom.input,boom.output\n".to_owned();
    for (run, level) in [2.0, 1.6, 2.2, 1.8].into_iter().enumerate() {
        let mut place: f64 = 60.0;
        for sample in 0..200_u32 {
            let time_s = f64::from(sample) * 0.02;
            let at = |time_s: f64| match time_s {
                0.0..1.5 => level,
                2.5.. => -level,
                _ => 0.0,
            };
            let acting = at(time_s - DELAY_S);
            let measured = place + 0.02 * random.random_range(-1.0..1.0);
            if at(time_s) != 0.0 {
                let rounded = (measured / 0.05).round() * 0.05;
                writeln!(text, "{run},{time_s:.2},{},{rounded:.3}", 7.5 + at(time_s)).unwrap();
            }
            place += 0.02 * GAIN * acting * if acting < 0.0 { FACTOR } else { 1.0 };
        }
    }
    text
}

#[test]
fn their_delay_is_found_and_no_backlash_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let (data, model) = (folder.path().join("log.csv"), folder.path().join("model.toml"));
    // The neutral is known of a run in which the joint rests.
    let mut text = log();
    for sample in 0..100_u32 {
        writeln!(text, "rest,{:.2},7.5,60.0", 0.02 * f64::from(sample)).unwrap();
    }
    std::fs::write(&data, text).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    command.args(["improve", "--quiet", "--format", "json", "--write"]).args([&model, &data]);
    let output = command.output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let joint = &found["joints"][0];
    let value = |name: &str| joint["parameters"][name]["value"].as_f64().unwrap();
    let named: Vec<_> = joint["conclusion"]["found"].as_array().unwrap().iter().collect();
    assert_eq!(named.len(), 1, "{named:?}");
    assert_eq!(named[0]["effect"], "direction_gain");
    assert!((value("delay") - DELAY_S).abs() < 0.02, "{}", value("delay"));
    assert!((value("gain") / GAIN - 1.0).abs() < 0.03, "{}", value("gain"));
    let factor = value("direction_gain.negative_factor");
    assert!((factor / FACTOR - 1.0).abs() < 0.03, "{factor}");
}
