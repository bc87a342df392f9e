//! Arguments, printing and exit status; no mathematics.

mod add;
mod compare;
mod data;
mod design;
mod doctor;
mod effects;
mod estimate;
mod explain;
mod fitting;
mod folder;
mod improve;
mod interrupt;
mod merge;
mod model_file;
mod nearest;
mod output;
mod progress;
mod record;
mod report;
mod settings;
mod shell;
mod simulate;
#[cfg(feature = "rrd")]
mod spawn;
mod stream;
mod sweep;
mod table_file;
mod terminal;

use std::io;
use std::process::ExitCode;

use crate::experiment::{Experiment, Failure};
use clap::{Parser, Subcommand};

use terminal::message;

/// Estimate the variable delay of hydraulic joints, and record every decision.
#[derive(Debug, Parser)]
#[command(name = "tauscope", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Estimate(Box<estimate::Args>),
    Sweep(Box<sweep::Args>),
    Compare(Box<compare::Args>),
    Explain(Box<explain::Args>),
    Add(Box<add::Args>),
    Improve(Box<improve::Args>),
    Merge(merge::Args),
    Report(Box<report::Args>),
    Effects(effects::Args),
    Simulate(Box<simulate::Args>),
    Design(Box<design::Args>),
    Doctor(doctor::Args),
    Completions(shell::CompletionsArgs),
    Man(shell::ManArgs),
}

/// What became of a command that ran to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Completion {
    /// Everything was done.
    Whole,
    /// Some joints or files failed; the rest is in the output.
    Partial,
}

/// Runs the command that the arguments name.
///
/// Exit status: 0 all done; 1 some joints or files failed; 2 nothing usable.
pub fn run() -> ExitCode {
    let outcome = perform(Cli::parse().command);
    match outcome {
        Ok(Completion::Whole) => ExitCode::SUCCESS,
        Ok(Completion::Partial) => ExitCode::from(1),
        // Whoever read our output has seen enough, as in `tauscope … | head`.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            message("error", &format!("{error:#}"));
            ExitCode::from(2)
        }
    }
}

fn perform(command: Command) -> anyhow::Result<Completion> {
    match command {
        Command::Estimate(args) => estimate::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Add(args) => add::run(&args),
        Command::Improve(args) => improve::run(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Effects(args) => effects::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Design(args) => design::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Completions(args) => shell::completions(&args),
        Command::Man(args) => shell::man(&args),
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let is_pipe = |cause: &(dyn std::error::Error + 'static)| {
        let io = cause.downcast_ref::<io::Error>().map(io::Error::kind);
        io == Some(io::ErrorKind::BrokenPipe)
    };
    error.chain().any(is_pipe)
}

/// A message on each file and joint that could not be read.
fn read_failures(experiment: &Experiment) -> Vec<String> {
    let failure = |failure: &Failure| {
        let error = with_causes(&failure.error);
        match &failure.joint {
            Some(joint) => format!("joint `{joint}` is left out: {error}"),
            None => format!("left out: {error}"),
        }
    };
    experiment.failures.iter().map(failure).collect()
}

/// An error with its causes, in one line.
fn with_causes(error: &(dyn std::error::Error + 'static)) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}
