//! How often explain and improve find what is hidden in a record.
//!
//! Joints of the synthetic plant, which shares no equation with the models, hide nothing,
//! each effect of the catalogue in turn, the finer form of one, two or three of them, or
//! something that the catalogue does not have; some are moved by a cylinder. What explain names and improve adds
//! is held against the truth. The page goes to standard output, progress to standard error.

mod cases;
mod consequence;
mod outcome;
mod page;

use std::thread;

use tauscope::batch::with_threads;
use tauscope::explain::Options;

use crate::in_order::in_order;
use cases::{Case, Counts, Group, cases};
use outcome::{Outcome, examine};
use page::page;

/// Hide effects in simulated joints, and count what is found of them
#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    counts: Counts,

    /// Keep effects without consequence, and tabulate what effects carry: of records that hide two
    /// or three
    #[arg(long)]
    consequence: bool,

    /// Records at the same time [default: as many as there are processors]
    #[arg(long)]
    threads: Option<usize>,
}

/// A record, and what became of it.
struct Judged {
    case: Case,
    outcome: anyhow::Result<Outcome>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<()> {
    let processors = thread::available_parallelism().map_or(1, usize::from);
    let threads = args.threads.unwrap_or(processors).max(1);
    let options = Options { keeps_refinements: args.consequence, ..Options::default() };
    let mut cases = cases(args.counts);
    if args.consequence {
        cases.retain(|case| matches!(case.group, Group::Two | Group::Three));
    }
    let judged = judged(cases, &options, threads)?;
    let page = if args.consequence { consequence::page } else { page };
    print!("{}", page(args.counts, &judged));
    Ok(())
}

/// What becomes of `cases`, `threads` at a time, in their order.
fn judged(cases: Vec<Case>, options: &Options, threads: usize) -> anyhow::Result<Vec<Judged>> {
    let outcomes = in_order(&cases, threads, |index, case| {
        // One thread for each record: there are enough of them.
        let outcome = with_threads(Some(1), || examine(case, options))?;
        tell(&cases, index, &outcome);
        Ok(outcome)
    })?;
    Ok(cases.into_iter().zip(outcomes).map(|(case, outcome)| Judged { case, outcome }).collect())
}

fn tell(cases: &[Case], index: usize, outcome: &anyhow::Result<Outcome>) {
    let title = cases.get(index).map(Case::title).unwrap_or_default();
    let became = match outcome {
        Ok(outcome) => outcome.chain.clone(),
        Err(error) => format!("{error:#}"),
    };
    eprintln!("{} of {}: {title}: {became}", index + 1, cases.len());
}

/// A record that hides one effect and one that hides none, and few effects to choose from.
#[test]
fn what_is_hidden_is_found_and_nothing_is_not() -> anyhow::Result<()> {
    let counts = Counts {
        one: 1,
        soft: 0,
        nothing: 1,
        two: 0,
        three: 0,
        outside: 0,
        finer: 0,
        cylinder: 0,
        first_seed: 1,
    };
    let known = ["dead_band", "actuator_lag", "thermal_drift"];
    let effects = known.into_iter().filter_map(tauscope::effect::by_id).collect();
    let wanted = ["clear dead_band, white", "nothing, AR(1) 0.9, "];
    let is_wanted = |case: &Case| wanted.iter().any(|title| case.title().starts_with(title));
    let some: Vec<Case> = cases(counts).into_iter().filter(is_wanted).collect();
    let options = Options { effects, ..Options::default() };
    let page = page(counts, &judged(some, &options, 2)?);
    let all = "1 of 1 (100.0 %)";
    assert!(page.contains(&format!("| clear | white | {all} | {all} | ")), "{page}");
    assert!(page.contains(&format!("| AR(1) 0.9 | {all} |")), "{page}");
    assert!(page.contains("\n0 of 2 (0.0 %); each"), "{page}");
    Ok(())
}
