//! How often a fit finds the parameters that made a record, and how sure of them it is.
//!
//! For each effect of the catalogue, seeded records of a joint with that effect are
//! simulated, noise is added, and gain, delay and the effect are fitted from neutral.

use std::time::{Duration, Instant};

use anyhow::Context as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};
use tauscope::effect::{Effect, REGISTRY};
use tauscope::experiment::{Joint, Trial};
use tauscope::fit::{Fit, FitRecord, Horizon, Split, Status, fit};
use tauscope::model::{Component, JointModel, Surroundings, Value, simulate_input};
use tauscope::units::SamplePeriod;

/// Records per effect where no number is given.
const RECORDS: u64 = 200;
/// Output units per second and input unit.
const GAIN: f64 = 8.0;
const DELAY_S: f64 = 0.15;
/// Standard deviation of the noise, output units.
const NOISE: f64 = 0.05;
const PERIOD_S: f64 = 0.01;
/// Samples of each of two trials.
const SAMPLES: usize = 3000;
/// Seconds from the start of the first trial to that of the second.
const SECOND_TRIAL_S: f64 = 35.0;

/// Parameters of each effect at a clear strength.
fn truth(id: &str) -> &'static [f64] {
    match id {
        "input_offset" => &[0.2],
        "dead_band" => &[-0.5, 0.7],
        "stiction" => &[1.2, 0.5],
        "input_saturation" => &[3.0, 0.3],
        "asymmetric_saturation" => &[3.0, 0.3, 2.4],
        "flow_curve" => &[1.3],
        "direction_gain" => &[0.75],
        "rate_limit" => &[0.06, 0.3],
        "variable_delay" => &[-0.03, 0.03, 0.03, 0.0005, 3.0, 2.0, 100.0, 0.0],
        "actuator_lag" | "spool_lag" => &[0.12],
        "resonance" => &[0.3, 0.2],
        "oil_column" => &[0.3, 0.08, 0.03, 0.006, 0.0, 0.0],
        "coulomb_friction" => &[0.5, 0.4, 0.12],
        "asymmetric_friction" => &[0.5, 0.4, 0.12, 1.4],
        "gravity_load" => &[0.4, 20.0, 1.5],
        "position_gain" => &[0.004, -4e-5, 0.0],
        "thermal_drift" => &[0.01, 20.0],
        "supply_droop" => &[0.4],
        "leakage" => &[0.15, 10.0],
        "end_stop" => &[-25.0, 30.0],
        "backlash" => &[2.0],
        _ => &[],
    }
}

/// A record, and the activity of the other joints in it.
struct Made {
    joint: Joint,
    others: Vec<Vec<f64>>,
}

/// Random levels that keep a joint of nominal gain about its middle.
fn levels(random: &mut ChaCha8Rng) -> Vec<f64> {
    let (mut levels, mut angle, mut level, mut left) = (Vec::new(), 0.0_f64, 0.0, 40);
    while levels.len() < SAMPLES {
        if left == 0 {
            let size = random.random_range(0.2..5.0);
            let home = if angle.abs() > 20.0 { -angle.signum() } else { 1.0 };
            let turn = if angle.abs() <= 20.0 && random.random_bool(0.5) { -1.0 } else { home };
            level = if random.random_bool(0.15) { 0.0 } else { size * turn };
            left = random.random_range(30..150);
        }
        angle += GAIN * level * PERIOD_S;
        left -= 1;
        levels.push(level);
    }
    levels
}

fn make(model: &JointModel, seed: u64) -> anyhow::Result<Made> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut trials, mut others) = (Vec::new(), Vec::new());
    for start_s in [0.0, SECOND_TRIAL_S] {
        let input = levels(&mut random);
        let activity: Vec<f64> = levels(&mut random).iter().map(|u| u.abs() / 5.0).collect();
        let output = measured(model, &input, &activity, start_s, &mut random)?;
        trials.push(trial(start_s, input, output)?);
        others.push(activity);
    }
    let joint = Joint::new("joint", trials).with_units("V", "deg");
    Ok(Made { joint, others })
}

fn trial(start_s: f64, input: Vec<f64>, output: Vec<f64>) -> anyhow::Result<Trial> {
    let period = SamplePeriod::from_seconds(PERIOD_S).context("a period is above zero")?;
    Ok(Trial::new(format!("from {start_s} s"), start_s, period, input, output)?)
}

/// The simulated output with noise, from a random angle.
fn measured(
    model: &JointModel,
    input: &[f64],
    others: &[f64],
    start_s: f64,
    random: &mut ChaCha8Rng,
) -> anyhow::Result<Vec<f64>> {
    let output = random.random_range(-10.0..10.0);
    let surroundings = Surroundings {
        others,
        radians_per_output_unit: 1_f64.to_radians(),
        start_s,
        ..Surroundings::default()
    };
    let simulated = simulate_input(model, input, PERIOD_S, output, &surroundings);
    let noise = Normal::new(0.0, NOISE)?;
    Ok(simulated.output.iter().map(|y| y + noise.sample(random)).collect())
}

/// What became of one parameter in all records.
#[derive(Default)]
struct Tally {
    /// Error over standard error, where there is one.
    scores: Vec<f64>,
    at_bound: usize,
    undetermined: usize,
}

impl Tally {
    fn add(&mut self, error: f64, std_error: Option<f64>, status: Status) {
        self.at_bound += usize::from(status == Status::AtBound);
        match std_error {
            Some(std_error) => self.scores.push(error / std_error),
            None => self.undetermined += usize::from(status != Status::Fixed),
        }
    }

    fn count(&self) -> usize {
        self.scores.len() + self.undetermined
    }

    /// Share of the records within `limit` standard errors, in percent.
    fn within(&self, limit: f64) -> f64 {
        let count = self.scores.iter().filter(|score| score.abs() <= limit).count();
        100.0 * count as f64 / self.count() as f64
    }

    fn mean(&self) -> f64 {
        self.scores.iter().sum::<f64>() / self.scores.len() as f64
    }
}

/// The coverage of one effect's parameters.
struct Coverage {
    names: Vec<String>,
    tallies: Vec<Tally>,
    median_time: Duration,
}

fn component(effect: &'static dyn Effect, values: &[f64]) -> anyhow::Result<Component> {
    let values = values.iter().map(|value| Value::from(*value)).collect();
    Component::new(effect, values).context("an effect has a truth for each parameter")
}

/// The effect at its neutral values; what a fit does not change is as in the truth.
fn neutral(effect: &'static dyn Effect, truth: &[f64]) -> anyhow::Result<Component> {
    let parameters = effect.spec().parameters.iter().zip(truth);
    let value = |(parameter, truth): (&tauscope::effect::Parameter, &f64)| {
        if parameter.fitted {
            Value::from(parameter.neutral)
        } else {
            Value { fixed: true, ..Value::from(*truth) }
        }
    };
    Component::new(effect, parameters.map(value).collect())
        .context("an effect has a truth for each parameter")
}

fn fitted(made: &Made, start: &JointModel) -> anyhow::Result<Fit> {
    let record = FitRecord::new(&made.joint, Split::Time(1.0), Horizon::FreeRun);
    let record = record.with_others(made.others.clone());
    let top = record.input_levels().last().copied().unwrap_or(1.0);
    Ok(fit(&record, start, &record.range(GAIN * top))?)
}

/// Gravity with the signs of `kappa` and `creep` turned, and `y0` half a turn on, is the
/// same.
fn one_of_equals(id: &str, values: &mut [f64]) {
    if let ("gravity_load", [_, _, kappa, y0, creep]) = (id, values) {
        if *kappa < 0.0 {
            (*kappa, *y0, *creep) = (-*kappa, *y0 + 180.0, -*creep);
        }
        *y0 -= 360.0 * (*y0 / 360.0).round();
    }
}

fn cover(effect: &'static dyn Effect, records: u64) -> anyhow::Result<Coverage> {
    let (id, parameters) = (effect.spec().id, truth(effect.spec().id));
    let model = JointModel::integrator(GAIN, DELAY_S).with(component(effect, parameters)?);
    let start =
        JointModel::integrator(0.9 * GAIN, 0.6 * DELAY_S).with(neutral(effect, parameters)?);
    let expected: Vec<f64> = model.values().iter().map(|value| value.value).collect();
    let mut tallies: Vec<Tally> = expected.iter().map(|_| Tally::default()).collect();
    let mut times = Vec::new();
    for seed in 0..records {
        let made = make(&model, seed)?;
        let begun = Instant::now();
        let fit = fitted(&made, &start)?;
        times.push(begun.elapsed());
        let mut found: Vec<f64> = fit.parameters.iter().map(|p| p.value).collect();
        one_of_equals(id, &mut found);
        let errors = found.iter().zip(&expected).map(|(found, expected)| found - expected);
        for ((parameter, tally), error) in fit.parameters.iter().zip(&mut tallies).zip(errors) {
            tally.add(error, parameter.std_error, parameter.status);
        }
    }
    times.sort();
    let median_time = times.get(times.len() / 2).copied().unwrap_or_default();
    Ok(Coverage { names: model.names(), tallies, median_time })
}

fn print(coverage: &Coverage) {
    let tallies = coverage.names.iter().zip(&coverage.tallies);
    for (name, tally) in tallies.filter(|(_, tally)| tally.count() > 0) {
        println!(
            "{name:30} {:7.1} {:7.1} {:8.2} {:6} {:6} {:8.1}",
            tally.within(3.0),
            tally.within(1.96),
            tally.mean(),
            tally.at_bound,
            tally.undetermined,
            1e3 * coverage.median_time.as_secs_f64(),
        );
    }
}

/// How often a fit finds the parameters that made a record, and how sure of them it is
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Records of each effect
    #[arg(default_value_t = RECORDS)]
    records: u64,

    /// Only these effects
    #[arg(value_name = "EFFECT")]
    effects: Vec<String>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let (records, chosen) = (args.records, &args.effects);
    println!("{records} records each; shares in percent, error in standard errors");
    println!("parameter                        < 3 SE  in 95%  mean error  bound undet. ms/fit");
    for effect in REGISTRY {
        if chosen.is_empty() || chosen.iter().any(|id| id == effect.spec().id) {
            print(&cover(*effect, records)?);
        }
    }
    Ok(())
}

/// Few effects and records: those that need their own starts, and a switch.
#[test]
fn parameters_are_found_again() -> anyhow::Result<()> {
    for id in ["dead_band", "stiction", "rate_limit", "coulomb_friction"] {
        let effect = REGISTRY.iter().find(|effect| effect.spec().id == id).context(id)?;
        let coverage = cover(*effect, 2)?;
        for (name, tally) in coverage.names.iter().zip(&coverage.tallies) {
            // A switch has no standard error: what depends on it is whether the gain is right.
            let is_switch = name.starts_with("stiction");
            assert!(is_switch || tally.within(4.0) >= 100.0, "{name}: {:?}", tally.scores);
        }
    }
    Ok(())
}
