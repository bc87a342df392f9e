//! Every delay with many settings: what it depends on, and which settings agree.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tauscope::batch::Threads;
use tauscope::delay::sweep::{Base, Factor, Grid, JointSweep};
use tauscope::delay::{Method, Settings};
use tauscope::numerics::LowPass;
use tauscope::study::sweep_joints;
use tauscope::synthetic::{
    DelayLaw, InputSpec, JointSpec, PlantSpec, Synthetic, simulate, write_log,
};

fn joint(name: &str) -> JointSpec {
    let input = InputSpec::Levels { levels: vec![-1.0, -0.5, 0.5, 1.0], hold_s: [0.9, 2.0] };
    let delay = DelayLaw::Uniform { min: 0.05, max: 0.4 };
    JointSpec { noise: 0.05, ..JointSpec::new(name, input, delay) }
}

fn made(joints: Vec<JointSpec>) -> Synthetic {
    simulate(&PlantSpec::new(3, 40.0, joints)).unwrap()
}

fn swept(made: &Synthetic, methods: &[Method], passbands: &[Option<f64>]) -> JointSweep {
    let base = |method: &Method| Base { settings: Settings::of(*method), keeps_low_pass: true };
    let raw = |base: Base| Base { keeps_low_pass: base.settings.low_pass.is_none(), ..base };
    let bases = methods.iter().map(base).map(raw).collect();
    let low_pass = |hz: &Option<f64>| hz.map(|cutoff_hz| LowPass { cutoff_hz, order: 4 });
    let passbands = passbands.iter().map(low_pass).collect();
    let grid = Grid::new(bases, passbands, vec![10], vec![1, 2]);
    let mut found = sweep_joints(&made.joints, |_| grid.clone(), 2.0, || (), &Threads);
    found.remove(0).unwrap().sweep
}

/// How many delays depend on each setting, in the order of [`Factor::ALL`].
fn counts(sweep: &JointSweep) -> [usize; 4] {
    let on = |factor| {
        let steps = sweep.steps.iter().filter_map(|step| step.delay_depends_on.as_ref());
        steps.filter(|hanging| hanging.factor == factor).count()
    };
    Factor::ALL.map(on)
}

/// All methods but the one that is one of the others.
fn by_settings() -> Vec<Method> {
    Method::all().filter(|method| *method != Method::AUTO).collect()
}

#[test]
fn the_delays_of_an_ideal_joint_hang_on_nothing() {
    let sweep = swept(&made(vec![joint("arm")]), &by_settings(), &[Some(10.0), None]);
    let settled = sweep.judged().filter(|step| step.is_unanimous()).count();
    assert!(10 * settled >= 9 * sweep.judged().count(), "{settled} of {}", sweep.judged().count());
    // All settings say what is true.
    let truth = made(vec![joint("arm")]).truth;
    for (step, truth) in sweep.steps.iter().zip(&truth).filter(|(step, _)| step.is_unanimous()) {
        let Some(agreement) = step.agreement else { continue };
        assert!((agreement.delay - truth.delay_samples).abs() < 1.5, "{agreement:?} {truth:?}");
    }
}

#[test]
fn behind_a_lag_the_delays_hang_on_the_method() {
    let lagged = made(vec![JointSpec { lag_s: Some(0.06), ..joint("arm") }]);
    let sweep = swept(&lagged, &by_settings(), &[Some(10.0), None]);
    let [method, others @ ..] = counts(&sweep);
    assert!(10 * method >= 9 * sweep.judged().count(), "{method} {others:?}");
    let lag_s = sweep.runs.iter().flatten().find_map(|run| run.lag_s).unwrap();
    assert!((lag_s - 0.06).abs() < 0.01);
    // Two methods of three are wrong; where they agree, the third one's interval may still hold what they
    // say: bends are looked for near the onset where they do not fit.
    let levels = &sweep.levels[0];
    let [_, two, three] = [0, 1, 2].map(|index| levels[index].disagrees.unwrap());
    assert!(two < 0.2 && three > 0.1, "{two} {three}");
}

#[test]
fn a_passband_that_is_too_low_is_seen() {
    let input = InputSpec::Levels { levels: vec![-1.0, -0.5, 0.5, 1.0], hold_s: [0.4, 0.8] };
    let delay = DelayLaw::Uniform { min: 0.05, max: 0.2 };
    let short = made(vec![JointSpec { input, delay, ..joint("arm") }]);
    let sweep = swept(&short, &[Method::TWO_LINE], &[Some(0.3), Some(10.0), None]);
    let [_, passband, ..] = counts(&sweep);
    assert!(3 * passband > 2 * sweep.judged().count(), "{:?}", counts(&sweep));
    let levels = &sweep.levels[1];
    assert!(levels[0].disagrees > Some(0.6) && levels[1].disagrees < Some(0.2), "{levels:?}");
}

/// `tauscope` in a folder with the log of two joints.
fn run(folder: &Path, arguments: &str) -> Output {
    let log = std::fs::File::create(folder.join("log.csv")).unwrap();
    let lagged = JointSpec { lag_s: Some(0.06), ..joint("boom") };
    write_log(&made(vec![joint("arm"), lagged]), log).unwrap();
    let mut arguments = arguments.split_whitespace();
    let command = arguments.next().unwrap();
    Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .current_dir(folder)
        .args([command, "log.csv"])
        .args(arguments)
        .output()
        .unwrap()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn each_setting_gives_what_estimate_gives() {
    let folder = tempfile::tempdir().unwrap();
    let options = "sweep --format json --alpha 5,10 --beta 2..6:2 --passband 4,none";
    let sweep = json(&run(folder.path(), &format!("{options} --method two-line,hinge")));
    assert_eq!(sweep["schema"], "tauscope/sweep/1");
    let settings = sweep["settings"].as_array().unwrap();
    // Onsets hang on neither β nor the low-pass.
    assert_eq!((settings.len(), &sweep["combinations"]), (2 * 2 * 3 + 2, &24.into()));
    for (index, settings) in settings.iter().enumerate() {
        let option = |key: &str| settings[key].to_string().replace('"', "");
        let low_pass = settings["low_pass"]["cutoff_hz"].as_f64();
        let low_pass = low_pass.map_or_else(|| "none".to_owned(), |hz| hz.to_string());
        let [method, alpha, beta] = ["method", "alpha", "beta"].map(option);
        let options = format!("--method {method} --alpha {alpha} --beta {beta}");
        let command = format!("estimate --format json {options} --passband {low_pass}");
        let estimate = json(&run(folder.path(), &command));
        for joint in 0..2 {
            let (swept, single) = (&sweep["joints"][joint], &estimate["joints"][joint]);
            assert_eq!(swept["joint"], single["joint"]);
            assert_eq!(swept["settings"][index]["accepted"], single["accepted"]);
            let decisions = single["decisions"].as_array().unwrap();
            for (step, decision) in swept["decisions"].as_array().unwrap().iter().zip(decisions) {
                let accepted = decision["verdict"] == "accepted";
                let delay = if accepted { &decision["delta"] } else { &Value::Null };
                assert_eq!(step["delays"][index].as_f64(), delay.as_f64(), "{settings} {step}");
                assert_eq!(step["p"], decision["p"]);
            }
        }
    }
}

#[test]
fn the_text_says_what_delays_hang_on() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), "sweep --alpha 10 --beta 1,2");
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(text.contains("boom: 0 of"), "{text}");
    assert!(text.contains("depend on the method"), "{text}");
    assert!(text.contains("`lag-aware` finds a lag of 0.0"), "{text}");
    assert!(text.contains("24 combinations of settings"), "{text}");
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let options = "--alpha 5,10 --beta 1,2 --method two-line,hinge";
    for format in ["text", "json"] {
        let on = |threads: usize| {
            let command = format!("sweep {options} --format {format} --threads {threads}");
            run(folder.path(), &command).stdout
        };
        let one = on(1);
        assert!(one.len() > 1000);
        assert_eq!(on(3), one);
    }
}

#[test]
fn a_setting_that_cannot_be_is_left_out_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let options = "--method two-line --alpha 10 --beta 1,2 --passband 5,60";
    let output = run(folder.path(), &format!("sweep {options}"));
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("joint `arm`, 2 of 4 settings are left out"), "{told}");
    assert!(told.contains("Nyquist frequency of 50 Hz"), "{told}");
    assert!(String::from_utf8(output.stdout).unwrap().contains("arm: "));
}

#[test]
fn bad_values_are_told_with_what_would_be_good() {
    let folder = tempfile::tempdir().unwrap();
    for (options, expected) in [
        ("--alpha 0", "whole numbers from 1 up"),
        ("--beta 5..2", "ends before it begins"),
        ("--beta 1..100000", "more than 1000 values"),
        ("--passband fast", "frequencies in Hz, or `none`"),
        ("--method three-line", "two-line, hinge, lag-aware"),
        ("--tolerance -1", "a number from 0 up"),
        ("--alpha 1..500 --beta 1..500", "more than 20000"),
        ("--passband 60 --method two-line", "Nyquist frequency"),
    ] {
        let output = run(folder.path(), &format!("sweep {options}"));
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{options}: {told}");
        assert!(told.contains(expected), "{options}: {told}");
    }
}

/// `sweep` of a log with this text.
fn sweep_of(text: &str, options: &[&str]) -> Output {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("log.csv"), text).unwrap();
    Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .current_dir(folder.path())
        .args(["sweep", "log.csv"])
        .args(options)
        .output()
        .unwrap()
}

/// A log of a joint that follows its input `delay` samples late, where the level is not 0, and
/// `stop` samples late where it is.
fn follower(period: f64, level: impl Fn(i32) -> f64, delay: i32, stop: i32) -> String {
    use std::fmt::Write as _;
    let mut text = "time_s,j.input,j.output\n".to_owned();
    let (mut angle, mut speed) = (0.0, 0.0);
    for k in 0..1500 {
        for late in [delay, stop] {
            let then = level((k - late).max(0));
            if (then == 0.0) == (late == stop) {
                speed = then;
            }
        }
        angle += 10.0 * period * speed;
        let noise = 0.01 * (f64::from(k) * 12.9898).sin();
        writeln!(text, "{:.4},{},{:.5}", f64::from(k) * period, level(k), angle + noise).unwrap();
    }
    text
}

#[test]
fn kinds_of_steps_that_differ_have_medians_of_their_own() {
    let strokes = follower(0.01, |k| f64::from(k / 100 % 2), 30, 10);
    let options = ["--method", "two-line,hinge", "--alpha", "10", "--beta", "2,5", "-q"];
    let output = sweep_of(&strokes, &options);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("j, start") && text.contains("j, stop"), "{text}");
    let row = text.lines().find(|line| line.contains("hinge  ")).unwrap();
    let seconds: Vec<f64> = row.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    assert!(seconds[0] > 0.25 && (0.05..0.15).contains(&seconds[2]), "{text}");
}

#[test]
fn an_input_that_moves_all_the_time_has_nothing_to_sweep() {
    let moving =
        follower(0.01, |k| (f64::from(k) * 0.01).sin() + (f64::from(k) * 0.037).sin(), 12, 12);
    let output = sweep_of(&moving, &[]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{said}");
    assert!(said.contains("moves all the time") && said.contains("`tauscope estimate`"), "{said}");
}

#[test]
fn low_passes_that_do_not_fit_the_rate_are_left_out_unasked() {
    let slow = follower(0.1, |k| f64::from(k / 25 % 3), 4, 4);
    let output = sweep_of(&slow, &["--method", "two-line", "--alpha", "5", "--beta", "1,2"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("the 5 and 10 Hz low-pass is left out"), "{said}");
    assert!(!String::from_utf8_lossy(&output.stdout).contains("10 Hz"));
    // Who asks for one is told that it does not fit.
    let asked = sweep_of(&slow, &["--method", "two-line", "--passband", "5,none"]);
    assert_eq!(asked.status.code(), Some(1));
    // A lag of less than a sample is none that other methods take for delay.
    let all = sweep_of(&slow, &["--alpha", "5", "--beta", "1", "-q"]);
    assert!(!String::from_utf8_lossy(&all.stdout).contains("take for delay"));
}
