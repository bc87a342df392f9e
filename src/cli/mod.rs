//! Arguments, printing and exit status; no mathematics.

mod data;
mod estimate;
mod output;
mod progress;
mod simulate;

use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

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
    Simulate(simulate::Args),
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
pub(crate) fn run() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Estimate(args) => estimate::run(&args),
        Command::Simulate(args) => simulate::run(&args),
    };
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

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let is_pipe = |cause: &(dyn std::error::Error + 'static)| {
        let io = cause.downcast_ref::<io::Error>().map(io::Error::kind);
        io == Some(io::ErrorKind::BrokenPipe)
    };
    error.chain().any(is_pipe)
}

/// Prints one line on stderr. That stderr is closed is no reason to stop.
fn message(kind: &str, text: &str) {
    writeln!(io::stderr().lock(), "{kind}: {text}").unwrap_or_default();
}
