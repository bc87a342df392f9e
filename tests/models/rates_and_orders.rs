//! What is named of a joint does not depend on the rate of its log, the order of its trials or which of
//! them are held back.

use std::fmt::Write as _;
use std::sync::LazyLock;

use crate::desk::Desk;
use crate::sample::size;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const DELAY_S: f64 = 0.2;
/// The same in samples.
const DELAY: usize = 20;
const GAIN: f64 = 4.0;
/// Half of the overlap, V.
const BAND: f64 = 0.4;
/// What opens the valve as far as it goes, V.
const LIMIT: f64 = 1.6;
/// Speed backwards over that forwards.
const BACKWARDS: f64 = 0.7;
const TRIALS: u32 = 7;
const PERIOD_S: f64 = 0.01;

/// The flow of an overlapped valve that opens up to a limit, with rounded corners: `√(x² + r²)` in the
/// place of `|x|`.
fn flow(input: f64) -> f64 {
    let opening = |x: f64| ramp(x - BAND) - ramp(x - LIMIT);
    opening(input) - opening(-input)
}

/// The flow of an overlapped valve to a cylinder with one rod: less backwards.
fn flow_by_direction(input: f64) -> f64 {
    ramp(input - BAND) - BACKWARDS * ramp(-input - BAND)
}

fn ramp(x: f64) -> f64 {
    const ROUND: f64 = 0.02;
    0.5 * (x + x.hypot(ROUND))
}

/// Rows of each trial at 100 Hz, 15 s in the small sample and 25 s in the whole one: random steps of 0.5 to 1.5 s; the sensor is noisy.
fn trials(flow: impl Fn(f64) -> f64) -> Vec<Vec<String>> {
    let mut random = ChaCha8Rng::seed_from_u64(20);
    let trial = |trial: u32| {
        let (mut place, mut level, mut left) = (0.0, 0.0, 100_u32);
        let mut inputs: Vec<f64> = Vec::new();
        let row = |sample: u32| {
            if left == 0 {
                left = random.random_range(50..150);
                level = (random.random_range(-2.5..2.5_f64) * 20.0).round() / 20.0;
                // Back from far out, as who drives it does.
                let is_far_out = f64::abs(place) > 12.0 && place * level > 0.0;
                level = if is_far_out { -level } else { level };
            }
            left -= 1;
            inputs.push(level);
            let measured = place + 0.02 * random.random_range(-1.0..1.0);
            let late = inputs.len().checked_sub(DELAY + 1);
            place += PERIOD_S * GAIN * flow(late.map_or(0.0, |index| inputs[index]));
            format!("{trial},{:.2},{level},{measured:.4}", PERIOD_S * f64::from(sample))
        };
        (0..size(1500, 2500)).map(row).collect()
    };
    (0..TRIALS).map(trial).collect()
}

/// What `improve` names in a log of each `every`-th row of `trials`, sorted; and the delay.
fn named(trials: &[Vec<String>], every: usize, options: &str) -> (Vec<String>, f64) {
    let mut text = "trial,t_s,boom.input,boom.output\n".to_owned();
    for row in trials.iter().flat_map(|rows| rows.iter().step_by(every)) {
        writeln!(text, "{row}").unwrap();
    }
    let improve = format!("improve log.csv --write model.toml --quiet {options}");
    let found = Desk::of_log(&text).json(&improve, 0);
    let joint = &found["joints"][0];
    let named = joint["conclusion"]["found"].as_array().unwrap().iter();
    let mut named: Vec<_> = named.map(|one| one["effect"].as_str().unwrap().to_owned()).collect();
    named.sort_unstable();
    (named, joint["parameters"]["delay"]["value"].as_f64().unwrap())
}

fn assert_finds_both((named, delay_s): &(Vec<String>, f64), within_s: f64) {
    assert_eq!(named, &["dead_band", "input_saturation"]);
    assert!((delay_s - DELAY_S).abs() < within_s, "{delay_s} s");
}

/// What is named at 50 Hz, with the trials as they were logged.
static AT_50_HZ: LazyLock<(Vec<String>, f64)> = LazyLock::new(|| named(&trials(flow), 2, ""));

/// A step of the input is logged up to a sample late.
#[test]
fn the_same_is_named_at_100_50_and_20_hz() {
    let trials = trials(flow);
    assert_finds_both(&named(&trials, 1, ""), 0.012);
    assert_finds_both(&AT_50_HZ, 0.025);
    assert_finds_both(&named(&trials, 5, ""), 0.055);
}

#[test]
fn the_order_of_the_trials_and_what_is_held_back_change_no_name() {
    let mut trials = trials(flow);
    assert_finds_both(&named(&trials, 2, "--split 0.6"), 0.025);
    trials.rotate_left(3);
    trials.swap(0, 4);
    let reordered = named(&trials, 2, "");
    assert_eq!(AT_50_HZ.0, reordered.0);
    // The same trials are held back: the same fit but for where its search ends.
    assert!((AT_50_HZ.1 - reordered.1).abs() < 1e-4, "{} s, {} s", AT_50_HZ.1, reordered.1);
}

/// Friction with the one viscous part or the other would follow it as well: without inertia the two are
/// an overlap and a gain by direction.
#[test]
fn an_overlap_and_a_gain_by_direction_are_no_friction_at_100_and_50_hz() {
    let trials = trials(flow_by_direction);
    // In the small sample at 100 Hz alone.
    for every in size(&[1][..], &[1, 2]) {
        let (named, _) = named(&trials, *every, "");
        assert_eq!(named, ["dead_band", "direction_gain"]);
    }
}
