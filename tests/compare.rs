//! `tauscope compare` as a user sees it, on joints of the synthetic plant, which shares no
//! equation with the models.
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::process::{Command, Output};

use serde_json::Value;
use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate, write_log};
use tempfile::TempDir;

/// A log of one joint named `boom`, and model files beside it.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn with(joint: impl FnOnce(JointSpec) -> JointSpec) -> Self {
        let input =
            InputSpec::Levels { levels: vec![-1.5, -1.0, -0.5, 0.5, 1.0, 1.5], hold_s: [0.8, 1.6] };
        let spec = JointSpec::new("boom", input, DelayLaw::Constant { seconds: 0.12 });
        let spec = joint(JointSpec { noise: 0.05, ..spec });
        let made = simulate(&PlantSpec::new(11, 80.0, vec![spec])).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let log = std::fs::File::create(folder.path().join("log.csv")).unwrap();
        write_log(&made, log).unwrap();
        Self { folder }
    }

    fn model(self, name: &str, effects: &str) -> Self {
        let text = format!(
            "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
             parameters = {{ gain = 9.0, delay = 0.1 }}\n{effects}"
        );
        std::fs::write(self.folder.path().join(name), text).unwrap();
        self
    }

    fn run(&self, arguments: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_tauscope"))
            .current_dir(self.folder.path())
            .args(["compare", "log.csv"])
            .args(arguments.split_whitespace())
            .output()
            .unwrap()
    }

    /// The joint in the JSON of a run that went well.
    fn joint(&self, arguments: &str) -> Value {
        let output = self.run(&format!("{arguments} --format json"));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(json["schema"], "tauscope/compare/1");
        json["joints"][0].clone()
    }
}

const LAG: &str = "[[joint.boom.effect]]\nkind = \"actuator_lag\"\n";

#[test]
fn a_plain_integrator_is_recovered_and_adequate() {
    let joint = Desk::with(|joint| joint).joint("");
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
}

#[test]
fn a_lag_is_missed_and_then_not() {
    let desk = Desk::with(|joint| JointSpec { lag_s: Some(0.08), ..joint }).model("lag.toml", LAG);
    let plain = desk.joint("");
    assert_eq!(plain["lack_of_fit"]["adequate"], false);
    let with_lag = desk.joint("--model lag.toml --fit");
    assert_eq!(with_lag["effects"], serde_json::json!(["actuator_lag"]));
    assert_eq!(with_lag["lack_of_fit"]["adequate"], true);
    let lag = with_lag["parameters"]["actuator_lag.time_constant"]["value"].as_f64().unwrap();
    assert!((lag - 0.08).abs() < 0.005, "{lag}");
    let rmse = |joint: &Value| joint["error"]["validation"]["rmse"].as_f64().unwrap();
    assert!(rmse(&with_lag) < 0.6 * rmse(&plain));
}

#[test]
fn a_model_is_taken_as_it_is_unless_it_is_to_be_fitted() {
    let desk = Desk::with(|joint| joint).model("mine.toml", "");
    let given = desk.joint("--model mine.toml");
    assert_eq!(given["parameters"]["gain"]["value"], 9.0);
    let fitted = desk.joint("--model mine.toml --fit");
    assert!((fitted["parameters"]["gain"]["value"].as_f64().unwrap() - 10.0).abs() < 0.1);
}

#[test]
fn a_short_horizon_makes_the_error_of_an_integrator_smaller() {
    let desk = Desk::with(|joint| JointSpec { dead_band: Some([-0.3, 0.3]), ..joint });
    let rmse = |arguments: &str| desk.joint(arguments)["error"]["train"]["rmse"].as_f64().unwrap();
    assert!(rmse("--horizon steps") < rmse("--horizon free"));
}

#[test]
fn model_files_that_cannot_be_used_say_why() {
    let desk = Desk::with(|joint| joint)
        .model("effect.toml", "[[joint.boom.effect]]\nkind = \"dead_bnd\"\n")
        .model(
            "parameter.toml",
            "[[joint.boom.effect]]\nkind = \"dead_band\"\nparameters = { upr = 1 }\n",
        )
        .model(
            "bounds.toml",
            "[[joint.boom.effect]]\nkind = \"dead_band\"\nparameters = { upper = -1 }\n",
        )
        .model("key.toml", "colour = \"red\"\n");
    for (file, parts) in [
        ("missing.toml", vec!["missing.toml"]),
        ("effect.toml", vec!["boom", "dead_bnd", "dead_band"]),
        ("parameter.toml", vec!["boom", "dead_band", "upr", "upper"]),
        ("bounds.toml", vec!["boom", "dead_band.upper", "-1"]),
        ("key.toml", vec!["key.toml", "colour"]),
    ] {
        let output = desk.run(&format!("--model {file}"));
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{file}: {stderr}");
        assert!(stderr.starts_with("error: ") && !stderr.contains("panicked"), "{stderr}");
        for part in parts {
            assert!(stderr.contains(part), "no {part} in {stderr}");
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let desk = Desk::with(|joint| JointSpec { lag_s: Some(0.05), ..joint });
    let run = |threads: &str| desk.run(&format!("--format json --threads {threads}")).stdout;
    assert_eq!(run("1"), run("2"));
}
