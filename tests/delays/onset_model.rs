//! The onset model against plants that are integrated here step by step, which share nothing with it:
//! delays, leads, delays beyond the holds, outputs of other joints, and bump tests.

use crate::settling::random;
use tauscope::delay::{Decision, Method, Obstacle, Settings, TrialEstimate, Verdict, estimate};
use tauscope::experiment::Trial;
use tauscope::units::SamplePeriod;

const PERIOD_S: f64 = 0.01;

/// Steps of integration in a sample.
const FINER: usize = 100;

/// How a joint follows its delayed input.
#[derive(Clone, Copy)]
enum Plant {
    /// The speed at once.
    Integrator,
    /// The speed through a first-order lag with this time constant in seconds.
    Lag(f64),
    /// The speed through a pair of poles with this period in seconds and damping.
    Oscillation(f64, f64),
    /// The same after a first-order lag with this time constant.
    LagOscillation(f64, f64, f64),
    /// The speed through a lag of this time constant where it grows, of this where it falls.
    LagByDirection(f64, f64),
    /// The output itself through a first-order lag.
    FirstOrder(f64),
    /// The output at a constant rate into its level.
    Servo(f64),
    /// The speed through a lag, and play of this width before the sensor.
    Play(f64, f64),
    /// The output itself through two lags.
    SecondOrder(f64, f64),
}

/// A random input of `steps` levels with holds of a mean length in samples, and what the plant makes
/// of it `delay_s` later, or earlier.
fn trial(plant: Plant, delay_s: f64, steps: usize, hold: f64, seed: u32) -> Trial {
    let mut next = random(seed);
    let mut input = vec![0.0; 80];
    for _ in 0..steps {
        let level = 8.0 * (next() - 0.5);
        let length = hold * (0.6 + 0.8 * next());
        input.extend((0..).take_while(|k| f64::from(*k) < length).map(|_| level));
    }
    let output = response(plant, delay_s, &input, &mut next, 0.03);
    let period = SamplePeriod::from_seconds(PERIOD_S).unwrap();
    Trial::new("1", 0.0, period, input, output).unwrap()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the record")]
fn response(
    plant: Plant,
    delay_s: f64,
    input: &[f64],
    next: &mut impl FnMut() -> f64,
    noise: f64,
) -> Vec<f64> {
    let h = PERIOD_S / FINER as f64;
    let (mut y, mut v, mut w, mut x) = (0.0, 0.0, 0.0, 0.0);
    let mut output = Vec::new();
    for k in 0..input.len() * FINER {
        if k % FINER == 0 {
            let normal: f64 = (0..12).map(|_| next()).sum::<f64>() - 6.0;
            output.push(y + noise * normal);
        }
        let time = k as f64 * h - delay_s;
        let index = (time / PERIOD_S + 1e-9).floor().clamp(0.0, input.len() as f64 - 1.0);
        let u = input[index as usize];
        let speed = 10.0 * u;
        match plant {
            Plant::Integrator => y += h * speed,
            Plant::Lag(t) => {
                y += h * v;
                v += h * (speed - v) / t;
            }
            Plant::Oscillation(period, damping) => {
                let omega = std::f64::consts::TAU / period;
                y += h * v;
                v += h * w;
                w += h * (omega * omega * (speed - v) - 2.0 * damping * omega * w);
            }
            Plant::LagOscillation(t, period, damping) => {
                let omega = std::f64::consts::TAU / period;
                y += h * v;
                v += h * w;
                w += h * (omega * omega * (x - v) - 2.0 * damping * omega * w);
                x += h * (speed - x) / t;
            }
            Plant::LagByDirection(up, down) => {
                y += h * v;
                v += h * (speed - v) / if speed > v { up } else { down };
            }
            Plant::FirstOrder(t) => y += h * (u - y) / t,
            Plant::Play(t, width) => {
                w += h * v;
                v += h * (speed - v) / t;
                y = y.clamp(w - width / 2.0, w + width / 2.0);
            }
            Plant::SecondOrder(first, second) => {
                y += h * (v - y) / first;
                v += h * (u - v) / second;
            }
            Plant::Servo(rate) => y += h * ((u - y) / 0.01).clamp(-rate, rate),
        }
    }
    output
}

fn found(trial: &Trial) -> TrialEstimate {
    estimate(trial, &Settings::of(Method::AUTO)).unwrap()
}

/// Mean distance of the accepted delays from the true one in samples, the part whose interval holds
/// it, and how many there are.
fn against(found: &TrialEstimate, delay_s: f64) -> (f64, f64, usize) {
    let truth = delay_s / PERIOD_S;
    let accepted = found.decisions.iter().filter(|it| it.verdict() == Verdict::Accepted);
    let fine: Vec<_> = accepted.filter_map(|decision| decision.fine).collect();
    let n = fine.len() as f64;
    let error = fine.iter().map(|it| (it.delay - truth).abs()).sum::<f64>() / n;
    let covered = fine.iter().filter(|it| it.low <= truth && truth <= it.high).count() as f64 / n;
    (error, covered, fine.len())
}

#[test]
fn each_shape_is_found_with_its_delay() {
    let shapes = [
        (Plant::Integrator, "bend", 0.123),
        (Plant::Lag(0.12), "bend_lag", 0.087),
        (Plant::Oscillation(0.4, 0.3), "oscillation", 0.151),
        (Plant::Oscillation(0.5, 1.1), "bend_lag2", 0.064),
        (Plant::FirstOrder(0.3), "settling", 0.212),
        // Its arrival, where its input says, ends what is looked at.
        (Plant::Servo(6.0), "bend", 0.135),
    ];
    for (seed, (plant, shape, delay_s)) in (1..).zip(shapes) {
        let found = found(&trial(plant, delay_s, 24, 150.0, seed));
        let model = found.onset_model.as_deref().unwrap();
        let (error, covered, accepted) = against(&found, delay_s);
        assert_eq!(model.shape(), shape, "{model:?}");
        // Its windows are short.
        let (most, least) = if matches!(plant, Plant::Servo(_)) { (0.7, 0.6) } else { (0.5, 0.7) };
        assert!(error < most, "{shape}: {error} samples");
        assert!(covered > 0.7 && accepted >= 18, "{shape}: {covered} of {accepted}");
        assert_eq!(model.obstacle(), None, "{shape}");
        assert!(model.follows_input_r2() > least, "{shape}");
    }
}

#[test]
fn a_lag_that_hangs_on_the_direction_is_said() {
    for seed in 51..54 {
        let trial = trial(Plant::LagByDirection(0.03, 0.15), 0.1, 60, 150.0, seed);
        let found = found(&trial);
        assert!(found.onset_model.unwrap().is_misfit(), "{seed}");
    }
}

#[test]
fn a_response_that_is_not_alike_for_all_kinds_of_steps_is_said() {
    // In reversals the sensor waits until the play is crossed; changes of the speed don't show it.
    for seed in 31..34 {
        let trial = trial(Plant::Play(0.03, 0.8), 0.08, 60, 130.0, seed);
        let found = found(&trial);
        let model = found.onset_model.as_deref().unwrap();
        assert!(model.is_misfit() && model.obstacle().is_none(), "{model:?}");
        let one_side = |it: &&Decision| it.input_step.before * it.input_step.after > 0.0;
        let fine: Vec<_> =
            found.decisions.iter().filter(one_side).filter_map(|it| it.fine).collect();
        let holds = fine.iter().filter(|it| it.low <= 8.0 && 8.0 <= it.high).count();
        assert!(fine.len() > 15 && 10 * holds >= 8 * fine.len(), "{seed}: {holds} of {fine:?}");
    }
}

#[test]
fn joints_that_fit_are_not_warned_of() {
    let plants = [
        Plant::Integrator,
        Plant::Lag(0.06),
        Plant::Oscillation(0.3, 0.4),
        Plant::Oscillation(0.4, 1.2),
    ];
    for (plant, seed) in plants.into_iter().flat_map(|plant| (41..44).map(move |it| (plant, it))) {
        let found = found(&trial(plant, 0.11, 50, 130.0, seed));
        let model = found.onset_model.as_deref().unwrap();
        assert!(!model.is_misfit() && !model.has_own_shapes(), "{seed}: {model:?}");
    }
}

#[test]
fn a_lag_before_an_oscillation_has_its_delay() {
    // Holds of 0.6 to 1.4 s.
    let plants = [(0.05, 0.25, 0.4), (0.11, 0.24, 0.2), (0.09, 0.27, 0.45), (0.1, 0.3, 0.6)];
    for ((t, period, damping), seed) in plants.into_iter().zip(61..) {
        let trial = trial(Plant::LagOscillation(t, period, damping), 0.1, 60, 100.0, seed);
        let found = found(&trial);
        let model = found.onset_model.as_deref().unwrap();
        let (error, covered, accepted) = against(&found, 0.1);
        assert!(!model.is_misfit() && model.shape() == "oscillation", "{t} s: {model:?}");
        assert!(error < 0.3 && covered > 0.8, "{t} s: {error} {covered}");
        assert!(accepted > 50, "{t} s: {accepted}");
        assert!(model.parameters().iter().any(|(_, constant)| (constant / t - 1.0).abs() < 0.1));
    }
}

#[test]
fn a_bump_test_of_second_order_has_the_delay_of_its_input() {
    let pairs = [(0.8, 0.2, 0.3), (1.5, 0.9, 0.2), (0.5, 0.4, 0.5)];
    for (seed, (first, second, delay_s)) in (51..).zip(pairs) {
        let input: Vec<f64> = (0..1200).map(|k| if k < 150 { 0.0 } else { 15.0 }).collect();
        let plant = Plant::SecondOrder(first, second);
        let output = response(plant, delay_s, &input, &mut random(seed), 0.05);
        let period = SamplePeriod::from_seconds(PERIOD_S).unwrap();
        let found = found(&Trial::new("1", 0.0, period, input, output).unwrap());
        let model = found.onset_model.as_deref().unwrap();
        let fine = found.decisions[0].fine.unwrap();
        let truth = delay_s / PERIOD_S;
        assert_eq!(model.shape(), "settling");
        assert!((fine.delay - truth).abs() < 0.1 * first / PERIOD_S, "{fine:?}: {truth}");
        assert!(fine.low <= truth && truth <= fine.high, "{fine:?}: {truth}");
    }
}

#[test]
fn an_output_that_leads_its_input_has_no_delays() {
    for (seed, lead_s) in [(11, 0.05), (12, 0.2), (13, 0.4)] {
        let found = found(&trial(Plant::Lag(0.05), -lead_s, 20, 130.0, seed));
        let Some(Obstacle::Leads(by)) = found.onset_model.as_deref().unwrap().obstacle() else {
            panic!("{lead_s}: {:?}", found.onset_model)
        };
        assert!((by - lead_s).abs() < 0.01, "{lead_s}: {by}");
        assert_eq!(against(&found, 0.0).2, 0);
    }
}

#[test]
fn a_delay_beyond_the_holds_is_said() {
    let found = found(&trial(Plant::Integrator, 2.3, 24, 90.0, 21));
    let Some(Obstacle::BeyondHolds(by)) = found.onset_model.as_deref().unwrap().obstacle() else {
        panic!("{:?}", found.onset_model)
    };
    assert!((by - 2.3).abs() < 0.02, "{by}");
    assert_eq!(against(&found, 0.0).2, 0);
}

#[test]
fn the_output_of_another_joint_has_no_delays() {
    let [one, other] = [31, 32].map(|seed| trial(Plant::Integrator, 0.1, 24, 120.0, seed));
    let samples = one.len().min(other.len());
    let exchanged = Trial::new(
        "1",
        0.0,
        one.period(),
        one.input()[..samples].to_vec(),
        other.output()[..samples].to_vec(),
    );
    let settings = Settings::of(Method::AUTO);
    let found = estimate(exchanged.as_ref().unwrap(), &settings).unwrap();
    assert_eq!(found.onset_model.as_deref().unwrap().obstacle(), Some(Obstacle::Unrelated));
    assert_eq!(against(&found, 0.0).2, 0);
    let anyway = Settings { accept_anyway: true, ..settings };
    assert!(against(&estimate(exchanged.as_ref().unwrap(), &anyway).unwrap(), 0.0).2 > 0);
}

#[test]
fn one_step_is_enough_for_a_bump_test() {
    for (seed, dead_s, t_s) in [(41, 0.3, 1.2), (42, 0.08, 0.9), (43, 1.0, 2.0)] {
        let mut next = random(seed);
        let input: Vec<f64> = (0..900).map(|k| f64::from(u8::from(k >= 150))).collect();
        let output = response(Plant::FirstOrder(t_s), dead_s, &input, &mut next, 0.01);
        let period = SamplePeriod::from_seconds(PERIOD_S).unwrap();
        let found = found(&Trial::new("1", 0.0, period, input, output).unwrap());
        let model = found.onset_model.as_deref().unwrap();
        assert_eq!(model.shape(), "settling");
        let (_, constant_s) = model.parameters()[0];
        assert!((constant_s / t_s - 1.0).abs() < 0.1, "{constant_s} {t_s}");
        let (error, _, accepted) = against(&found, dead_s);
        assert!(accepted == 1 && error * PERIOD_S < 0.05 * t_s, "{dead_s}: {error}");
    }
}
