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

/// `fault` with the commands that have an option which the one that was typed lacks.
pub(crate) fn with_tip(mut fault: clap::Error, program: &Command) -> clap::Error {
    let Some(ContextValue::String(option)) = fault.get(ContextKind::InvalidArg) else {
        return fault;
    };
    if fault.kind() != ErrorKind::UnknownArgument {
        return fault;
    }
    let (option, have) = (option.clone(), having(program, option));
    // The tip of clap is to take the option for a log.
    fault.remove(ContextKind::Suggested);
    if !have.is_empty() {
        fault.remove(ContextKind::SuggestedArg);
        let tip = format!("`{option}` is an option of {}", have.join(", "));
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
