//! The program: its commands by name, and the exit status.

use std::ffi::{OsStr, OsString};
use std::io;
use std::panic::AssertUnwindSafe;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::{Context as _, bail};
use clap::{Arg, CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::cli::args::{DataArgs, read};
use crate::cli::command::{
    add, columns, compare, completions, design, doctor, effects, estimate, explain, export,
    importer, improve, report, simulate, sweep,
};
use crate::cli::console::{Ended, Host, Hosting, message};
use crate::cli::failure::{Completion, said};
use crate::cli::output::meet_file_limits;
use crate::cli::typed::{neither_log_nor_command, with_tip};
use crate::experiment::{Experiment, ReadError, is_named_like_a_log};

/// Estimate the variable delay of hydraulic joints, record every decision, and find the physics that
/// a model lacks.
///
/// `tauscope LOG.csv` reads a log, estimates the delays of its joints and says which physical effects
/// a model of each needs; `-o` writes report and recording beside the log.
#[derive(Debug, Parser)]
#[command(
    name = "tauscope",
    version,
    max_term_width = 100,
    override_usage = "tauscope <LOG>... [-o [FILE]]\n       tauscope <COMMAND> [OPTIONS]"
)]
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
    Columns(columns::Args),
    Report(Box<report::Args>),
    /// Say what was measured, the delays, what a model lacks, and what to do next
    ///
    /// It is done where a log stands in the place of a command. Options are those of `report`.
    #[command(
        hide = true,
        about,
        long_about,
        override_usage = "tauscope <LOG>... [-o [FILE]] [OPTIONS]",
        mut_arg("report", first_look_output)
    )]
    FirstLook(Box<report::Args>),
    Effects(effects::Args),
    Export(export::Args),
    Simulate(Box<simulate::Args>),
    Design(Box<design::Args>),
    Doctor(doctor::Args),
    Importer(importer::Args),
    Completions(completions::Args),
}

/// Runs the command that the arguments name.
///
/// Exit status: 0 all done; 1 some joints or files failed; 2 nothing usable.
pub(super) fn run() -> ExitCode {
    meet_file_limits();
    let outcome =
        with_command(std::env::args_os().collect()).and_then(|words| match parsed(words) {
            Ok(cli) => perform(cli.command),
            Err(fault) if fault.use_stderr() => fault.exit(),
            // Help and the version are results, which may be lost like others.
            Err(asked) => asked
                .print()
                .context("standard output cannot be written")
                .map(|()| Completion::Whole),
        });
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

/// The program as it is typed.
fn program() -> clap::Command {
    Cli::command().mut_subcommands(with_negative_numbers)
}

/// `command` with options that take `-1` for their value, so that whoever typed it learns what is expected.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command.mut_args(|arg| {
        let is_option = arg.get_long().is_some() && arg.get_action().takes_values();
        arg.allow_negative_numbers(is_option)
    })
}

/// What the words of a command line ask for.
fn parsed(words: impl IntoIterator<Item = OsString>) -> Result<Cli, clap::Error> {
    let program = program();
    let tip = |fault| with_tip(fault, &program);
    Cli::from_arg_matches(&program.clone().try_get_matches_from(words).map_err(tip)?)
}

/// The output of a first look: beside the log where it has no name, and nowhere unless it is asked
/// for.
fn first_look_output(output: Arg) -> Arg {
    output.required(false).num_args(0..=1).default_missing_value(report::BESIDE_THE_LOG)
}

/// The words as they were typed; where a log stands in the place of a command, also after options,
/// they get one.
///
/// # Errors
/// When the first word is neither.
fn with_command(mut words: Vec<OsString>) -> anyhow::Result<Vec<OsString>> {
    let own = words.get(1..).unwrap_or_default();
    let is_option = |word: &OsString| word.to_string_lossy().starts_with('-');
    let is_first_look = match own.first() {
        Some(first) if is_option(first) => {
            let is_about_the_program =
                ["-h", "--help", "-V", "--version"].iter().any(|option| first == option);
            let names_a_log = own.iter().any(|word| !is_option(word));
            names_a_log && !is_about_the_program && !own.iter().any(|word| is_command(word))
        }
        Some(first) if is_command(first) => false,
        Some(first) if !is_log(first) => bail!(neither_log_nor_command(&program(), first)),
        first => first.is_some(),
    };
    if is_first_look {
        words.insert(1, "first-look".into());
    }
    Ok(words)
}

fn is_command(word: &OsStr) -> bool {
    let text = word.to_string_lossy();
    text == "help" || program().find_subcommand(&*text).is_some()
}

/// Whether a word that is no command names a log.
fn is_log(word: &OsStr) -> bool {
    is_named_like_a_log(&word.to_string_lossy()) || Path::new(word).exists()
}

/// Why a command that a program runs inside itself has no results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// What the program would print.
    pub message: String,
    /// The row of the log that it is about.
    pub row: Option<u64>,
    /// The column of the log that it is about.
    pub column: Option<String>,
    /// Whether the host ended it.
    pub was_ended: bool,
}

/// Runs a command as the program would, for a program that does it inside itself; whether it
/// was done as a whole. `arguments` are those of the command line, from the command on.
///
/// # Errors
/// [`Refused`], where the program would end with status 2. A panic is one, too.
pub fn run_within(arguments: &[OsString], host: Arc<dyn Hosting>) -> Result<bool, Refused> {
    let cli = parsed(named(arguments));
    let cli = cli.map_err(|error| Refused::because(&error.to_string()))?;
    let completion = within(host, || perform(cli.command))?;
    Ok(completion == Completion::Whole)
}

/// The options with which all commands read logs, as a command.
#[derive(Debug, Parser)]
struct Reading {
    #[command(flatten)]
    data: DataArgs,
}

/// Reads logs as every command does, for a program that has commands inside itself. `arguments`
/// are the word `read`, logs and options.
///
/// # Errors
/// As [`run_within`].
pub fn read_within(arguments: &[OsString], host: Arc<dyn Hosting>) -> Result<Experiment, Refused> {
    let reading = with_negative_numbers(Reading::command()).try_get_matches_from(arguments);
    let reading = reading.and_then(|found| Reading::from_arg_matches(&found));
    let reading = reading.map_err(|error| Refused::because(&error.to_string()))?;
    within(host, || read(reading.data.given(), &reading.data.options()?))
}

/// The arguments after the program's name.
fn named(arguments: &[OsString]) -> impl Iterator<Item = OsString> {
    std::iter::once(OsString::from("tauscope")).chain(arguments.iter().cloned())
}

/// Does `work` for `host`, to whom a panic is an error.
fn within<T>(
    host: Arc<dyn Hosting>,
    work: impl FnOnce() -> anyhow::Result<T>,
) -> Result<T, Refused> {
    Host::enter(Some(Host::new(host)));
    let done = std::panic::catch_unwind(AssertUnwindSafe(work));
    Host::enter(None);
    match done {
        Ok(done) => done.map_err(|error| Refused::of(&error)),
        Err(panic) if panic.is::<Ended>() => {
            Err(Refused { was_ended: true, ..Refused::because("it was ended") })
        }
        Err(_) => Err(Refused::because("this is a fault of tauscope: please report it")),
    }
}

impl Refused {
    fn because(message: &str) -> Self {
        let (row, column) = (None, None);
        Self { message: message.trim_end().to_owned(), row, column, was_ended: false }
    }

    fn of(error: &anyhow::Error) -> Self {
        let read = error.chain().find_map(|cause| cause.downcast_ref::<ReadError>());
        Self {
            row: read.and_then(ReadError::row),
            column: read.and_then(ReadError::column).map(str::to_owned),
            ..Self::because(&said(error.as_ref()))
        }
    }
}

/// An option of a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommandOption {
    /// Its long name, without the dashes.
    pub name: String,
    /// What it does, in one paragraph.
    pub help: String,
    /// Whether a value follows it.
    pub takes_value: bool,
    /// Whether it may be given several times.
    pub is_repeatable: bool,
}

/// The options of a command; `None` where there is no such command.
pub fn options_of(command: &str) -> Option<Vec<CommandOption>> {
    let command = match command {
        "read" => Reading::command(),
        _ => program().find_subcommand(command)?.clone(),
    };
    let option = |argument: &Arg| {
        let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
        let action = argument.get_action();
        Some(CommandOption {
            name: argument.get_long()?.to_owned(),
            help,
            takes_value: action.takes_values(),
            is_repeatable: matches!(action, clap::ArgAction::Append),
        })
    };
    let is_own = |option: &CommandOption| option.name != "help" && option.name != "version";
    Some(command.get_arguments().filter_map(option).filter(is_own).collect())
}

fn perform(command: Command) -> anyhow::Result<Completion> {
    match command {
        Command::Estimate(args) => estimate::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Add(args) => add::run(&args),
        Command::Improve(args) => improve::run(&args),
        Command::Columns(args) => columns::run(&args),
        Command::Report(args) => report::run(&args),
        Command::FirstLook(mut args) => report::first_look(&mut args),
        Command::Effects(args) => effects::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Design(args) => design::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Importer(args) => importer::run(&args),
        Command::Completions(args) => completions::run(&args, program()),
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let is_pipe = |cause: &(dyn std::error::Error + 'static)| {
        let io = cause.downcast_ref::<io::Error>().map(io::Error::kind);
        io == Some(io::ErrorKind::BrokenPipe)
    };
    error.chain().any(is_pipe)
}
