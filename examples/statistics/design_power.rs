//! How often a designed input tells two effects apart, and how long a random one must be.
//!
//! A joint of the synthetic plant, which shares no equation with the models, hides one of two
//! effects that are taken for each other. From a short log both are fitted, and the shortest
//! input is designed that tells them apart; it is played on the same joint, and `explain` is
//! asked. Beside it stand random inputs of the same length and longer ones. The page goes to
//! standard output, progress to standard error.

mod case;
mod page;

use std::thread;

use tauscope::batch::with_threads;

use crate::in_order::in_order;
use case::{Case, Judged, examine};
use page::page;

/// Effects that are taken for each other.
const PAIRS: [[&str; 2]; 6] = [
    ["dead_band", "stiction"],
    ["gravity_load", "leakage"],
    ["input_saturation", "flow_curve"],
    ["coulomb_friction", "dead_band"],
    ["direction_gain", "input_offset"],
    ["actuator_lag", "rate_limit"],
];

/// Design inputs that tell two effects apart, and count how often they do
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Joints for each effect that is hidden
    #[arg(long, default_value_t = 20)]
    joints: u64,

    /// Seed of the first joint
    #[arg(long, default_value_t = 1)]
    first_seed: u64,

    /// Only pairs with this effect
    #[arg(long)]
    only: Option<String>,

    /// Only joints that hide this effect
    #[arg(long)]
    hidden: Option<String>,

    /// How often each design is rehearsed
    #[arg(long, default_value_t = 40)]
    rehearsals: usize,

    /// Joints at the same time [default: as many as there are processors]
    #[arg(long)]
    threads: Option<usize>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let processors = thread::available_parallelism().map_or(1, usize::from);
    let seeds = args.first_seed..args.first_seed + args.joints;
    let only = args.only.as_deref();
    let hidden = args.hidden.as_deref();
    let mut cases =
        cases(|pair| only.is_none_or(|only| pair.contains(&only)), seeds, args.rehearsals);
    cases.retain(|case| hidden.is_none_or(|hidden| case.hidden() == hidden));
    let judged = judged(&cases, args.threads.unwrap_or(processors).max(1))?;
    print!("{}", page(&judged));
    Ok(())
}

/// Each effect of the pairs that are wanted, in a joint of each seed.
fn cases(
    wanted: impl Fn(&[&str; 2]) -> bool,
    seeds: std::ops::Range<u64>,
    rehearsals: usize,
) -> Vec<Case> {
    let sides = PAIRS.into_iter().filter(wanted).flat_map(|pair| [(pair, 0), (pair, 1)]);
    let case =
        |(pair, truth)| seeds.clone().map(move |seed| Case { pair, truth, seed, rehearsals });
    sides.flat_map(case).collect()
}

/// What becomes of `cases`, `threads` at a time, in their order.
fn judged(cases: &[Case], threads: usize) -> anyhow::Result<Vec<Judged>> {
    in_order(cases, threads, |index, case| {
        // One thread for each joint: there are enough of them.
        let outcome = with_threads(Some(1), || examine(case))?;
        let judged = Judged { case: *case, outcome };
        eprintln!("{} of {}: {judged}", index + 1, cases.len());
        Ok(judged)
    })
}
