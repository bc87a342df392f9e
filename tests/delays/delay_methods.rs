//! Delays between samples with their intervals: the broken line, and the lag after it.

use std::path::Path;
use std::process::{Command, Output};

use crate::sample::{least, size};
use tauscope::delay::{
    Condition, Decision, InputKind, Method, Settings, TrialEstimate, Verdict, estimate,
    estimate_joint, step_delays,
};
use tauscope::effect::VariableDelay;
use tauscope::experiment::{Record, Trial};
use tauscope::fit::{FitRecord, Horizon, Split};
use tauscope::model::{Component, JointModel};
use tauscope::synthetic::{
    DelayLaw, InputSpec, JointSpec, PlantSpec, Ringing, Synthetic, simulate, write_log,
};
use tauscope::units::SamplePeriod;

/// A joint with delays of 5 to 40 samples and noise of 0.05 degrees, for 60 s at 100 Hz.
fn joint() -> JointSpec {
    let levels = (-4..=4).map(|half| 0.5 * f64::from(half)).collect();
    let input = InputSpec::Levels { levels, hold_s: [0.9, 2.0] };
    let delay = DelayLaw::Uniform { min: 0.05, max: 0.4 };
    JointSpec { noise: 0.05, ..JointSpec::new("arm", input, delay) }
}

fn made(joint: JointSpec) -> Synthetic {
    lasting(60.0, joint)
}

fn lasting(seconds: f64, joint: JointSpec) -> Synthetic {
    simulate(&PlantSpec::new(5, seconds, vec![joint])).unwrap()
}

fn found(made: &Synthetic, method: Method) -> TrialEstimate {
    estimate(&made.joints[0].trials[0], &Settings::of(method)).unwrap()
}

/// Mean error over the accepted steps, which must be most of them.
fn mean_error(made: &Synthetic, found: &TrialEstimate) -> f64 {
    let pairs = made.truth.iter().zip(&found.decisions);
    let errors: Vec<f64> = pairs
        .filter_map(|(truth, decision)| {
            Some((decision.accepted_delay()? - truth.delay_samples).abs())
        })
        .collect();
    assert!(2 * errors.len() > made.truth.len(), "{} accepted", errors.len());
    errors.iter().sum::<f64>() / errors.len() as f64
}

#[test]
fn lines_that_meet_find_the_delay_between_samples() {
    let made = made(joint());
    let error = mean_error(&made, &found(&made, Method::HINGE));
    assert!(error < 0.13, "{error}");
}

/// Delays shorter than α, at rates at which the reaction to the next step lies in a segment.
#[test]
fn short_delays_are_not_taken_for_those_of_the_next_step() {
    let mut wrong_of_the_paper = 0;
    for (period_s, delay_s) in [(0.02, 0.02), (0.02, 0.04), (0.05, 0.1), (0.1, 0.3)] {
        for seed in 1..=5 {
            let joint = JointSpec { delay: DelayLaw::Constant { seconds: delay_s }, ..joint() };
            let spec =
                PlantSpec { sample_period_s: period_s, ..PlantSpec::new(seed, 120.0, vec![joint]) };
            let trial = &simulate(&spec).unwrap().joints[0].trials[0];
            let errors = |settings: &Settings| -> Vec<f64> {
                let found = estimate(trial, settings).unwrap();
                let delays = found.decisions.iter().filter_map(Decision::accepted_delay);
                delays.map(|delay| (delay - delay_s / period_s).abs()).collect()
            };
            let found = errors(&Settings::of(Method::TWO_LINE));
            let wrong = found.iter().filter(|error| **error > 6.0).count();
            assert!(found.len() > 40 && wrong <= 2, "{period_s} {delay_s} {seed}: {wrong}");
            let paper = errors(&Settings { paper: true, ..Settings::of(Method::TWO_LINE) });
            wrong_of_the_paper += usize::from(paper.iter().filter(|e| **e > 6.0).count() > 20);
        }
    }
    assert!(wrong_of_the_paper > 0, "Algorithm 1 to the letter is not corrected");
}

#[test]
fn dead_time_is_separated_from_a_lag_and_from_ringing() {
    let lag = JointSpec { lag_s: Some(0.06), ..joint() };
    let ringing = Ringing { period_s: 0.4, damping: 0.25 };
    for spec in [lag, JointSpec { ringing: Some(ringing), ..joint() }] {
        let (lag_s, made) = (spec.lag_s, made(spec));
        let booked = mean_error(&made, &found(&made, Method::HINGE));
        assert!(booked > 3.0, "lines that meet book the lag as delay: {booked}");
        let estimate = found(&made, Method::LAG_AWARE);
        let error = mean_error(&made, &estimate);
        assert!(error < 0.2, "{error}");
        let model = estimate.onset_model.unwrap();
        let expected = lag_s.map_or(("period_s", 0.4), |lag_s| ("time_constant_s", lag_s));
        let (name, found) = model.parameters()[0];
        assert_eq!(name, expected.0);
        assert!((found / expected.1 - 1.0).abs() < 0.05, "{model:?}");
    }
}

#[test]
fn without_a_lag_there_is_none_to_report() {
    let made = made(joint());
    let model = found(&made, Method::AUTO).onset_model.unwrap();
    assert_eq!((model.shape(), model.lag_s()), ("bend", None));
}

#[test]
fn nothing_happens_in_a_dead_band() {
    let input =
        InputSpec::Levels { levels: vec![-1.0, -0.4, -0.2, 0.2, 0.4, 1.0], hold_s: [0.9, 2.0] };
    let made = made(JointSpec { input, dead_band: Some([-0.5, 0.5]), gain: 20.0, ..joint() });
    let still: Vec<usize> =
        made.truth.iter().filter(|s| s.slope_change == 0.0).map(|s| s.i).collect();
    assert!(still.len() > 10);
    for method in Method::all() {
        let settings = Settings { confidence: Some(0.99), ..Settings::of(method) };
        let found = estimate(&made.joints[0].trials[0], &settings).unwrap();
        let accepted = |i: &&usize| found.decisions[**i - 1].verdict() == Verdict::Accepted;
        assert!(still.iter().filter(accepted).count() <= 1, "{method}");
        let moved = made.truth.iter().filter(|s| s.slope_change != 0.0);
        let missed = moved.filter(|s| {
            found.decisions[s.i - 1].failed().any(|failed| failed == Condition::NothingHappened)
        });
        assert!(missed.count() <= 1, "{method}");
    }
}

#[test]
fn the_papers_method_tests_nothing_by_itself() {
    let made = made(joint());
    let found = found(&made, Method::TWO_LINE);
    let checks = found.decisions.iter().flat_map(|decision| decision.checks.iter());
    let mut tests = checks.filter(|check| check.condition == Condition::NothingHappened);
    assert!(tests.all(|check| check.value.is_none() && check.limit.is_none()));
}

/// Between −0.5 and 0.5, as good as chance.
fn chance(number: u32) -> f64 {
    let wild = (f64::from(number) * 12.9898).sin() * 43_758.545;
    wild - wild.floor() - 0.5
}

#[test]
fn a_joint_that_never_reacts_has_no_delay() {
    let level = |k: u32| [0.0, 1.0, -1.0, 0.5][(k / 90) as usize % 4];
    let period = SamplePeriod::from_seconds(0.01).unwrap();
    let input = (0..3000).map(level).collect();
    let output = (0..3000).map(|k| 20.0 + 0.1 * chance(k)).collect();
    let trial = Trial::new("1", 0.0, period, input, output).unwrap();
    for method in Method::all() {
        let found = estimate(&trial, &Settings::of(method)).unwrap();
        let accepted = found.decisions.iter().filter(|d| d.verdict() == Verdict::Accepted);
        // The noise of the first steps is not known yet.
        assert!(found.decisions.len() > 30 && accepted.count() <= 2, "{method}");
    }
}

/// A stroke from one side to the other and its end, 0.2 s late after two lags of 0.05 s, under a
/// load that depends on the angle.
fn stroke_under_load(number: u32) -> Trial {
    let direction = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
    let level = direction * f64::from(4 + number * 7 % 6);
    let until_s = 2.5 + 0.5 * f64::from(number * 5 % 9);
    let at = |time_s: f64| if (1.0 - 1e-9..until_s).contains(&time_s) { level } else { 0.0 };
    let (mut first, mut second, mut angle) = (0.0, 0.0, -40.0 * direction);
    let (mut input, mut output) = (Vec::new(), Vec::new());
    for sample in 0..300 {
        let time_s = 0.01 * f64::from(sample);
        input.push(at(time_s));
        output.push(angle + 0.1 * chance(1000 * number + sample));
        for fine in 0..10 {
            let opening = at(time_s + 0.001 * f64::from(fine) - 0.2);
            let flow = opening.signum() * (opening.abs() - 0.5).max(0.0) * 4.0;
            let gravity: f64 = (2.0 * angle).to_radians().cos();
            let speed = flow * (1.0 - 0.4 * flow.signum() * gravity).max(0.05).sqrt();
            first += (speed - first) / 50.0;
            second += (first - second) / 50.0;
            angle += 0.001 * second;
        }
    }
    let period = SamplePeriod::from_seconds(0.01).unwrap();
    Trial::new(number.to_string(), 0.0, period, input, output).unwrap()
}

#[test]
fn what_a_load_does_along_a_stroke_is_no_lag() {
    let trials: Record = (0..24).map(stroke_under_load).collect();
    let found = estimate_joint(&trials, &Settings::of(Method::LAG_AWARE));
    for trial in found {
        let trial = trial.unwrap();
        // Either it is the lag of the valve, or none is taken for known.
        let lag_s = trial.onset_model.as_ref().unwrap().lag_s();
        assert!(lag_s.is_none_or(|lag_s| (lag_s - 0.1).abs() < 0.05), "{lag_s:?}");
        for delay in trial.decisions.iter().filter_map(Decision::delay) {
            assert!(delay < 60.0, "{delay} samples, of 20 and a lag of 10");
        }
    }
}

#[test]
fn trials_share_their_lag() {
    let spec = JointSpec { lag_s: Some(0.06), ..joint() };
    let trial = |seed| {
        let made = simulate(&PlantSpec::new(seed, 20.0, vec![spec.clone()])).unwrap();
        made.joints[0].trials[0].clone()
    };
    let trials = Record::from([trial(5), trial(6)]);
    let lags = |trials: &Record| -> Vec<f64> {
        let found = estimate_joint(trials, &Settings::of(Method::LAG_AWARE)).into_iter();
        found.map(|trial| trial.unwrap().onset_model.unwrap().lag_s().unwrap()).collect()
    };
    let together = lags(&trials);
    assert_eq!(together[0].to_bits(), together[1].to_bits());
    for trial in &trials {
        let alone = lags(&Record::from([trial.clone()]));
        assert!(alone[0].to_bits() != together[0].to_bits(), "each trial alone has another lag");
    }
}

#[test]
fn delays_go_into_a_fit() {
    let made = lasting(20.0, JointSpec { lag_s: Some(0.06), ..joint() });
    let joint = &made.joints[0];
    let delays = step_delays(&joint.trials).unwrap();
    assert_eq!(delays[0].len(), made.truth.len());
    let record = FitRecord::new(joint, Split::Time(1.0), Horizon::Steps).with_delays(delays);
    let measured = Component::measured(&VariableDelay).unwrap();
    let model = JointModel::integrator(10.0, 0.2).with(measured);
    let arrivals = record.arrivals(&model, 0);
    let truth = &made.truth[3];
    let expected = (truth.p as f64 - 1.0) * 0.01 + truth.delay_s;
    let nearest = arrivals.changes.iter().map(|change| (change.time_s - expected).abs());
    assert!(nearest.fold(f64::INFINITY, f64::min) < 0.01);
}

#[test]
fn odd_outputs_are_estimated_or_refused_but_nothing_panics() {
    let period = SamplePeriod::from_seconds(0.01).unwrap();
    let input = |k: i32| f64::from(k / 7 % 3);
    let outputs: [fn(i32) -> f64; 6] = [
        |_| 0.0,
        f64::from,
        |k| f64::from(k % 2),
        |k| if k == 30 { 1e300 } else { 0.0 },
        |k| 1e-300 * f64::from(k * k),
        |k| 1e9 + f64::from(k % 5),
    ];
    for (output, length) in outputs.iter().flat_map(|o| [2, 9, 15, 40, 200].map(|n| (o, n))) {
        let trial = Trial::new(
            "1",
            0.0,
            period,
            (0..length).map(input).collect(),
            (0..length).map(*output).collect(),
        )
        .unwrap();
        for method in Method::all() {
            // Levels of 0.07 s alone would pass for an input that moves all the time.
            let settings = Settings { input: InputKind::Steps, ..Settings::of(method) };
            let found = estimate(&trial, &settings).unwrap();
            assert_eq!(found.decisions.len(), usize::try_from((length - 1) / 7).unwrap());
        }
    }
}

/// What became of the moving steps of some records of 120 s, pooled; the last one of each is
/// not over at the end.
#[derive(Debug, Default)]
struct Pool {
    errors: Vec<f64>,
    covered: usize,
    still: usize,
    still_accepted: usize,
}

impl Pool {
    fn of(joint: &JointSpec, method: Method, seeds: std::ops::RangeInclusive<u64>) -> Self {
        let mut pool = Self::default();
        for seed in seeds {
            let made = simulate(&PlantSpec::new(seed, 120.0, vec![joint.clone()])).unwrap();
            let found = estimate(&made.joints[0].trials[0], &Settings::of(method)).unwrap();
            let steps = made.truth.len() - 2;
            for (truth, decision) in made.truth.iter().zip(&found.decisions).take(steps) {
                let delay = decision.accepted_delay();
                if truth.slope_change == 0.0 {
                    pool.still += 1;
                    pool.still_accepted += usize::from(delay.is_some());
                } else if let (Some(delay), Some(fine)) = (delay, decision.fine) {
                    let truth = truth.delay_samples;
                    pool.errors.push((delay - truth).abs());
                    pool.covered += usize::from((fine.low..=fine.high).contains(&truth));
                }
            }
        }
        pool
    }

    fn mean_error(&self) -> f64 {
        self.errors.iter().sum::<f64>() / self.errors.len() as f64
    }

    /// Whether 95 % intervals hold the truth in 95 % of the cases, within four standard deviations:
    /// steps of a record share an error.
    fn assert_covers(&self) {
        let (count, missed) = (self.errors.len(), self.errors.len() - self.covered);
        assert!(self.covered >= least(count, 0.95, 4.0), "{} of {count}", self.covered);
        assert!(missed >= least(count, 0.05, 4.0), "{} of {count}", self.covered);
    }
}

const RINGING: Option<Ringing> = Some(Ringing { period_s: 0.4, damping: 0.25 });

#[test]
fn errors_are_small_and_intervals_hold_what_they_say() {
    let ideal = Pool::of(&joint(), Method::HINGE, 1..=size(3, 10));
    // The small sample allows for three standard errors of its mean.
    let slack = size(0.025, 0.0);
    assert!(ideal.mean_error() <= 0.1 + slack, "{}", ideal.mean_error());
    ideal.assert_covers();
    let plants = [
        joint(),
        JointSpec { lag_s: Some(0.06), ..joint() },
        JointSpec { ringing: RINGING, ..joint() },
    ];
    for plant in plants {
        let pool = Pool::of(&plant, Method::LAG_AWARE, 1..=size(3, 10));
        assert!(pool.mean_error() <= 0.15 + slack, "{plant:?}: {}", pool.mean_error());
        pool.assert_covers();
    }
}

/// The reaction to a command that the log does not hold is no lag of all steps.
#[test]
fn a_log_that_begins_within_a_delay_shows_no_lag() {
    /// Samples of the delay that have passed.
    const PASSED: usize = 6;
    let levels = (-2..=2).map(f64::from).collect();
    let input = InputSpec::Levels { levels, hold_s: [1.0, 2.5] };
    let delay = DelayLaw::Constant { seconds: 0.2 };
    let made = lasting(90.0, JointSpec { noise: 0.02, ..JointSpec::new("arm", input, delay) });
    let whole = &made.joints[0].trials[0];
    for step in made.truth.iter().take(12) {
        let first = step.p - 1 + PASSED;
        let [input, output] = [whole.input(), whole.output()].map(|all| all[first..].to_vec());
        let trial = Trial::new("1", 0.0, whole.period(), input, output).unwrap();
        let found = estimate(&trial, &Settings::of(Method::LAG_AWARE)).unwrap();
        let model = found.onset_model.unwrap();
        assert_eq!(model.lag_s(), None, "begun at sample {first}: {model:?}");
    }
}

#[test]
fn holds_may_be_shorter_than_delay_and_lag() {
    let short = JointSpec {
        input: InputSpec::Levels {
            levels: (-4..=4).map(|half| 0.5 * f64::from(half)).collect(),
            hold_s: [0.2, 0.5],
        },
        delay: DelayLaw::Uniform { min: 0.05, max: 0.3 },
        ..joint()
    };
    let plants =
        [JointSpec { lag_s: Some(0.06), ..short.clone() }, JointSpec { ringing: RINGING, ..short }];
    for plant in &plants[..size(1, 2)] {
        let pool = Pool::of(plant, Method::LAG_AWARE, 1..=1);
        assert!(pool.mean_error() <= 1.5, "{plant:?}: {}", pool.mean_error());
        assert!(pool.errors.len() > 250, "{plant:?}: {}", pool.errors.len());
    }
}

#[test]
fn one_still_step_of_a_hundred_is_taken_for_a_reaction() {
    let levels = vec![-1.0, -0.4, -0.2, 0.2, 0.4, 1.0];
    let input = InputSpec::Levels { levels, hold_s: [0.9, 2.0] };
    let dead = JointSpec { input, dead_band: Some([-0.5, 0.5]), gain: 20.0, ..joint() };
    for plant in [JointSpec { lag_s: Some(0.06), ..dead.clone() }, dead] {
        let records = size(3, 10);
        let pool = Pool::of(&plant, Method::LAG_AWARE, 1..=records);
        assert!(pool.still as u64 > 30 * records, "{}", pool.still);
        // In a small sample one more than a hundredth may be.
        let allowed = pool.still / 100 + size(1, 0);
        assert!(pool.still_accepted <= allowed, "{pool:?}");
    }
}

/// `tauscope estimate` in a folder with the log of a lagged joint.
fn run(folder: &Path, arguments: &str) -> Output {
    let log = std::fs::File::create(folder.join("log.csv")).unwrap();
    write_log(&made(JointSpec { lag_s: Some(0.06), ..joint() }), log).unwrap();
    let program = Command::new(env!("CARGO_BIN_EXE_tauscope"))
        .current_dir(folder)
        .args(["estimate", "log.csv"])
        .args(arguments.split_whitespace())
        .output()
        .unwrap();
    assert!(program.status.success(), "{}", String::from_utf8_lossy(&program.stderr));
    program
}

#[test]
fn two_methods_stand_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    let output =
        run(folder.path(), "--method lag-aware --method two-line --format json --decisions d.csv");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["settings"]["method"], "lag-aware");
    assert_eq!(json["also"][0]["settings"]["method"], "two-line");
    let lag = &json["joints"][0]["onset_model"]["parameters"]["time_constant_s"];
    assert!((lag.as_f64().unwrap() - 0.06).abs() < 0.01, "{lag}");
    let (first, second) =
        (&json["joints"][0]["decisions"], &json["also"][0]["joints"][0]["decisions"]);
    assert!(first[1]["delta_low"].as_f64() < first[1]["delta"].as_f64());
    assert!(first[1]["delta"].as_f64() < second[1]["delta"].as_f64());
    assert_eq!(first[0]["accepted_with"], "--keep-first-last");
    let table = std::fs::read_to_string(folder.path().join("d.csv")).unwrap();
    let header = table.lines().next().unwrap();
    assert!(header.ends_with(
        "failed,method,delta_low,delta_high,p_value,runner_up_q,runner_up_margin,accepted_with"
    ));
    assert_eq!(table.lines().count() - 1, 2 * first.as_array().unwrap().len());
}

#[test]
fn the_papers_table_of_decisions_stays_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), "--method two-line --decisions d.csv");
    let table = std::fs::read_to_string(folder.path().join("d.csv")).unwrap();
    assert_eq!(
        table.lines().next().unwrap(),
        "joint,trial,i,p,r,end,candidates,f_opt,q,delta,delta_s,sse,slope_before,\
         intercept_before,slope_after,intercept_after,verdict,failed"
    );
}

#[test]
fn every_step_says_how_near_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), "--method hinge --steps --min-slope-change 0.2");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("--keep-first-last"), "{text}");
    assert!(text.contains("--min-slope-change 0.1"), "{text}");
    assert!(text.contains("% above at q = "), "{text}");
    assert!(text.contains("; interval of a delay "), "{text}");
}
