//! `tauscope simulate`

use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args as ClapArgs;
use tauscope::synthetic::{PlantSpec, simulate, write_log, write_truth};

use super::output::{OutputFile, check_outputs};
use super::{Completion, message};

/// Make a log of joints with known delays
///
/// The plant file tells each joint's gain, delay law, dead band, saturation, lag,
/// ringing and noise; `data/manipulator.plant.toml` is an example. The true delay of
/// every step goes to a file of its own, so that it can stay hidden.
#[derive(ClapArgs, Debug)]
pub(super) struct Args {
    /// The plant (TOML, schema `tauscope/plant/1`)
    #[arg(value_name = "PLANT.toml")]
    plant: PathBuf,

    /// Where the log goes
    #[arg(short, long = "output", value_name = "LOG.csv")]
    output: PathBuf,

    /// Where the true delay of every step goes
    #[arg(long, value_name = "TRUTH.csv")]
    truth: Option<PathBuf>,

    /// Seed of everything random, instead of the plant file's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Standard deviation of the noise of every joint, instead of the plant file's
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    noise: Option<f64>,

    /// Length of the log, instead of the plant file's
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    duration: Option<f64>,

    /// No notices
    #[arg(short, long)]
    quiet: bool,
}

pub(super) fn run(args: &Args) -> anyhow::Result<Completion> {
    let plant = args.plant.display();
    let text =
        std::fs::read_to_string(&args.plant).with_context(|| format!("{plant}: cannot be read"))?;
    let mut spec = PlantSpec::from_toml(&text).with_context(|| format!("{plant}"))?;
    spec.seed = args.seed.unwrap_or(spec.seed);
    spec.duration_s = args.duration.unwrap_or(spec.duration_s);
    for joint in &mut spec.joints {
        joint.noise = args.noise.unwrap_or(joint.noise);
    }
    let outputs: Vec<_> =
        std::iter::once(args.output.as_path()).chain(args.truth.as_deref()).collect();
    check_outputs(&outputs, &args.plant.canonicalize().into_iter().collect::<Vec<_>>())?;
    let mut log = OutputFile::create(&args.output)?;
    let truth = args.truth.as_deref().map(OutputFile::create).transpose()?;
    let made = simulate(&spec).with_context(|| format!("{plant}"))?;
    write_log(&made, &mut log)?;
    if let Some(mut truth) = truth {
        write_truth(&made.truth, &mut truth)?;
        truth.commit()?;
    }
    log.commit()?;
    if !args.quiet {
        let (joints, steps) = (made.joints.len(), made.truth.len());
        message("log", &format!("{}: {joints} joints, {steps} steps", args.output.display()));
    }
    Ok(Completion::Whole)
}
