//! The next experiment, as a user asks for it, and what the plant does with it.

use std::fmt::Write as _;

use crate::desk::{Desk, assert_fields, banded, joint, number};
use crate::sample::size;
use tauscope::synthetic::{CylinderSpec, InputSpec, JointSpec, PlantSpec, simulate, write_log};

const MODEL: &str = r#"
schema = "tauscope/model/1"
[joint.boom]
structure = "integrator"
parameters = { gain = 9.6, delay = 0.13 }
[[joint.boom.effect]]
kind = "dead_band"
parameters = { lower = -0.31, upper = 0.29 }
[[joint.boom.history]]
revision = 1
added = "dead_band"
validation_rmse = 0.06
"#;

fn desk() -> Desk {
    let desk = Desk::with(vec![banded("boom")]);
    desk.write("boom.toml", MODEL);
    desk
}

/// A column of a CSV file.
fn column(text: &str, name: &str) -> Vec<f64> {
    let mut lines = text.lines();
    let place = lines.next().unwrap().split(',').position(|cell| cell == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

/// What `spec` does with the input of a file, 100 samples a second.
fn played(spec: JointSpec, input: &[f64], seed: u64) -> Vec<f64> {
    let changes = (1..input.len()).filter(|k| (input[*k] - input[k - 1]).abs() > 0.0);
    let steps = changes.map(|k| (k + 1, input[k])).collect();
    let input_spec = InputSpec::Steps { steps, initial: input[0] };
    let seconds = input.len() as f64 * 0.01;
    let spec = JointSpec { input: input_spec, ..spec };
    let made = simulate(&PlantSpec::new(seed, seconds, vec![spec])).unwrap();
    made.joints[0].trials[0].output().to_vec()
}

#[test]
fn random_steps_need_no_model() {
    let desk = desk();
    let json = desk.json("design --joint swing --levels=-1,0,1 --hold 0.5,1 --duration 30", 0);
    assert_eq!((&json["schema"], &json["seed"]), (&"tauscope/design/1".into(), &1.into()));
    let joint = &json["joints"][0];
    assert_fields(joint, "joint levels hold_s duration_s steps transitions holds separates");
    assert_eq!(joint["levels"], serde_json::json!([-1.0, 0.0, 1.0]));
    assert!(number(&joint["hold_s"]["low"]) >= 0.5 && number(&joint["hold_s"]["high"]) <= 1.0);
    let (least, most) = (number(&joint["transitions"][0]), number(&joint["transitions"][1]));
    assert!(least >= 4.0 && most - least <= 2.0);
    assert!(joint["predicted"].is_null() && joint["separates"].is_null());
}

#[test]
fn the_same_seed_makes_the_same_file() {
    let desk = desk();
    for (name, threads) in [("a.csv", 1), ("b.csv", 2)] {
        let options = "design --model boom.toml --output-range=-40,40 --duration 30 -q";
        assert!(desk.run(&format!("{options} --threads {threads} -o {name}")).status.success());
    }
    assert_eq!(desk.read("a.csv"), desk.read("b.csv"));
    let other = "design --model boom.toml --output-range=-40,40 --duration 30 -q --seed 2 -o c.csv";
    assert!(desk.run(other).status.success());
    assert_ne!(desk.read("a.csv"), desk.read("c.csv"));
    let text = desk.read("a.csv");
    assert!(text.starts_with("time_s,boom.input\n0,0\n0.01,0\n"), "{}", &text[..60]);
    assert_eq!(text.lines().count(), 3001);
}

/// The model is not the plant: its gain and its dead band are a little off.
#[test]
fn a_joint_stays_in_the_range_that_was_promised() {
    let desk = desk();
    let mut farthest: f64 = 0.0;
    for seed in 1..4 {
        let options = "design --model boom.toml --output-range=-40,40 --duration 40";
        let options = format!("{options} --seed {seed} -o in.csv --preview see.csv -q");
        assert!(desk.run(&options).status.success());
        let output = played(banded("boom"), &column(&desk.read("in.csv"), "boom.input"), seed);
        farthest = output.iter().fold(farthest, |most, y| most.max(y.abs()));
        let see = desk.read("see.csv");
        let (low, high) = (column(&see, "boom.low"), column(&see, "boom.high"));
        let inside = output.iter().zip(low.iter().zip(&high));
        let inside = inside.filter(|(y, (low, high))| **y >= *low - 0.2 && **y <= *high + 0.2);
        assert!(inside.count() * 100 >= 99 * output.len(), "seed {seed}");
    }
    assert!((15.0..40.0).contains(&farthest), "{farthest}");
}

/// The trials of a file that is to be played: its only one, or each by its number.
fn trials(text: &str, name: &str) -> Vec<Vec<f64>> {
    let values = column(text, name);
    if !text.starts_with("trial,") {
        return vec![values];
    }
    let mut trials: Vec<Vec<f64>> = Vec::new();
    for (number, value) in column(text, "trial").into_iter().zip(values) {
        while (trials.len() as f64) < number {
            trials.push(Vec::new());
        }
        trials.last_mut().unwrap().push(value);
    }
    trials
}

/// What `joint` does with the trials of `in.csv`, each from `start` on, 50 samples a second.
fn driven_trials(desk: &Desk, joint: &JointSpec, start: f64) -> Vec<f64> {
    let trials = trials(&desk.read("in.csv"), "boom.input");
    trials.iter().flat_map(|input| driven(joint, input, start)).collect()
}

/// What `joint` does with an input from `start` on, 50 samples a second.
fn driven(joint: &JointSpec, input: &[f64], start: f64) -> Vec<f64> {
    let changes = (1..input.len()).filter(|k| (input[*k] - input[k - 1]).abs() > 0.0);
    let steps = changes.map(|k| (k + 1, input[k])).collect();
    let input_spec = InputSpec::Steps { steps, initial: input[0] };
    let joint = JointSpec { input: input_spec, start, range: None, noise: 0.0, ..joint.clone() };
    let plant = PlantSpec::new(99, input.len() as f64 * 0.02, vec![joint]);
    let made = simulate(&PlantSpec { sample_period_s: 0.02, ..plant }).unwrap();
    made.joints[0].trials[0].output().to_vec()
}

/// Joints with physics that share no equation with the models, and a range for each.
fn others() -> Vec<(JointSpec, [f64; 2])> {
    let hide = |mut joint: JointSpec, name: &str, numbers: &[(&str, f64)]| {
        let numbers: Vec<_> = numbers.iter().map(|(name, x)| ((*name).to_owned(), *x)).collect();
        joint.hide(name, &numbers).unwrap();
        joint
    };
    let base = || JointSpec { range: Some([-40.0, 40.0]), lag_s: Some(0.1), ..banded("boom") };
    let asymmetric = hide(base(), "direction_gain", &[("negative_factor", 0.7)]);
    let sinking = hide(base(), "gravity_load", &[("kappa", 0.3), ("y0", 10.0), ("creep", 0.6)]);
    let leaking = hide(asymmetric.clone(), "leakage", &[("rate", 0.05), ("y0", 0.0)]);
    let soft = hide(base(), "input_saturation", &[("limit", 1.2), ("sharpness", 8.0)]);
    let creeping = hide(asymmetric.clone(), "creep_memory", &[("share", 0.15)]);
    let drifting =
        hide(sinking.clone(), "thermal_drift", &[("change", 0.2), ("time_constant", 40.0)]);
    let input = InputSpec::Levels { levels: vec![-8.0, -4.0, 0.0, 4.0, 8.0], hold_s: [0.5, 2.0] };
    let cylinder = JointSpec {
        start: 20.0,
        range: Some([-15.0, 60.0]),
        cylinder: Some(CylinderSpec::default()),
        dead_band: None,
        lag_s: None,
        input,
        ..base()
    };
    let small = [-20.0, 25.0];
    vec![
        (asymmetric, small),
        (sinking, small),
        (leaking, small),
        (soft, [-25.0, 25.0]),
        (creeping, small),
        (drifting, [-30.0, 30.0]),
        (cylinder, [-5.0, 50.0]),
    ]
}

/// In the small sample the cylinder alone; `examples/statistics/design_validation.rs` is the long form.
#[test]
fn joints_with_other_physics_than_the_model_stay_in_the_range_that_is_promised() {
    for (index, (joint, [low, high])) in others().into_iter().enumerate().skip(size(6, 0)) {
        let desk = Desk::for_seconds(size(25.0, 45.0), vec![joint.clone()]);
        let options = format!("design log.csv --output-range={low},{high} -o in.csv -q");
        let designed = &desk.json(&options, 0)["joints"][0];
        let start = number(&designed["start"]);
        let output = driven_trials(&desk, &joint, start);
        let lowest = output.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = output.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert!(lowest >= low && highest <= high, "{index}: {lowest} to {highest}");
        // An input that hardly moves the joint is no answer.
        assert!(highest - lowest > 0.3 * (high - low), "{index}: {lowest} to {highest}");
        assert!(number(&designed["steps"]) >= 6.0, "{index}");
    }
}

/// A short log says little of a long input. The joint is brought back before each trial, and the file
/// says so; what is played is a log that can be read.
#[test]
fn what_one_input_cannot_promise_is_played_in_trials() {
    let joint = others().remove(0).0;
    let desk = Desk::for_seconds(45.0, vec![joint.clone()]);
    let options = "design log.csv --output-range=-20,25 --duration 90 -o in.csv --preview see.csv";
    let designed = &desk.json(&format!("{options} -q"), 0)["joints"][0];
    let played = designed["trials"].as_array().unwrap();
    assert!(played.len() > 1);
    let seconds: f64 = played.iter().map(|trial| number(&trial["duration_s"])).sum();
    assert!(
        (seconds - 90.0).abs() < 0.1 && (number(&designed["duration_s"]) - seconds).abs() < 1e-6
    );
    let last = designed["holds"].as_array().unwrap().last().unwrap();
    assert_eq!(last["trial"], played.len());
    assert!(designed["predicted"]["kept_until_s"].is_null());

    let text = desk.read("in.csv");
    assert!(text.starts_with("trial,time_s,boom.input\n1,0,0\n1,0.02,0\n"), "{}", &text[..60]);
    assert!(desk.read("see.csv").starts_with("trial,time_s,boom.input,boom.output,"));
    let (start, tolerance) = (number(&designed["start"]), number(&designed["start_tolerance"]));
    let mut made = Vec::new();
    for (place, input) in trials(&text, "boom.input").into_iter().enumerate() {
        let off = if place % 2 == 0 { tolerance } else { -tolerance };
        let output = driven(&joint, &input, start + off);
        assert!(output.iter().all(|y| (-20.0..=25.0).contains(y)), "trial {}", place + 1);
        made.push((input, output));
    }
    write_trials(&desk, "next.csv", &made);
    let estimated = desk.json("estimate next.csv -q", 0);
    assert!(!estimated["joints"][0].is_null());

    let said = String::from_utf8(desk.run(&format!("{options} -q")).stdout).unwrap();
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("trials drive it back to"), "{said}");
    let one = &desk.json("design log.csv --output-range=-20,25 --trials 1 -q", 0)["joints"][0];
    assert_eq!(one["trials"].as_array().unwrap().len(), 1);
    assert!(number(&one["duration_s"]) < 45.0);
}

/// A servo valve of a hobby excavator: 7.5 % duty is neutral.
#[test]
fn a_foreign_log_whose_input_rests_at_a_level_of_its_own_is_driven_about_that() {
    let desk = Desk::for_seconds(60.0, vec![JointSpec { range: Some([-40.0, 40.0]), ..resting() }]);
    let text = desk.read("log.csv");
    let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        format!("{},{},{}", 1e3 * cells[0], 7.5 + cells[1], 60.0 + cells[2])
    });
    let rows: Vec<String> = rows.collect();
    desk.write("foreign.csv", &format!("t_ms,duty_pct,angle_deg\n{}\n", rows.join("\n")));
    let options = "design foreign.csv --joint boom=duty_pct:angle_deg --output-range 40,80";
    let designed = &desk.json(&format!("{options} -o in.csv -q"), 0)["joints"][0];
    let input = column(&desk.read("in.csv"), "boom.input");
    assert!((input[0] - 7.5).abs() < 1e-9 && (input[input.len() - 1] - 7.5).abs() < 1e-9);
    let levels = designed["levels"].as_array().unwrap();
    let levels: Vec<f64> = levels.iter().map(number).collect();
    assert!(levels.first().unwrap() >= &6.0 && levels.last().unwrap() <= &9.0, "{levels:?}");
    assert!((number(&designed["start"]) - 60.0).abs() < 2.0);
}

/// [`banded`], with rest among its levels.
fn resting() -> JointSpec {
    let levels = vec![-1.5, -1.0, 0.0, 1.0, 1.5];
    JointSpec { input: InputSpec::Levels { levels, hold_s: [0.8, 1.6] }, ..banded("boom") }
}

#[test]
fn a_range_that_cannot_be_kept_is_refused_with_a_remedy() {
    let desk = desk();
    let cases = [
        ("--output-range=-3,3 --duration 120", "cannot be kept for 120 s"),
        ("--output-range=500,600", "the log shows the joint only from"),
        ("--output-range=-10,10 --start 10", "too near to the ends of the range"),
    ];
    for (options, expected) in cases {
        let said = desk.refusal(&format!("design log.csv {options} -o none.csv"));
        assert!(said.contains(expected), "{options}: {said}");
        assert!(said.contains("give") || said.contains("`--start` near"), "{options}: {said}");
        assert!(!desk.has("none.csv"));
    }
}

/// A joint between stops that is a third slower downward and has a soft dead band, or an output
/// that settles in half a second: what it does with `input`, 50 samples a second.
fn by_hand(input: &[f64], start: f64, settling_s: Option<f64>) -> Vec<f64> {
    let (late, part_s) = (8, 0.02);
    let (mut y, mut output) = (start, Vec::new());
    for sample in 0..input.len() {
        output.push(y);
        let u = input[sample.saturating_sub(late)];
        let opening = (u.abs() - 0.2 * (1.0 - (-u.abs() / 0.1).exp())) * u.signum();
        let driven = if opening < 0.0 { 10.0 * opening } else { 15.0 * opening };
        y = match settling_s {
            Some(settling_s) => y + part_s * (4.0 + driven - y) / settling_s,
            None => (y + part_s * driven).clamp(-40.0, 40.0),
        };
    }
    output
}

/// Trials as a log, with a noise of 0.03.
fn write_trials(desk: &Desk, name: &str, trials: &[(Vec<f64>, Vec<f64>)]) {
    let mut text = "trial,time_s,boom.input,boom.output\n".to_owned();
    let mut random: u64 = 1;
    for (trial, (input, output)) in trials.iter().enumerate() {
        for (sample, (u, y)) in input.iter().zip(output).enumerate() {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let noise = 0.1 * ((random >> 40) as f64 / f64::from(1 << 24) - 0.5);
            let seconds = sample as f64 * 0.02;
            writeln!(text, "{},{seconds},{u},{}", trial + 1, y + noise).unwrap();
        }
    }
    desk.write(name, &text);
}

/// Rest, one step, motion up to the end stop, step back: what a stop removes no plan can.
#[test]
fn a_plan_from_strokes_keeps_its_range_for_as_long_as_it_is() {
    let desk = desk();
    let strokes = (0..20).map(|index| {
        let level = [1.0, 1.5, 2.0][index / 2 % 3] * if index % 2 == 0 { 1.0 } else { -1.0 };
        let mut input = vec![0.0; 50];
        input.extend(vec![level; 350]);
        input.extend(vec![0.0; 50]);
        let output = by_hand(&input, -40.0 * level.signum(), None);
        (input, output)
    });
    write_trials(&desk, "strokes.csv", &strokes.collect::<Vec<_>>());
    let options = "design strokes.csv --output-range=-35,35 -o in.csv -q";
    let designed = &desk.json(options, 0)["joints"][0];
    let start = number(&designed["start"]);
    let trials = trials(&desk.read("in.csv"), "boom.input");
    let output = trials.iter().flat_map(|input| by_hand(input, start, None));
    assert!(output.into_iter().all(|y| (-35.0..=35.0).contains(&y)));
    assert!(number(&designed["steps"]) >= 6.0 && number(&designed["duration_s"]) >= 10.0);
}

/// A speed or a pressure comes to rest by itself: its error does not grow, and it needs no input of
/// the other sign.
#[test]
fn an_output_that_regulates_itself_is_played_at_levels_of_its_log() {
    let desk = desk();
    let levels = [0.0, 1.0, 2.0, 0.5, 1.5, 0.0, 2.0, 1.0, 0.5, 2.0, 1.5, 0.0, 1.0, 1.5, 0.5];
    let input: Vec<f64> =
        (0..size(1600, 2400)).map(|k| if k < 50 { 0.0 } else { levels[(k - 50) / 160] }).collect();
    let output = by_hand(&input, 4.0, Some(0.5));
    write_trials(&desk, "speed.csv", &[(input, output)]);
    let options = "design speed.csv --output-range=2,33 --duration 60 -o in.csv -q";
    let designed = &desk.json(options, 0)["joints"][0];
    let played = column(&desk.read("in.csv"), "boom.input");
    assert!(played.iter().all(|u| (0.0..=2.0).contains(u)));
    let start = *by_hand(&vec![played[0]; 500], 4.0, Some(0.5)).last().unwrap();
    assert!((start - number(&designed["start"])).abs() < 0.5);
    let output = by_hand(&played, start, Some(0.5));
    assert!(output.iter().all(|y| (2.0..=33.0).contains(y)));
    let said = desk.run("design speed.csv --output-range=2,33 --duration 60 -o in.csv -q");
    let said = String::from_utf8(said.stdout).unwrap();
    assert!(said.contains("until the output settles"), "{said}");
    let said = desk.refusal("design speed.csv --output-range=4.5,5.5 -o none.csv");
    assert!(said.contains("the output regulates itself"), "{said}");
}

#[test]
fn what_never_goes_back_in_the_log_is_driven_back_between_trials_alone() {
    let desk = desk();
    let input: Vec<f64> = (0..2000).map(|k| if k % 200 < 60 { 1.0 } else { 0.0 }).collect();
    let output = by_hand(&input, -39.0, None);
    write_trials(&desk, "up.csv", &[(input, output)]);
    let said = desk.refusal("design up.csv --output-range=-30,30 --trials 1 -o none.csv");
    assert!(said.contains("has positive inputs only"), "{said}");
    let joint = &desk.json("design up.csv --output-range=-30,30 -o up_only.csv -q", 0)["joints"][0];
    assert!(joint["trials"].as_array().unwrap().len() > 1);
    assert!(joint["levels"].as_array().unwrap().iter().all(|level| number(level) >= 0.0));
}

#[test]
fn holds_are_longer_than_the_response_or_that_is_said() {
    let desk = desk();
    let joint = &desk.json("design --model boom.toml", 0)["joints"][0];
    assert!(number(&joint["hold_s"]["low"]) >= 2.0 * 0.13);
    let short = &desk.json("design --model boom.toml --hold 0.05,0.1 --duration 5", 0);
    let note = short["joints"][0]["notes"][0].as_str().unwrap();
    assert!(note.contains("shorter than the 0.13 s in which the model responds"), "{note}");
}

/// A progressive valve looks like a dead band at large levels.
#[test]
fn a_log_and_two_suspects_give_an_input_and_its_power() {
    let desk = desk();
    let options = "design log.csv --separate dead_band,flow_curve --rehearsals 8 --power 0.9";
    let json = desk.json(&format!("{options} -o in.csv --preview see.csv -q"), 0);
    let joint = &json["joints"][0];
    let told = &joint["separates"];
    assert_fields(told, "effects order noise power_wanted power if_there");
    assert!(number(&told["power"]) >= 0.9 && (0.04..0.06).contains(&number(&told["noise"])));
    for side in told["if_there"].as_array().unwrap() {
        assert_eq!(side["rehearsed_told"], side["rehearsed"]);
        assert!(number(&side["noncentrality"]) > 25.0);
    }
    let input = column(&desk.read("in.csv"), "boom.input");
    assert!(input.iter().all(|level| level.abs() <= 1.5));
    let see = desk.read("see.csv");
    let apart = column(&see, "boom.dead_band").into_iter().zip(column(&see, "boom.flow_curve"));
    assert!(apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > 0.05);
}

/// What `spec` does with the input of a file, 50 samples a second, as a log.
fn logged(desk: &Desk, spec: JointSpec, input: &[f64], seed: u64) {
    let changes = (1..input.len()).filter(|k| (input[*k] - input[k - 1]).abs() > 0.0);
    let steps = changes.map(|k| (k + 1, input[k])).collect();
    let spec = JointSpec { input: InputSpec::Steps { steps, initial: input[0] }, ..spec };
    let plant = PlantSpec::new(seed, input.len() as f64 * 0.02, vec![spec]);
    let made = simulate(&PlantSpec { sample_period_s: 0.02, ..plant }).unwrap();
    let file = std::fs::File::create(desk.folder.path().join("next.csv")).unwrap();
    write_log(&made, file).unwrap();
}

/// The plant shares no equation with the models. `examples/statistics/design_power.rs` is the long form.
#[test]
fn what_is_there_is_told_by_the_designed_input_on_the_plant() {
    let desk = desk();
    let options = "design log.csv --separate dead_band,stiction --rehearsals 20 --power 0.9";
    let joint = &desk.json(&format!("{options} -o in.csv -q"), 0)["joints"][0];
    assert!(number(&joint["duration_s"]) < 10.0, "{}", joint["duration_s"]);
    let there = joint["separates"]["if_there"].as_array().unwrap();
    assert_eq!((&there[0]["told"], &there[0]["excluded"]), (&true.into(), &false.into()));
    let input = column(&desk.read("in.csv"), "boom.input");
    for seed in 1..=5 {
        logged(&desk, banded("boom"), &input, seed);
        let found = desk.json("explain next.csv --effects dead_band,stiction -q", 0);
        let found = &found["joints"][0];
        assert_eq!(found["verdict"], "missing_effect", "seed {seed}");
        let best = &found["ranking"][0];
        assert_eq!(best["effects"][0], "dead_band", "seed {seed}");
        assert_eq!(best["indistinguishable_from"].as_array().unwrap().len(), 0, "seed {seed}");
    }
}

#[test]
fn a_suspect_that_contains_the_other_is_said() {
    let desk = desk();
    let options = "design --model boom.toml --separate dead_band,coulomb_friction --duration 8 \
                   --rehearsals 0";
    let said = desk.refusal(options);
    assert!(said.contains("no input of 8 s or less distinguishes them"), "{said}");
    assert!(said.contains("one of them gives the same output as the other"), "{said}");
}

#[test]
fn what_cannot_be_designed_is_refused_in_one_message_and_leaves_no_file() {
    let desk = desk();
    desk.write("plain.toml", MODEL.split("[[joint.boom.effect]]").next().unwrap());
    let late = "schema = \"tauscope/model/1\"\n[joint.boom]\nstructure = \"integrator\"\n\
                parameters = { gain = 10.0, delay = 1e308 }\n";
    desk.write("late.toml", late);
    let cases = [
        ("--levels 1", "expected two levels or more"),
        ("--trials 0", "expected a whole number from 1 up"),
        ("--hold 2,1", "expected two numbers, the lower one first"),
        ("--hold 0.001,2", "less than a sample of 0.01 s"),
        ("--output-range=-1,1", "give --model or a log"),
        ("--hold 5,6 --duration 3", "too short for a rest and a hold of 5 s"),
        ("--model boom.toml --joint bucket", "not in the model file, which has boom"),
        ("--separate dead_band --model boom.toml", "expected two effects"),
        ("--separate dead_band,dead_band --model boom.toml", "named twice"),
        ("--separate dead_band,stictoin --model boom.toml", "did you mean `stiction`?"),
        ("--separate dead_band,stiction", "give a log, or --model"),
        ("--separate dead_band,stiction --model plain.toml", "has neither dead_band nor stiction"),
        ("--separate leakage,stiction --model boom.toml", "has neither leakage nor stiction"),
        ("missing.csv", "missing.csv"),
        ("--start NaN --model boom.toml", "expected a number"),
        ("--start inf --model boom.toml", "expected a number"),
        ("--largest 1e-320 --model boom.toml", "expected a number above zero"),
        ("--levels=1e308,-1e308 --model boom.toml", "expected two levels or more"),
        ("--rate 1e9 --model boom.toml --duration 60", "longer than the 1e6 that are searched"),
        ("--duration 1e9 --model boom.toml", "longer than the 1e6 that are searched"),
        (
            "--duration 1e9 --separate dead_band,stiction --noise 0.05 --model boom.toml",
            "longer than the 1e6 that are searched",
        ),
        ("--model late.toml --output-range=-50,50", "has a delay of 1.0e308 s"),
        ("--model late.toml", "has a delay of 1.0e308 s"),
    ];
    for (options, expected) in cases {
        let output = desk.run(&format!("design {options} -o none.csv"));
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{options}: {said}");
        assert!(said.contains(expected), "{options}: {said}");
        assert!(!desk.has("none.csv") && !said.contains("panicked"));
    }
}

#[test]
fn a_preview_that_is_no_table_and_no_page_is_refused_before_the_work() {
    let desk = desk();
    let said = desk.refusal("design log.csv --preview next.rrd -o none.csv");
    assert!(said.contains("call it FILE.csv") && said.lines().count() == 1, "{said}");
    assert!(!desk.has("next.rrd") && !desk.has("none.csv"));
}

#[test]
fn a_joint_that_cannot_be_read_is_left_out_and_said() {
    let desk = desk().with_broken_joint();
    let json = desk.json("design log.csv --duration 10", 1);
    assert_eq!(json["joints"].as_array().unwrap().len(), 1);
    assert!(json["failures"][0].as_str().unwrap().contains("broken"));
}

#[test]
fn joints_are_driven_together() {
    let desk = Desk::with(vec![banded("boom"), joint("stick")]);
    let options = "design log.csv --duration 20 --rate 50 -o in.csv -q";
    assert!(desk.run(options).status.success());
    let text = desk.read("in.csv");
    assert!(text.starts_with("time_s,boom.input,stick.input\n0,0,0\n0.02,0,0\n"));
    assert_ne!(column(&text, "boom.input"), column(&text, "stick.input"));
}
