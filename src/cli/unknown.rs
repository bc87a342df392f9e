//! What is said of words of a command line that the program does not know.

use std::ffi::OsStr;

use clap::Command;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use crate::experiment::{did_you_mean, nearest_name};

/// That a word is neither a log nor a command of `program`.
pub(crate) fn neither_log_nor_command(program: &Command, word: &OsStr) -> String {
    let word = word.to_string_lossy();
    let near = did_you_mean(nearest_name(&word, commands(program).map(Command::get_name)));
    format!("{word}: no such file, and no command{near}; `tauscope help` lists the commands")
}

/// `fault` with what an option that `command` lacks may stand for: the commands that have it, or the
/// options in whose help it is named.
pub(crate) fn with_tip(
    mut fault: clap::Error,
    program: &Command,
    command: Option<&OsStr>,
) -> clap::Error {
    let Some(ContextValue::String(option)) = fault.get(ContextKind::InvalidArg) else {
        return fault;
    };
    if fault.kind() != ErrorKind::UnknownArgument {
        return fault;
    }
    let option = option.clone();
    let have = having(program, &option);
    if !have.is_empty() {
        fault.remove(ContextKind::SuggestedArg);
    }
    // The tip of clap is to take the option for a log.
    fault.remove(ContextKind::Suggested);
    let own = command.and_then(|command| program.find_subcommand(command));
    let tip = match have.as_slice() {
        [] if fault.get(ContextKind::SuggestedArg).is_some() => None,
        [] => own.and_then(|own| named_in_help(own, &option)),
        have => Some(format!("`{option}` is an option of {}", have.join(", "))),
    };
    if let Some(tip) = tip {
        fault.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    fault
}

fn commands(program: &Command) -> impl Iterator<Item = &Command> {
    program.get_subcommands().filter(|command| !command.is_hide_set())
}

/// The commands that have an option.
fn having(program: &Command, option: &str) -> Vec<String> {
    let has = |command: &&Command| {
        let mut own = command.get_arguments().filter_map(clap::Arg::get_long);
        option.strip_prefix("--").is_some_and(|option| own.any(|long| long == option))
    };
    commands(program).filter(has).map(|command| format!("`{}`", command.get_name())).collect()
}

/// The options of `command` whose help has the name of `option`.
fn named_in_help(command: &Command, option: &str) -> Option<String> {
    /// Letters of a name that are no part of another word by chance.
    const FEWEST: usize = 4;
    let letters = |text: &str| {
        let letters = text.chars().filter(|letter| letter.is_alphanumeric());
        letters.flat_map(char::to_lowercase).collect::<String>()
    };
    let wanted = letters(option);
    let is_named = |argument: &&clap::Arg| {
        argument.get_help().is_some_and(|help| letters(&help.to_string()).contains(&wanted))
    };
    let named = command.get_arguments().filter(is_named).filter_map(clap::Arg::get_long);
    let named: Vec<String> = named.map(|long| format!("`--{long}`")).collect();
    let is_telling = wanted.len() >= FEWEST && !named.is_empty();
    is_telling.then(|| format!("`{option}` is named in the help of {}", named.join(", ")))
}
