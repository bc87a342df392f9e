//! Machines that are drawn, and the logs that are made of them.

use anyhow::Context as _;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use tauscope::units::SamplePeriod;
use tauscope::{Joint, Trial};

use super::machine::{self, Machine, Output, SAMPLE_MS};
use super::plants::Chance;

/// How a machine is logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// Rest at a stop, one step, motion up to the other stop, step back to rest: a trial each.
    Strokes,
    /// Random levels, turned round by whoever watches it before the joint is at its stops.
    Steps,
    /// Random levels of an output that regulates itself, of one sign or of both.
    FirstOrder,
}

/// Samples per second.
const RATE_HZ: f64 = 1000.0 / SAMPLE_MS as f64;

/// A machine, and the word for what is special about it.
pub(crate) fn machine(source: Source, chance: &mut Chance) -> (Machine, Vec<&'static str>) {
    let is_regulating = source == Source::FirstOrder;
    let mut special = Vec::new();
    let mut some = |name: &'static str, probability: f64, chance: &mut Chance| {
        let is = chance.is(probability);
        special.extend(is.then_some(name));
        is
    };
    let gain = chance.between(8.0, 20.0);
    let factor = if some("asymmetric", 0.6, chance) { chance.between(0.6, 1.6) } else { 1.0 };
    let is_banded = some("soft_dead_band", 0.6, chance);
    let mut end = || if is_banded { chance.between(0.1, 0.5) } else { 0.0 };
    let dead_band = (-end(), end());
    let softness = if is_banded { chance.between(0.01, 0.1) } else { 0.001 };
    let half = chance.between(30.0, 50.0);
    let linkage = if some("linkage", 0.5, chance) { chance.between(-0.3, 0.4) } else { 0.0 };
    let load = if some("load", 0.5, chance) {
        let mean = chance.between(-0.2, 0.2);
        let slope = chance.between(-0.15, 0.15);
        (mean - slope, mean + slope)
    } else {
        (0.0, 0.0)
    };
    let leakage =
        if some("slow_leakage", 0.3, chance) { chance.between(0.0005, 0.004) } else { 0.0 };
    let sinking = if some("sinking", 0.2, chance) { chance.between(0.0, 0.1) } else { 0.0 };
    let joint = machine::Joint { stops: (-half, half), linkage, load, leakage, sinking };
    let (lag_s, output) = if is_regulating {
        special.retain(|name| ["asymmetric", "soft_dead_band"].contains(name));
        let at_zero = chance.between(-10.0, 10.0);
        (chance.between(0.08, 0.8), Output::Regulating { at_zero })
    } else {
        (chance.between(0.02, 0.2), Output::Angle(joint))
    };
    let noise = chance.between(0.02, 0.1);
    let (delay_s, gain) = (chance.between(0.05, 0.3), (gain * factor, gain));
    (Machine { delay_s, gain, dead_band, softness, lag_s, output, noise }, special)
}

/// The log of `machine`.
pub(crate) fn log(machine: &Machine, source: Source, chance: &mut Chance) -> anyhow::Result<Joint> {
    let trials = match source {
        Source::Strokes => strokes(machine, chance)?,
        Source::Steps => vec![steps(machine, chance)?],
        Source::FirstOrder => vec![first_order(machine, chance)?],
    };
    Ok(Joint::new("boom", trials).with_units("V", "deg"))
}

fn trial(
    label: usize,
    machine: &Machine,
    (input, output): (Vec<f64>, &[f64]),
    random: &mut ChaCha8Rng,
) -> anyhow::Result<Trial> {
    let period = SamplePeriod::from_seconds(1.0 / RATE_HZ).context("a period")?;
    let measured = machine.measured(output, random);
    Ok(Trial::new(label.to_string(), 0.0, period, input, measured)?)
}

/// Seconds as samples.
fn samples(seconds: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small, ≥ 0")]
    let samples = (seconds * RATE_HZ).round() as usize;
    samples
}

/// Trials of nine seconds, to and fro.
fn strokes(machine: &Machine, chance: &mut Chance) -> anyhow::Result<Vec<Trial>> {
    let Output::Angle(joint) = machine.output else { anyhow::bail!("it has no stops") };
    let levels = [chance.between(0.9, 1.2), chance.between(1.4, 1.6), 2.0];
    let count = chance.0.random_range(10..15) * 2;
    let one = |index: usize| {
        let is_up = index.is_multiple_of(2);
        let level = levels[(index / 2) % levels.len()] * if is_up { 1.0 } else { -1.0 };
        let start = if is_up { joint.stops.0 } else { joint.stops.1 };
        let rest = samples(chance.between(0.6, 1.2));
        let held = samples(chance.between(6.5, 7.5));
        let mut input = vec![0.0; rest];
        input.extend(vec![level; held]);
        input.resize(samples(9.0), 0.0);
        let output = machine.run(&input, start);
        trial(index + 1, machine, (input, &output), &mut chance.0)
    };
    (0..count).map(one).collect()
}

/// About a minute of random levels, of which those that would lead to a stop are turned round.
fn steps(machine: &Machine, chance: &mut Chance) -> anyhow::Result<Trial> {
    let Output::Angle(joint) = machine.output else { anyhow::bail!("it has no stops") };
    let middle = chance.between(0.9, 1.4);
    let levels = [-2.0, -middle, 0.0, middle, 2.0];
    let whole = samples(chance.between(40.0, 70.0).round());
    let near = 0.75 * joint.stops.1;
    let mut input = vec![0.0; samples(0.8)];
    while input.len() < whole {
        let hold = samples(chance.between(0.5, 2.0));
        let drawn = levels[chance.0.random_range(0..levels.len())];
        let leads = |level: f64| {
            let mut tried = input.clone();
            tried.extend(vec![level; hold]);
            let end = machine.run(&tried, 0.0).last().copied().unwrap_or(0.0);
            end.abs() > near
        };
        let level = if leads(drawn) && !leads(-drawn) { -drawn } else { drawn };
        // Where neither is well, the joint is brought back.
        let now = machine.run(&input, 0.0).last().copied().unwrap_or(0.0);
        let level = if leads(level) { -2.0 * now.signum() } else { level };
        input.extend(vec![level; hold]);
    }
    input.truncate(whole);
    let output = machine.run(&input, 0.0);
    trial(1, machine, (input, &output), &mut chance.0)
}

/// Random levels; half of the machines know inputs of one sign only.
fn first_order(machine: &Machine, chance: &mut Chance) -> anyhow::Result<Trial> {
    let levels: &[f64] =
        if chance.is(0.5) { &[0.0, 0.6, 1.2, 1.6, 2.0] } else { &[-2.0, -1.2, 0.0, 1.2, 2.0] };
    let whole = samples(chance.between(40.0, 70.0).round());
    let longest = 4.0 * machine.lag_s + 1.0;
    let mut input = vec![0.0; samples(1.0)];
    while input.len() < whole {
        let level = levels[chance.0.random_range(0..levels.len())];
        input.extend(vec![level; samples(chance.between(0.5, longest))]);
    }
    input.truncate(whole);
    let start = machine.settled(0.0).context("it does not settle")?;
    let output = machine.run(&input, start);
    trial(1, machine, (input, &output), &mut chance.0)
}
