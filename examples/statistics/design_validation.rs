//! Whether `design --output-range` keeps its promise on joints that are not its models.
//!
//! Each joint is drawn with physics of its own, in the synthetic plant, which shares no equation
//! with the models: effects of the catalogue at random, effects outside it, and cylinders. It is
//! logged for about a minute; from the log alone an input is designed that is to keep a range,
//! as `tauscope design LOG --output-range LO,HI` does; and the input is played on the same joint.
//! How often does it leave the range, how often is nothing designed, how much of the range is
//! used? The page goes to standard output, progress to standard error.

mod case;
mod machine;
mod machines;
mod page;
mod plants;

use std::thread;

use tauscope::batch::with_threads;

use crate::in_order::in_order;
use case::{Beside, Judged, examine};
use page::page;

/// Design inputs that keep a range, play them on other physics, and count how often they do
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Joints
    #[arg(long, default_value_t = 200)]
    joints: u64,

    /// Seed of the first joint
    #[arg(long, default_value_t = 1)]
    first_seed: u64,

    /// Only the seeds with these last digits, as in 4,5: a kind of joints
    #[arg(long, value_name = "DIGITS", value_delimiter = ',')]
    ending: Vec<u64>,

    /// Without the fitted integrator that each plan is compared with
    #[arg(long)]
    plans_only: bool,

    /// Joints at the same time [default: as many as there are processors]
    #[arg(long)]
    threads: Option<usize>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let processors = thread::available_parallelism().map_or(1, usize::from);
    let seeds = args.first_seed..args.first_seed + args.joints;
    let is_wanted = |seed: &u64| args.ending.is_empty() || args.ending.contains(&(seed % 10));
    let seeds: Vec<u64> = seeds.filter(is_wanted).collect();
    let judged = in_order(&seeds, args.threads.unwrap_or(processors).max(1), |index, seed| {
        // One thread for each joint: there are enough of them.
        let beside = if args.plans_only { Beside::Nothing } else { Beside::Integrator };
        let judged: Judged = with_threads(Some(1), || examine(*seed, beside))??;
        eprintln!("{} of {}: {judged}", index + 1, seeds.len());
        Ok(judged)
    })?;
    print!("{}", page(&judged));
    Ok(())
}
