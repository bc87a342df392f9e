//! `tauscope simulate` with and without a plant file, as a user runs it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tauscope::synthetic::PlantSpec;

fn simulate(folder: &Path, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tauscope"));
    command.current_dir(folder).arg("simulate").args(arguments.split(' ')).output().unwrap()
}

#[track_caller]
fn done(folder: &Path, arguments: &str) {
    let output = simulate(folder, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_plant_in_the_truth_makes_the_same_log_again() {
    let folder = tempfile::tempdir().unwrap();
    for effect in ["stiction:start=0.8,stop=0.3 --effect leakage:rate=0.05", "backlash"] {
        done(
            folder.path(),
            &format!("--effect {effect} -o a.csv --truth a.toml --truth a.truth.csv"),
        );
        done(folder.path(), "a.toml -o b.csv --truth b.truth.csv");
        for (a, b) in [("a.csv", "b.csv"), ("a.truth.csv", "b.truth.csv")] {
            let [a, b] = [a, b].map(|name| fs::read(folder.path().join(name)).unwrap());
            assert!(a == b, "{effect}");
        }
    }
}

#[test]
fn numbers_and_options_arrive_in_the_plant() {
    let folder = tempfile::tempdir().unwrap();
    let options = "--effect dead_band:lower=-0.5,upper=0.5 --noise 0.1 --noise-correlation 0.9 \
                   --duration 20 --seed 3 -o log.csv --truth truth.toml";
    done(folder.path(), options);
    let text = fs::read_to_string(folder.path().join("truth.toml")).unwrap();
    let plant = PlantSpec::from_toml(&text).unwrap();
    let joint = &plant.joints[0];
    assert_eq!(joint.effect.get("dead_band"), Some(&[-0.5, 0.5][..]));
    let found = [joint.noise, joint.noise_correlation, plant.duration_s];
    assert_eq!(found.map(|x| x.to_string()), ["0.1", "0.9", "20"]);
    assert_eq!(plant.seed, 3);
}

#[test]
fn what_makes_no_sense_is_refused_in_one_message_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("--effect dead_bnd", "did you mean `dead_band`?"),
        ("--effect dead_band:lowr=1", "unknown field `lowr`, expected `lower` or `upper`"),
        ("--effect dead_band:lower=-1", "missing field `upper`"),
        ("--effect dead_band:lower=1,upper=2", "`effect.dead_band.lower` is 1.0; allowed"),
        ("--effect dead_band:lower=x", "`lower=x` is not KEY=NUMBER"),
        ("--effect leakage:rate=0.1 --strength weak", "--strength"),
        ("--effect leakage --effect backlash:width=1", "--effect backlash"),
        ("--effect leakage --effect leakage", "named twice"),
        ("--effect leakage --duration 30", "--duration"),
        ("--effect leakage --noise 0", "--noise 0"),
        ("--noise-correlation 1", "`noise_correlation` is 1.0"),
        ("missing.toml", "missing.toml"),
    ];
    for (arguments, message) in cases {
        let output = simulate(folder.path(), &format!("{arguments} -o log.csv --truth t.toml"));
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
        assert!(text.contains(message), "{arguments}: {text}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{arguments}");
    }
}
