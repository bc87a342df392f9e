//! How often the interval of a delay holds the true one, on strokes of a simulated cylinder.
//!
//! Each trial rests, is driven by one step into its stop, and is let go. The true delay is read
//! off the same trial without noise: from the step until the output is off that of a trial
//! without the step by the part `SEEN` of the sensor's noise.

use anyhow::Context as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use tauscope::delay::{Method, Settings, estimate_joint};
use tauscope::experiment::{Record, Trial};
use tauscope::synthetic::{CylinderSpec, DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};

/// Trials where no number is given.
const TRIALS: u64 = 100;

/// Part of the noise that nobody sees.
const SEEN: f64 = 0.1;

const PERIOD_S: f64 = 0.01;

/// A stroke with noise, and its true delay in seconds.
fn stroke(seed: u64) -> anyhow::Result<(Trial, f64)> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let rest = random.random_range(80..250_usize);
    let size = random.random_range(1.5..8.0);
    let level = if random.random_bool(0.5) { size } else { -size };
    let noise = random.random_range(0.005..0.05);
    let delay = DelayLaw::Constant { seconds: random.random_range(0.03..0.5) };
    let cylinder = CylinderSpec::default();
    let [low, high] = cylinder.angle_limits_deg;
    let start = if level > 0.0 { low + 1.0 } else { high - 1.0 };
    let steps = vec![(rest, level), (rest + 1200, 0.0)];
    let made = |steps: &[(usize, f64)], noise: f64| -> anyhow::Result<Trial> {
        let input = InputSpec::Steps { steps: steps.to_vec(), initial: 0.0 };
        let joint = JointSpec {
            start,
            noise,
            cylinder: Some(cylinder.clone()),
            ..JointSpec::new("boom", input, delay.clone())
        };
        let made = simulate(&PlantSpec::new(seed, 18.0, vec![joint]))?;
        let joint = made.joints.into_iter().next().context("a joint")?;
        joint.trials.into_iter().next().context("a trial")
    };
    let (clean, noisy, still) = (made(&steps, 0.0)?, made(&steps, noise)?, made(&[], 0.0)?);
    let apart = clean.output().iter().zip(still.output()).map(|(y, still)| (y - still).abs());
    let apart: Vec<f64> = apart.collect();
    let seen = SEEN * noise;
    let after = apart.iter().position(|apart| *apart > seen).context("it moves")?;
    let part = (seen - apart[after - 1]) / (apart[after] - apart[after - 1]);
    Ok((noisy, ((after - 1 - rest) as f64 + part) * PERIOD_S))
}

/// How often the interval of a delay holds the true one, on strokes of a cylinder
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Trials
    #[arg(default_value_t = TRIALS)]
    trials: u64,

    /// Seed of the first trial
    #[arg(default_value_t = 1)]
    first_seed: u64,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let (trials, first) = (args.trials, args.first_seed);
    let made: Vec<(Trial, f64)> =
        (first..first + trials).map(stroke).collect::<anyhow::Result<_>>()?;
    let (strokes, delays): (Vec<Trial>, Vec<f64>) = made.into_iter().unzip();
    let strokes = Record::from(strokes);
    println!("method      accepted   held at 95 %   median error   median width");
    for method in Method::all().filter(|method| method.spec().has_intervals) {
        let found = estimate_joint(&strokes, &Settings::of(method));
        let (mut held, mut errors, mut widths) = (0, Vec::new(), Vec::new());
        for (estimate, delay) in found.into_iter().zip(&delays) {
            let estimate = estimate?;
            let Some(start) = estimate.decisions.first() else { continue };
            let Some((found, fine)) = start.accepted_delay().zip(start.fine) else { continue };
            let [low, high] = [fine.low, fine.high].map(|end| end * PERIOD_S);
            held += usize::from(low <= *delay && *delay <= high);
            errors.push(found * PERIOD_S - delay);
            widths.push(high - low);
        }
        let median = |values: &mut Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
        };
        let share = 100.0 * held as f64 / errors.len().max(1) as f64;
        println!(
            "{:<10}{:>10}{share:>13.1} %{:>13.4} s{:>13.4} s",
            method.spec().id,
            errors.len(),
            median(&mut errors),
            median(&mut widths)
        );
    }
    Ok(())
}
