//! `tauscope compare` as a user sees it, on joints of the synthetic plant, which shares no
//! equation with the models.

use std::fmt::Write as _;
use std::process::Output;

use crate::desk::{Desk, banded};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use serde_json::Value;
use tauscope::synthetic::{JointSpec, PlantSpec};

/// A desk with 80 s of one joint at 100 Hz.
fn desk(joint: impl FnOnce(JointSpec) -> JointSpec) -> Desk {
    Desk::of(&PlantSpec::new(11, 80.0, vec![joint(crate::desk::joint("boom"))]))
}

/// Writes a model of the joint that is a little off.
fn write_model(desk: &Desk, name: &str, effects: &str) {
    let text = format!(
        "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
         parameters = {{ gain = 9.0, delay = 0.1 }}\n{effects}"
    );
    desk.write(name, &text);
}

fn run(desk: &Desk, arguments: &str) -> Output {
    desk.run(&format!("compare log.csv {arguments}"))
}

/// The joint in the JSON of a run that went well.
fn compared(desk: &Desk, arguments: &str) -> Value {
    let json = desk.json(&format!("compare log.csv {arguments}"), 0);
    assert_eq!(json["schema"], "tauscope/compare/1");
    json["joints"][0].clone()
}

const LAG: &str = "[[joint.boom.effect]]\nkind = \"actuator_lag\"\n";

#[test]
fn a_plain_integrator_is_recovered_and_adequate() {
    let joint = compared(&desk(|joint| joint), "");
    let parameter = |name: &str| joint["parameters"][name].clone();
    let near = |name: &str, truth: f64| {
        let (value, error) =
            (parameter(name)["value"].as_f64(), parameter(name)["std_error"].as_f64());
        let (value, error) = (value.unwrap(), error.unwrap());
        assert!((value - truth).abs() < 4.0 * error, "{name}: {value} ± {error}");
    };
    near("gain", 10.0);
    near("delay", 0.12);
    assert_eq!(parameter("gain")["unit"], "deg/s/V");
    assert_eq!(joint["lack_of_fit"]["adequate"], true);
    let noise = joint["error"]["noise_floor"].as_f64().unwrap();
    assert!((noise - 0.05).abs() < 0.005, "{noise}");
    let validation = joint["error"]["validation"]["rmse"].as_f64().unwrap();
    assert!(validation < 1.1 * 0.05, "{validation}");
    let regions = joint["regions"].as_array().unwrap();
    for feature in ["input", "direction", "output", "speed", "since_step", "hold", "time"] {
        let of = regions.iter().filter(|region| region["feature"] == feature);
        let share = |name: &str| of.clone().map(|r| r[name].as_f64().unwrap()).sum::<f64>();
        for name in ["share_of_time", "share_of_squared_error"] {
            assert!((share(name) - 1.0).abs() < 1e-9, "{feature}: {name}");
        }
    }
}

#[test]
fn a_lag_is_missed_and_then_not() {
    let desk = desk(|joint| JointSpec { lag_s: Some(0.08), ..joint });
    write_model(&desk, "lag.toml", LAG);
    let plain = compared(&desk, "");
    assert_eq!(plain["lack_of_fit"]["adequate"], false);
    let with_lag = compared(&desk, "--model lag.toml --fit");
    assert_eq!(with_lag["effects"], serde_json::json!(["actuator_lag"]));
    assert_eq!(with_lag["lack_of_fit"]["adequate"], true);
    let lag = with_lag["parameters"]["actuator_lag.time_constant"]["value"].as_f64().unwrap();
    assert!((lag - 0.08).abs() < 0.005, "{lag}");
    let rmse = |joint: &Value| joint["error"]["validation"]["rmse"].as_f64().unwrap();
    assert!(rmse(&with_lag) < 0.6 * rmse(&plain));
}

#[test]
fn a_model_is_taken_as_it_is_unless_it_is_to_be_fitted() {
    let desk = desk(|joint| joint);
    write_model(&desk, "mine.toml", "");
    let given = compared(&desk, "--model mine.toml");
    assert_eq!(given["parameters"]["gain"]["value"], 9.0);
    let fitted = compared(&desk, "--model mine.toml --fit");
    assert!((fitted["parameters"]["gain"]["value"].as_f64().unwrap() - 10.0).abs() < 0.1);
}

#[test]
fn a_short_horizon_makes_the_error_of_an_integrator_smaller() {
    let desk = desk(|joint| JointSpec { dead_band: Some([-0.3, 0.3]), ..joint });
    let rmse =
        |arguments: &str| compared(&desk, arguments)["error"]["train"]["rmse"].as_f64().unwrap();
    assert!(rmse("--horizon steps") < rmse("--horizon free"));
}

/// A log of two joints on one pump: `boom` loses `droop` of its speed while `stick` is
/// driven as hard as ever, integrated in small steps; `stick` has levels of its own.
fn two_joints(droop: f64) -> String {
    const SAMPLES: usize = 3000;
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let levels = [-2.0, -1.0, 0.0, 1.0, 2.0];
    let mut held = |shortest: usize| -> Vec<f64> {
        let mut levels_held = Vec::new();
        while levels_held.len() < SAMPLES {
            let level = levels[random.random_range(0..levels.len())];
            let samples = shortest + random.random_range(0..100);
            levels_held.extend(std::iter::repeat_n(level, samples));
        }
        levels_held
    };
    let (boom, stick) = (held(60), held(90));
    let mut log =
        String::from("time_s,boom.input [V],boom.output [deg],stick.input,stick.output\n");
    let (mut angles, mut noise) = ([0.0, 0.0], || -> f64 { StandardNormal.sample(&mut random) });
    for k in 0..SAMPLES {
        let measured = angles.map(|angle| angle + 0.05 * noise());
        let (u, other) = (boom[k], stick[k]);
        writeln!(log, "{},{u},{},{other},{}", k as f64 / 100.0, measured[0], measured[1]).unwrap();
        for part in 0..10 {
            // Twelve samples and a half late.
            let late = (10 * k + part).checked_sub(125).map_or(0.0, |at| boom[at / 10]);
            angles[0] += 8.0 * late * (1.0 - droop * other.abs() / 2.0) * 0.001;
            angles[1] += 5.0 * other * 0.001;
        }
    }
    log
}

#[test]
fn a_joint_that_slows_down_while_another_moves_is_seen_to() {
    let droop = "[[joint.boom.effect]]\nkind = \"supply_droop\"\n";
    let desk = desk(|joint| joint);
    write_model(&desk, "droop.toml", droop);
    desk.write("log.csv", &two_joints(0.3));
    let output = run(&desk, "--model droop.toml --fit --format json");
    // `stick` is not in the model file, which is said.
    assert_eq!(output.status.code(), Some(1));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let joint = &json["joints"][0];
    let of = |name: &str| joint["parameters"][name].clone();
    for (name, truth) in [("supply_droop.droop", 0.3), ("gain", 8.0), ("delay", 0.125)] {
        let (value, error) = (of(name)["value"].as_f64(), of(name)["std_error"].as_f64());
        let (value, error) = (value.unwrap(), error.unwrap());
        assert!(
            (value - truth).abs() < 4.0 * error && error < 0.02 * truth,
            "{name}: {value} ± {error}"
        );
    }
    assert_eq!(joint["lack_of_fit"]["adequate"], true);
    // Asked for alone, it is still seen beside the others.
    let alone = compared(&desk, "--joint boom --model droop.toml --fit");
    assert_eq!(&alone, joint);
    // A joint that is not in the log cannot be seen to move.
    let mapped = "--joint boom=boom.input:boom.output --model droop.toml --fit";
    assert_eq!(compared(&desk, mapped)["lack_of_fit"]["adequate"], false);
}

#[test]
fn what_is_left_of_a_good_model_is_white_and_free_of_the_input() {
    const FREE: &str = "--horizon free --split 0.7";
    let desk = desk(|joint| joint);
    let joint = compared(&desk, FREE);
    let (white, input) = (&joint["whiteness"], &joint["input_correlation"]);
    assert!(white["p_value"].as_f64().unwrap() > 0.01);
    let band = white["band"].as_f64().unwrap();
    let outside = |correlations: &Value, band: f64| {
        let all: Vec<f64> = serde_json::from_value(correlations.clone()).unwrap();
        (all.iter().filter(|r| r.abs() > band).count(), all.len())
    };
    let (found, lags) = outside(&white["correlation"], band);
    assert!(lags == 200 && found <= 8, "{found} of {lags}");
    assert_eq!((&input["first_lag_s"], &input["lag_step_s"]), (&(-2.0).into(), &0.01.into()));
    for side in ["acting", "raw"] {
        assert!(input[side]["p_value"].as_f64().unwrap() > 0.01, "{side}");
        let (found, lags) =
            outside(&input[side]["correlation"], input[side]["band"].as_f64().unwrap());
        let share = input[side]["share_outside"].as_f64().unwrap();
        assert!(lags == 401 && (share - found as f64 / 401.0).abs() < 1e-12);
    }
    let text = String::from_utf8(run(&desk, FREE).stdout).unwrap();
    assert!(text.contains("boom (integrator): white (p = "), "{text}");
}

#[test]
fn a_delay_that_is_too_short_shows_right_after_the_steps_act() {
    // The true delay is 0.12 s.
    let late = "[joint.boom]\nstructure = \"integrator\"\n\
                parameters = { gain = 10.0, delay = 0.06 }\n";
    let desk = desk(|joint| joint);
    let text = format!("schema = \"tauscope/model/1\"\n{late}");
    desk.write("late.toml", &text);
    let joint = compared(&desk, "--model late.toml");
    let correlation = |side: &str| {
        let of = &joint["input_correlation"][side];
        let all: Vec<f64> = serde_json::from_value(of["correlation"].clone()).unwrap();
        let (band, middle) = (of["band"].as_f64().unwrap(), all.len() / 2);
        let far = all.iter().enumerate().filter(|(_, r)| r.abs() > 2.0 * band);
        far.map(|(place, _)| place as f64 - middle as f64).collect::<Vec<_>>()
    };
    assert_eq!(correlation("acting"), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(correlation("raw"), [7.0, 8.0, 9.0, 10.0, 11.0, 12.0]);
    let acting = &joint["input_correlation"]["acting"];
    assert!(acting["p_value"].as_f64().unwrap() < 1e-9, "{acting}");
    assert!((0.01..0.07).contains(&acting["peak_lag_s"].as_f64().unwrap().abs()), "{acting}");
}

#[test]
fn model_files_that_cannot_be_used_say_why() {
    let desk = desk(|joint| joint);
    let dead_band = "[[joint.boom.effect]]\nkind = \"dead_band\"\nparameters =";
    write_model(&desk, "effect.toml", "[[joint.boom.effect]]\nkind = \"dead_bnd\"\n");
    write_model(&desk, "parameter.toml", &format!("{dead_band} {{ upr = 1 }}\n"));
    write_model(&desk, "bounds.toml", &format!("{dead_band} {{ upper = -1 }}\n"));
    write_model(&desk, "key.toml", "colour = \"red\"\n");
    for (file, parts) in [
        ("missing.toml", vec!["missing.toml"]),
        ("effect.toml", vec!["boom", "dead_bnd", "dead_band"]),
        ("parameter.toml", vec!["boom", "dead_band", "upr", "upper"]),
        ("bounds.toml", vec!["boom", "dead_band.upper", "-1"]),
        ("key.toml", vec!["key.toml", "colour"]),
    ] {
        let stderr = desk.refusal(&format!("compare log.csv --model {file}"));
        for part in parts {
            assert!(stderr.contains(part), "no {part} in {stderr}");
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let desk = desk(|joint| JointSpec { lag_s: Some(0.05), ..joint });
    let run = |threads: &str| run(&desk, &format!("--format json --threads {threads}")).stdout;
    assert_eq!(run("1"), run("2"));
}

#[test]
fn where_the_output_follows_the_input_no_error_is_one_of_the_speed() {
    // A first order of 0.3 s after 0.1 s, which saturates at the highest of its levels.
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut log = "time_s,boom.input,boom.output\n".to_owned();
    let (mut y, mut level, mut late) = (0.0, 0.0, vec![0.0; 10]);
    for k in 0..12_000 {
        if k % 400 == 0 {
            level = f64::from(random.random_range(0..8)) - 2.0;
        }
        late.push(level);
        y += 0.01 / 0.3 * (late.remove(0).min(4.0) - y);
        let noise: f64 = StandardNormal.sample(&mut random);
        writeln!(log, "{},{level},{}", f64::from(k) * 0.01, y + 0.01 * noise).unwrap();
    }
    let desk = desk(|spec| spec);
    desk.write("log.csv", &log);
    let model = "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
                 parameters = { gain = 3.0, delay = 0.1 }\n[[joint.boom.effect]]\nkind = \"leakage\"\n\
                 parameters = { rate = 3.0, y0 = 0.0 }\n";
    desk.write("leaky.toml", model);
    let text = String::from_utf8(run(&desk, "--model leaky.toml --quiet").stdout).unwrap();
    assert!(text.contains("where the error arises (free run):"), "{text}");
    assert!(text.contains("of the squared error, in"), "{text}");
    assert!(!text.contains("of the speed"), "{text}");
}

#[test]
fn a_joint_without_a_model_is_said_with_the_file_and_the_joints_that_it_has() {
    let desk = Desk::with(vec![banded("boom")]);
    let model = "schema = \"tauscope/model/1\"\n[joint.bom]\nstructure = \"integrator\"\nparameters = { gain = 1.0, delay = 0.1 }\n";
    desk.write("model.toml", model);
    let refused = desk.refusal("compare log.csv --model model.toml");
    let expected = "joint `boom`: model.toml has no model of it, but of bom";
    assert!(refused.contains(expected), "{refused}");
}
