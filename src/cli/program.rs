//! The program: its commands by name, and the exit status.

use std::io;
use std::process::ExitCode;

use clap::{CommandFactory as _, Parser, Subcommand};

use crate::cli::command::{
    add, columns, compare, completions, design, doctor, effects, estimate, explain, improve, man,
    merge, report, simulate, sweep,
};
use crate::cli::console::message;
use crate::cli::each_log::end_with_parent;
use crate::cli::exit::Completion;
use crate::cli::failure::said;

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
    Columns(columns::Args),
    Report(Box<report::Args>),
    Effects(effects::Args),
    Simulate(Box<simulate::Args>),
    Design(Box<design::Args>),
    Doctor(doctor::Args),
    Completions(completions::Args),
    Man(man::Args),
}

/// Runs the command that the arguments name.
///
/// Exit status: 0 all done; 1 some joints or files failed; 2 nothing usable.
pub fn run() -> ExitCode {
    end_with_parent();
    let outcome = perform(Cli::parse().command);
    match outcome {
        Ok(Completion::Whole) => ExitCode::SUCCESS,
        Ok(Completion::Partial) => ExitCode::from(1),
        // Whoever read our output has seen enough, as in `tauscope … | head`.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            message("error", &said(error.as_ref()));
            ExitCode::from(2)
        }
    }
}

fn perform(command: Command) -> anyhow::Result<Completion> {
    match command {
        Command::Estimate(args) => estimate::run(&args, &Cli::command()),
        Command::Sweep(args) => sweep::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Add(args) => add::run(&args),
        Command::Improve(args) => improve::run(&args, &Cli::command()),
        Command::Merge(args) => merge::run(&args),
        Command::Columns(args) => columns::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Effects(args) => effects::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Design(args) => design::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Completions(args) => completions::run(&args, Cli::command()),
        Command::Man(args) => man::run(&args, Cli::command()),
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let is_pipe = |cause: &(dyn std::error::Error + 'static)| {
        let io = cause.downcast_ref::<io::Error>().map(io::Error::kind);
        io == Some(io::ErrorKind::BrokenPipe)
    };
    error.chain().any(is_pipe)
}
