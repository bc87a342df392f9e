//! `tauscope explain` as a user sees it.

use std::fmt::Write as _;

use crate::desk::{Desk, assert_fields, banded, fields, joint, number};
use serde_json::json;
use tauscope::synthetic::{DelayLaw, JointSpec};

#[test]
fn a_missing_dead_band_is_named_with_its_numbers_and_its_command_works() {
    let desk = Desk::with(vec![banded("boom")]);
    let json = desk.json("explain log.csv", 0);
    assert_eq!(json["schema"], "tauscope/explain/1");
    let boom = &json["joints"][0];
    assert_fields(
        boom,
        "joint revision effects parameters error lack_of_fit fails_where worst_segments verdict \
         ranking",
    );
    assert_eq!(boom["verdict"], "missing_effect");
    let first = &boom["ranking"][0];
    assert_fields(
        first,
        "effect validation_rmse error_reduction_percent p_value parameters \
         indistinguishable_from share_of_misfit equation",
    );
    assert_eq!(first["effect"], "dead_band");
    assert_eq!(fields(&first["parameters"]), ["lower", "upper"]);
    let upper = &first["parameters"]["upper"];
    let error = number(&upper["std_error"]);
    assert!((number(&upper["value"]) - 0.3).abs() < 4.0 * error && error < 0.01, "{upper}");
    assert_eq!(upper["unit"], "V");
    assert!(number(&first["error_reduction_percent"]) > 80.0);
    assert!(number(&first["p_value"]) < 1e-6);
    let ranked = boom["ranking"].as_array().unwrap();
    assert!(ranked.len() > 1, "{ranked:?}");

    let words = boom["in_words"].as_str().unwrap();
    for part in
        ["out = max(in - upper, 0)", "lower = -0.", " ± ", " V", "The residual is largest in "]
    {
        assert!(words.contains(part), "no `{part}` in: {words}");
    }
    assert_eq!(boom["commands"], json!(["tauscope add dead_band log.csv --model model.toml"]));
    let command = boom["commands"][0].as_str().unwrap().strip_prefix("tauscope ").unwrap();
    let added = desk.json(command, 0);
    let after = number(&added["joints"][0]["error"]["validation"]["rmse"]);
    let promised = number(&first["validation_rmse"]);
    assert!((after - promised).abs() < 0.01 * promised, "{after}, not {promised}");
    let next = desk.json("explain log.csv --model model.toml", 0);
    assert_eq!(next["joints"][0]["verdict"], "adequate");
    assert_eq!(next["joints"][0]["revision"], 1);
}

#[test]
fn noise_of_the_input_and_spikes_of_the_sensor_hide_no_effect() {
    let desk = Desk::with(vec![banded("boom")]);
    let mut row = 0.0_f64;
    let line = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let &[time, input, output] = &cells[..] else { return line.to_owned() };
        let Ok(level) = input.parse::<f64>() else { return line.to_owned() };
        row += 1.0;
        let noise = 0.02 * ((row * 12.9898).sin() * 43_758.545_3).fract();
        let output = if (row - 600.0).abs() < 0.5 { "-9999" } else { output };
        format!("{time},{:.5},{output}", level + noise)
    };
    let log: Vec<String> = desk.read("log.csv").lines().map(line).collect();
    desk.write("log.csv", &(log.join("\n") + "\n"));
    let done = desk.run("explain log.csv --format json");
    let json: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(json["joints"][0]["ranking"][0]["effect"], "dead_band");
    let notes = String::from_utf8(done.stderr).unwrap();
    assert!(
        notes
            .contains("1 sample is an isolated spike of the sensor: excluded from fits and errors")
    );
    assert!(notes.contains("the input has noise or glitches"), "{notes}");
}

#[test]
fn an_integrator_lacks_nothing_and_its_limits_are_said() {
    let desk = Desk::with(vec![joint("boom")]);
    let boom = &desk.json("explain log.csv", 0)["joints"][0];
    assert_eq!(boom["verdict"], "adequate");
    assert_eq!(boom["ranking"], json!([]));
    assert_eq!(boom["commands"], json!([]));
    let words = boom["in_words"].as_str().unwrap();
    assert!(words.contains("No lack of fit is shown") && words.contains("the noise"));
    assert!(words.contains("input -1.5 to 1.5 V"), "{words}");
    let text = String::from_utf8(desk.run("explain log.csv").stdout).unwrap();
    assert!(text.starts_with("boom: no missing effect found\n"), "{text}");
}

#[test]
fn what_no_effect_explains_is_not_given_the_nearest_name() {
    let delay = DelayLaw::Uniform { min: 0.02, max: 0.5 };
    let desk = Desk::with(vec![JointSpec { delay, ..joint("boom") }]);
    let effects = "--effects dead_band,thermal_drift,input_offset";
    let boom = &desk.json(&format!("explain log.csv {effects}"), 0)["joints"][0];
    assert_eq!(boom["verdict"], "unexplained");
    assert_eq!(boom["ranking"].as_array().unwrap().len(), 3);
    assert_eq!(boom["commands"], json!([]));
    let words = boom["in_words"].as_str().unwrap();
    assert!(!words.contains("is missing"), "{words}");
    for part in ["The residual is largest in ", "For effects that are significant only together"] {
        assert!(words.contains(part), "no `{part}` in: {words}");
    }
}

#[test]
fn several_joints_each_have_their_own_command_and_a_broken_one_costs_no_other() {
    let desk = Desk::with(vec![banded("boom"), joint("arm")]).with_broken_joint();
    let arguments = "explain log.csv --split 0.6 --effects dead_band,thermal_drift";
    let json = desk.json(arguments, 1);
    let verdicts: Vec<_> =
        json["joints"].as_array().unwrap().iter().map(|j| &j["verdict"]).collect();
    assert_eq!(verdicts, ["missing_effect", "adequate"]);
    let command = "tauscope add dead_band log.csv --joint boom --split 0.6 --model model.toml";
    assert_eq!(json["joints"][0]["commands"], json!([command]));
    let failure = json["failures"][0].as_str().unwrap();
    assert!(failure.contains("broken") && failure.contains("row"), "{failure}");
    let output = desk.run(arguments);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stderr).unwrap().contains("broken"));
    let text = String::from_utf8(output.stdout).unwrap();
    for part in
        ["boom: dead_band is missing", "│ dead_band ", command, "arm: no missing effect found"]
    {
        assert!(text.contains(part), "no `{part}` in: {text}");
    }
}

#[test]
fn a_limit_that_only_one_direction_reaches_is_named_at_once() {
    for (limit, negative_ratio) in [(0.9, 3.0), (3.0, 0.3)] {
        let mut limited = joint("boom");
        let numbers = [("limit", limit), ("negative_ratio", negative_ratio)];
        let numbers = numbers.map(|(key, value)| (key.to_owned(), value));
        limited.hide("asymmetric_saturation", &numbers).unwrap();
        let desk = Desk::with(vec![limited]);
        let boom = &desk.json("explain log.csv", 0)["joints"][0];
        assert_eq!(boom["verdict"], "missing_effect", "{boom}");
        let first = &boom["ranking"][0];
        assert_eq!(first["effect"], "asymmetric_saturation");
        let reached = if negative_ratio > 1.0 { "limit" } else { "negative_limit" };
        let found = &first["parameters"][reached];
        assert!((number(&found["value"]) - 0.9).abs() < 0.02, "{found}");
    }
}

#[test]
fn an_effect_of_the_model_file_takes_part() {
    let desk = Desk::with(vec![JointSpec { saturation: Some(0.9), ..joint("boom") }]);
    desk.write(
        "mine.toml",
        "schema = \"tauscope/model/1\"\n[[candidate]]\nkind = \"expression\"\nid = \"cap\"\n\
         stage = \"input\"\nexpression = \"min(max(signal, -most), most)\"\nparameters = \
         { most = { value = 1.2, min = 0.1, max = 5.0, neutral = 1000, dimension = \"input\" } }\n",
    );
    let both = desk.json("explain log.csv --model mine.toml --effects cap,thermal_drift", 0);
    let boom = &both["joints"][0];
    assert_eq!(
        (&boom["verdict"], &boom["ranking"][0]["effect"]),
        (&json!("missing_effect"), &json!("cap"))
    );
    let most = &boom["ranking"][0]["parameters"]["most"];
    assert!((number(&most["value"]) - 0.9).abs() < 4.0 * number(&most["std_error"]), "{most}");
    assert_eq!(boom["commands"], json!(["tauscope add cap log.csv --model mine.toml"]));
    let refused = desk.refusal("explain log.csv --model mine.toml --effects capp");
    assert!(refused.contains("`capp`") && refused.contains("did you mean `cap`?"), "{refused}");
}

#[test]
fn what_cannot_be_used_is_refused() {
    let desk = Desk::with(vec![joint("boom")]);
    let refused = desk.refusal("explain log.csv --effects dead_band,stictoin");
    for part in ["--effects", "`stictoin`", "did you mean `stiction`?", "tauscope effects"] {
        assert!(refused.contains(part), "no `{part}` in: {refused}");
    }
    assert!(!desk.has("model.toml"));
    assert!(desk.refusal("explain log.csv --model none.toml").contains("none.toml"));
    assert!(desk.refusal("explain none.csv").contains("none.csv"));
}

#[cfg(feature = "rrd")]
#[test]
fn the_model_and_its_ranking_are_recorded() {
    let desk = Desk::with(vec![banded("boom")]);
    let models = desk.recorded_models("explain log.csv --effects dead_band");
    assert_eq!(models, ["integrator"]);
    assert_eq!(desk.recorded_revisions(), 1);
}

/// Forty trials too short for the test of lack of fit, of a joint whose speed depends on its angle.
fn short_trials() -> String {
    let mut log = "trial,time_s,a.input [V],a.output [deg]\n".to_owned();
    for trial in 0_u32..40 {
        let mut y = 0.5 * f64::from(trial * 7919 % 41);
        let level = [-2.0, -1.0, 1.0, 2.0][(trial * 31 % 4) as usize];
        for k in 0..11 {
            let input = if k < 7 { 0.0 } else { level };
            let noise = 0.01 * (f64::from((trial * 8 + k) * 7919 % 1009) / 504.5 - 1.0);
            let time = 0.05 * f64::from(k);
            writeln!(log, "{trial},{time:.3},{input},{:.4}", y + noise).unwrap();
            y += 0.05 * 12.0 * input * (1.0 - 0.6 * (0.3 * y).cos());
        }
    }
    log
}

#[test]
fn what_cannot_be_tested_is_not_adequate_far_beyond_the_noise() {
    let desk = Desk::of_log(&short_trials());
    let json = desk.json("explain log.csv", 0);
    let joint = &json["joints"][0];
    assert!(joint["lack_of_fit"].is_null(), "it was to have too few samples: {joint}");
    let error = number(&joint["error"]["validation"]["rmse"]);
    assert!(error > 10.0 * number(&joint["error"]["sensor_noise"]), "{joint}");
    assert_ne!(joint["verdict"], "adequate");
}
