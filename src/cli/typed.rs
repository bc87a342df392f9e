//! Command lines that are suggested or reported, the options in them, and what is said of words that the
//! program does not know.

use std::ffi::{OsStr, OsString};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command, FromArgMatches};

use crate::experiment::{did_you_mean, nearest_name};

/// The options of a command with their values, as they were typed; by their names.
#[derive(Clone, Debug, Default)]
pub(crate) struct Typed(Vec<(String, Option<OsString>)>);

impl Typed {
    /// Those whose names, without dashes, are wanted: a flag has no value.
    pub(crate) fn of(
        &self,
        is_wanted: impl Fn(&str) -> bool,
    ) -> impl Iterator<Item = (&str, Option<&OsString>)> {
        let wanted = self.0.iter().filter(move |(name, _)| is_wanted(name));
        wanted.map(|(name, value)| (name.as_str(), value.as_ref()))
    }
}

impl FromArgMatches for Typed {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut typed = Vec::new();
        for id in matches.ids().map(clap::Id::as_str) {
            // Groups are named like their types.
            let is_group = id.starts_with(char::is_uppercase);
            if is_group || matches.value_source(id) != Some(ValueSource::CommandLine) {
                continue;
            }
            let name = id.replace('_', "-");
            if matches!(matches.try_get_one::<bool>(id), Ok(Some(true))) {
                typed.push((name, None));
                continue;
            }
            let values = matches.get_raw(id).into_iter().flatten();
            typed.extend(values.map(|value| (name.clone(), Some(value.to_owned()))));
        }
        typed.sort_by(|(one, _), (other, _)| one.cmp(other));
        Ok(Self(typed))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for Typed {
    fn augment_args(command: Command) -> Command {
        command
    }

    fn augment_args_for_update(command: Command) -> Command {
        command
    }
}

/// Words of a command line, each so that a shell takes it for one.
pub(crate) fn quoted(words: &[String]) -> String {
    // A name out of a log may hold NUL, which no shell can be given.
    let quoter = shlex::Quoter::new().allow_nul(true);
    quoter.join(words.iter().map(String::as_str)).unwrap_or_else(|_nul| words.join(" "))
}

/// The options that say which columns are the time and the trial, where they are named, and those of
/// each joint: its name, its input and its output.
pub(crate) fn mapping_options(named: [Option<&str>; 2], joints: &[[String; 3]]) -> String {
    let named = ["--time", "--trial"].into_iter().zip(named);
    let named = named.filter_map(|(option, column)| Some([option.to_owned(), column?.to_owned()]));
    let joints = joints
        .iter()
        .map(|[name, input, output]| ["--joint".to_owned(), format!("{name}={input}:{output}")]);
    quoted(&named.chain(joints).flatten().collect::<Vec<_>>())
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_takes_each_word_for_one() {
        let words = ["log.csv", "--joint", "my boom", "it's", ""].map(str::to_owned);
        assert_eq!(quoted(&words), r#"log.csv --joint 'my boom' "it's" ''"#);
    }
}
