//! Whether the doubt of a decision says which delays are wrong: on joints whose delays are known,
//! the area under the receiver operating characteristic.
//!
//! A decision counts as wrong when its step was accepted though nothing changed, or its delay is
//! off that of the others by more than one and a half rows of β: what all steps of a joint share,
//! as a lag, no decision can show. The area is the probability that a wrong decision is ranked before a
//! right one: 0.5 for no order, 1 for a perfect one. For comparison the same is shown for the
//! margin of the second-best breakpoint alone.
//! All of it for the methods `two-line` and `hinge`.

use anyhow::Context as _;
use tauscope::delay::{Decision, Method, Settings, Verdict, estimate};
use tauscope::experiment::Trial;
use tauscope::synthetic::{
    DelayLaw, InputSpec, JointSpec, PlantSpec, Ringing, StepTruth, Synthetic, simulate,
};

/// Records per plant where no number is given.
const RECORDS: u64 = 10;
/// The seed of the first record where none is given: none of those the measure was chosen on.
const FIRST_SEED: u64 = 5000;
const PERIOD_S: f64 = 0.01;
const DURATION_S: f64 = 120.0;
const NOISE: f64 = 0.05;
/// The paper's method, and one that finds delays between samples.
const METHODS: [Method; 2] = [Method::TWO_LINE, Method::HINGE];
/// Rows of β that a delay may be off.
const ROWS_OFF: f64 = 1.5;

/// The plants by name.
fn plants() -> Vec<(&'static str, JointSpec)> {
    let levels: Vec<f64> = (-4..=4).map(|half| 0.5 * f64::from(half)).collect();
    let input = |hold_s| InputSpec::Levels { levels: levels.clone(), hold_s };
    let delay = |max| DelayLaw::Uniform { min: 0.05, max };
    let long = input([0.9, 2.0]);
    let ideal = JointSpec { noise: NOISE, ..JointSpec::new("ideal", long, delay(0.4)) };
    let lag_s = Some(0.06);
    let ringing = Some(Ringing { period_s: 0.4, damping: 0.25 });
    let short = JointSpec { input: input([0.2, 0.5]), delay: delay(0.3), ..ideal.clone() };
    let noisy = JointSpec { noise: 16.0 * NOISE, ..ideal.clone() };
    let coloured = JointSpec { noise: 4.0 * NOISE, noise_correlation: 0.8, ..ideal.clone() };
    vec![
        ("noise x 16", noisy.clone()),
        ("noise x 16, lag", JointSpec { lag_s, ..noisy }),
        ("coloured noise x 4", coloured),
        ("ringing", JointSpec { ringing, ..ideal }),
        ("short holds", short.clone()),
        ("short holds, lag", JointSpec { lag_s, ..short }),
    ]
}

/// A decision on a step of known delay.
#[derive(Clone, Copy, Debug)]
struct Judged {
    error: f64,
    is_still: bool,
    doubt: f64,
    runner_up: f64,
}

fn judged(truth: &StepTruth, decision: &Decision, output: &[f64]) -> Option<Judged> {
    if decision.verdict() != Verdict::Accepted {
        return None;
    }
    let margin = decision.runner_up().map_or(f64::INFINITY, |second| second.margin);
    Some(Judged {
        error: decision.delay()? - truth.delay_samples,
        is_still: truth.slope_change.abs() < 1e-9,
        doubt: decision.doubt(output).value(),
        runner_up: -margin,
    })
}

/// All accepted decisions on one record, with what is wrong about each.
fn record(joint: &JointSpec, method: Method, seed: u64) -> anyhow::Result<Vec<Judged>> {
    let plant = PlantSpec {
        sample_period_s: PERIOD_S,
        ..PlantSpec::new(seed, DURATION_S, vec![joint.clone()])
    };
    let made: Synthetic = simulate(&plant)?;
    let trial: &Trial =
        made.joints.first().and_then(|joint| joint.trials.first()).context("no trial")?;
    let found = estimate(trial, &Settings { method, ..Settings::of(Method::TWO_LINE) })?;
    let output = found.smoothed.as_deref().unwrap_or(trial.output());
    let pairs = made.truth.iter().zip(&found.decisions);
    Ok(pairs.filter_map(|(truth, decision)| judged(truth, decision, output)).collect())
}

/// Whether each decision is wrong; the middle error of all is none of theirs.
fn wrong(all: &[Judged]) -> Vec<bool> {
    let mut errors: Vec<f64> = all.iter().map(|judged| judged.error).collect();
    errors.sort_by(f64::total_cmp);
    let middle = errors.get(errors.len() / 2).copied().unwrap_or_default();
    let most = ROWS_OFF * Settings::of(Method::TWO_LINE).beta as f64;
    all.iter().map(|judged| judged.is_still || (judged.error - middle).abs() > most).collect()
}

/// The probability that a wrong decision scores above a right one; equal scores count half.
fn area(scores: &[f64], wrong: &[bool]) -> f64 {
    let of = |kind: bool| {
        let scored = scores.iter().zip(wrong).filter(move |(_, wrong)| **wrong == kind);
        scored.map(|(score, _)| *score).collect::<Vec<_>>()
    };
    let (bad, good) = (of(true), of(false));
    let above = |a: f64, b: f64| if a > b { 1.0 } else { f64::from(u8::from(a >= b)) / 2.0 };
    let sum: f64 = bad.iter().flat_map(|a| good.iter().map(move |b| above(*a, *b))).sum();
    sum / (bad.len() * good.len()) as f64
}

/// A row of the table, and the area by doubt.
fn row(name: &str, all: &[Judged], wrong: &[bool]) -> f64 {
    let of = |score: fn(&Judged) -> f64| all.iter().map(score).collect::<Vec<_>>();
    let (doubt, runner_up) = (of(|judged| judged.doubt), of(|judged| judged.runner_up));
    let (by_doubt, by_second) = (area(&doubt, wrong), area(&runner_up, wrong));
    let bad = wrong.iter().filter(|wrong| **wrong).count();
    println!("| {name} | {} | {bad} | {by_doubt:.3} | {by_second:.3} |", all.len());
    by_doubt
}

fn areas(method: Method, records: u64, first_seed: u64) -> anyhow::Result<Vec<f64>> {
    println!("| plant, {method} | accepted steps | wrong | area by doubt | by the second-best |");
    println!("|---|---|---|---|---|");
    let (mut all, mut all_wrong) = (Vec::new(), Vec::new());
    let mut areas = Vec::new();
    for (name, joint) in plants() {
        let mut found = Vec::new();
        for seed in first_seed..first_seed + records {
            found.extend(record(&joint, method, seed)?);
        }
        let wrong = wrong(&found);
        areas.push(row(name, &found, &wrong));
        all.extend(found);
        all_wrong.extend(wrong);
    }
    areas.push(row("all", &all, &all_wrong));
    Ok(areas)
}

/// Whether the decisions that are called doubtful are the wrong ones
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Records of each plant
    #[arg(default_value_t = RECORDS)]
    records: u64,

    /// Seed of the first record
    #[arg(default_value_t = FIRST_SEED)]
    first_seed: u64,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    METHODS
        .into_iter()
        .try_for_each(|method| areas(method, args.records, args.first_seed).map(drop))
}

/// The least area of all plants together. What no order gives is 0.5. Of one record per plant the
/// area is at least 0.893 with `two-line` and 0.760 with `hinge` for the seeds below; by the
/// second-best breakpoint it is 0.672 and 0.440 for the first of them. The limits leave room for
/// other seeds, and the order of the second-best misses them there.
#[cfg(test)]
const LEAST: [f64; 2] = [0.85, 0.7];

#[test]
fn the_doubtful_decisions_are_the_wrong_ones() -> anyhow::Result<()> {
    for (method, least) in METHODS.into_iter().zip(LEAST) {
        for first_seed in [FIRST_SEED, 7000, 9000] {
            let areas = areas(method, 1, first_seed)?;
            let all = areas.last().copied().unwrap_or_default();
            assert!(all > least, "{method}, seeds from {first_seed}: {areas:?}");
        }
    }
    Ok(())
}
