//! An effect of one's own, in Rust: on a model, fitted to a record that was made with it,
//! and compared with the plain integrator.
//!
//! What has no memory needs no Rust: it can stand in a model file, as an expression.
#![expect(clippy::print_stdout, reason = "an example prints")]

use anyhow::Context as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};
use tauscope::diagnosis::ErrorFigures;
use tauscope::effect::{Dimension, Effect, Moment, Parameter, Spec, Stage, contract};
use tauscope::experiment::{Joint, Trial};
use tauscope::fit::{Fit, FitRecord, Horizon, Part, Split, fit};
use tauscope::model::{Component, JointModel, Surroundings, simulate_input};
use tauscope::units::SamplePeriod;

/// A small accumulator in front of the valve: the farther the joint has moved of late, the
/// emptier it is, and the slower the joint.
#[derive(Debug)]
struct Accumulator;

/// Seconds in which the pump fills it to 63 %.
const REFILL_S: f64 = 4.0;

static ACCUMULATOR: Spec =
    Spec::new("accumulator", Stage::Load, "pressure that falls with the way gone of late")
        .equation("out = in / (1 + e), de/dt = draw abs(in) - e / 4 s")
        .source("made up for this example")
        .parameters(&[Parameter::new("draw", "how far a way empties it", Dimension::PerOutput)
            .between(0.0, 1e3)])
        .memory(1)
        .confused_with(&["supply_droop"]);

impl Effect for Accumulator {
    fn spec(&self) -> &'static Spec {
        &ACCUMULATOR
    }

    /// The memory is how empty it is.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64 {
        let (&[draw], [emptiness]) = (parameters, memory) else { return at.signal };
        let steady = draw * at.signal.abs() * REFILL_S;
        *emptiness = steady + (*emptiness - steady) * (-at.dt_s / REFILL_S).exp();
        at.signal / (1.0 + *emptiness)
    }
}

/// How far a degree empties the accumulator of the record.
const DRAW: f64 = 0.02;
const PERIOD_S: f64 = 0.02;
const SAMPLES: usize = 3000;

/// A record of `model` with noise of 0.05 degrees.
fn record(model: &JointModel) -> anyhow::Result<Joint> {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut input = Vec::new();
    while input.len() < SAMPLES {
        let (level, hold) = (random.random_range(-3.0..3.0), random.random_range(20..100));
        input.extend(std::iter::repeat_n(level, hold));
    }
    input.truncate(SAMPLES);
    let period = SamplePeriod::from_seconds(PERIOD_S).context("a period is above zero")?;
    let made = simulate_input(model, &input, PERIOD_S, 0.0, &Surroundings::default());
    let noise = Normal::new(0.0, 0.05)?;
    let output = made.output.iter().map(|angle| angle + noise.sample(&mut random)).collect();
    let trial = Trial::new("made", 0.0, period, input, output)?;
    Ok(Joint::new("slew", vec![trial]).with_units("V", "deg"))
}

/// A fitted model, and its error on the part of the record that it was not fitted to.
struct Fitted {
    fit: Fit,
    rmse: f64,
}

/// `start`, fitted to the first 70 % of the record.
fn fitted(joint: &Joint, start: &JointModel) -> anyhow::Result<Fitted> {
    let record = FitRecord::new(joint, Split::Time(0.7), Horizon::FreeRun);
    let fit = fit(&record, start, &record.range(30.0))?;
    let error = ErrorFigures::of(&record, &fit.evaluation, Part::Validation);
    Ok(Fitted { rmse: error.context("a record has a part for validation")?.rmse, fit })
}

/// The plain integrator, and the same with the effect.
fn compared() -> anyhow::Result<[Fitted; 2]> {
    let emptied = Component::new(&Accumulator, vec![DRAW.into()]).context("one parameter")?;
    let joint = record(&JointModel::integrator(10.0, 0.15).with(emptied))?;
    let plain = JointModel::integrator(7.0, 0.1);
    let with_effect = plain.with(Component::neutral(&Accumulator));
    Ok([fitted(&joint, &plain)?, fitted(&joint, &with_effect)?])
}

fn main() -> anyhow::Result<()> {
    contract::check(&Accumulator)?;
    let [before, after] = compared()?;
    println!("error on the part that was not fitted, in degrees:");
    println!("{:.3} of the plain integrator, {:.3} with the effect", before.rmse, after.rmse);
    for parameter in &after.fit.parameters {
        let error = parameter.std_error.map(|error| format!(" ± {error:.5}")).unwrap_or_default();
        println!("{} = {:.5}{error}", parameter.name, parameter.value);
    }
    Ok(())
}

#[test]
fn finds_the_effect_and_leaves_the_noise() -> anyhow::Result<()> {
    main()?;
    let [before, after] = compared()?;
    assert!(after.rmse < 0.06 && before.rmse > 5.0 * after.rmse);
    let draw = after.fit.parameters.last().context("the effect has a parameter")?;
    let error = draw.std_error.context("the record determines it")?;
    assert!((draw.value - DRAW).abs() < 4.0 * error);
    Ok(())
}
