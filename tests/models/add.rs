//! `tauscope add` as a user sees it: the error before and after, and the model file.

use crate::desk::{Desk, assert_fields, banded, fields, joint, number};
use serde_json::json;
use tauscope::synthetic::JointSpec;

/// A model file that somebody cared for.
const HAND_MADE: &str = "\
# Boom of the small machine.
schema = \"tauscope/model/1\"

[joint.boom]
structure = \"integrator\"     # what else
parameters = { gain = 9.0, delay = { value = 0.12, fixed = true } } # delay as measured

[joint.other]   # not in this log
structure = \"integrator\"
parameters = { gain = 1.50, delay = 0.2 }
";

#[test]
fn the_next_revision_is_written_and_what_was_written_by_hand_stays() {
    let desk = Desk::with(vec![banded("boom")]);
    desk.write("boom.toml", HAND_MADE);
    let json = desk.json("add dead_band log.csv --model boom.toml", 0);
    assert_eq!(
        (&json["schema"], &json["model_file"]),
        (&json!("tauscope/add/1"), &json!("boom.toml"))
    );
    let boom = &json["joints"][0];
    assert_fields(
        boom,
        "joint revision effects parameters error lack_of_fit fails_where worst_segments added \
         removed p_value before",
    );
    assert_eq!((&boom["revision"], &boom["before"]["revision"]), (&json!(1), &json!(0)));
    assert_eq!(boom["added"], "dead_band");
    assert_eq!(fields(&boom["before"]), ["revision", "effects", "error"]);
    for part in ["train", "validation"] {
        let [before, after] = [&boom["before"], boom].map(|of| number(&of["error"][part]["rmse"]));
        assert!(after < 0.2 * before, "{part}: {before} to {after}");
    }
    let text = desk.read("boom.toml");
    for line in [
        "# Boom of the small machine.",
        "structure = \"integrator\"     # what else",
        "delay = { value = 0.12, fixed = true } } # delay as measured",
        "[joint.other]   # not in this log",
        "parameters = { gain = 1.50, delay = 0.2 }",
        "kind = \"dead_band\"",
        "added = \"dead_band\"",
    ] {
        assert!(text.contains(line), "no `{line}` in {text}");
    }
    assert!(!text.contains("gain = 9.0"));
    let rmse = format!("validation_rmse = {}", boom["error"]["validation"]["rmse"]);
    assert!(text.contains(&rmse), "no `{rmse}` in {text}");

    let again = desk.refusal("add dead_band log.csv --model boom.toml");
    assert!(again.contains("boom") && again.contains("in the model already"), "{again}");
    assert_eq!(desk.read("boom.toml"), text);
}

#[test]
fn without_a_model_file_a_new_one_is_made_and_none_is_replaced_by_accident() {
    let desk = Desk::with(vec![banded("boom")]);
    let output = desk.run("add dead_band log.csv");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8(output.stdout).unwrap();
    for part in [
        "│ boom    integrator",
        "boom (revision 1, + dead_band)",
        "boom: with dead_band the error falls",
    ] {
        assert!(printed.contains(part), "no `{part}` in {printed}");
    }
    let first = desk.read("model.toml");
    let refused = desk.refusal("add flow_curve log.csv");
    assert!(refused.contains("model.toml exists already") && refused.contains("--write"));
    desk.json("add backlash log.csv --model model.toml --write next.toml", 0);
    assert_eq!(desk.read("model.toml"), first);
    assert!(desk.read("next.toml").contains("revision = 2\nadded = \"backlash\""));
}

#[test]
fn an_effect_that_does_nothing_is_said_to_do_nothing() {
    let desk = Desk::with(vec![joint("boom")]);
    let output = desk.run("add backlash log.csv --model boom.toml --quiet");
    assert!(output.status.success() && output.stderr.is_empty());
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("not significant"), "{printed}");
}

#[test]
fn only_the_joints_that_were_named_change_and_each_failure_is_told() {
    let desk = Desk::with(vec![banded("boom"), banded("arm")]).with_broken_joint();
    desk.json("add dead_band log.csv --joint boom --model both.toml", 0);
    let boom = desk.read("both.toml");
    assert!(!boom.contains("arm"));
    let second = desk.json("add dead_band log.csv --model both.toml", 1);
    assert_eq!(second["joints"].as_array().unwrap().len(), 1);
    assert_eq!(second["joints"][0]["joint"], "arm");
    for (failure, name) in [(0, "broken"), (1, "boom")] {
        assert!(second["failures"][failure].as_str().unwrap().contains(name), "{second}");
    }
    assert!(desk.read("both.toml").starts_with(&boom));
    assert!(desk.read("both.toml").contains("[[joint.arm.effect]]"));
}

#[test]
fn an_effect_takes_the_place_of_those_it_contains() {
    let desk = Desk::with(vec![JointSpec { lag_s: Some(0.08), ..joint("boom") }]);
    desk.json("add actuator_lag log.csv --model boom.toml", 0);
    let json = desk.json("add coulomb_friction log.csv --model boom.toml", 0);
    assert_eq!(json["joints"][0]["removed"], json!(["actuator_lag"]));
    assert_eq!(json["joints"][0]["effects"], json!(["coulomb_friction"]));
    let text = desk.read("boom.toml");
    assert!(text.contains("added = \"coulomb_friction\"\nremoved = \"actuator_lag\""), "{text}");
    let refused = desk.refusal("add actuator_lag log.csv --model boom.toml");
    assert!(refused.contains("is a part of `coulomb_friction`"), "{refused}");
}

#[test]
fn what_cannot_be_added_leaves_no_file() {
    let desk = Desk::with(vec![joint("boom")]);
    let refused = desk.refusal("add dead_bnd log.csv --model boom.toml");
    assert!(refused.contains("did you mean `dead_band`?"), "{refused}");
    assert!(desk.refusal("add dead_band log.csv --write log.csv").contains("log.csv"));
    assert!(desk.refusal("add dead_band log.csv --write no/where.toml").contains("no/where.toml"));
    let missing = desk.refusal("add dead_band log.csv --model none.toml --write boom.toml");
    assert!(missing.contains("none.toml"), "{missing}");
    assert!(!desk.has("boom.toml") && !desk.has("model.toml"));
    assert!(desk.read("log.csv").contains("boom.input"));
}

#[cfg(feature = "rrd")]
#[test]
fn both_models_are_recorded() {
    let desk = Desk::with(vec![banded("boom")]);
    assert_eq!(desk.recorded_models("add dead_band log.csv"), ["revision 0", "revision 1"]);
    assert_eq!(desk.recorded_revisions(), 2);
}
