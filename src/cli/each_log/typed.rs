//! The options of a command as they were typed.

use std::ffi::OsString;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::parser::ValueSource;
use clap::{ArgAction, Command};

/// Options that do not change the result of a log.
const WITHOUT_EFFECT: [&str; 8] =
    ["results", "shard", "summary", "safe_csv", "decisions", "format", "threads", "quiet"];

/// Options that name a file, whose content counts.
const FILES: [&str; 2] = ["columns", "model"];

/// What was typed beside the logs.
pub(crate) struct Typed {
    /// Options and their values.
    pub(crate) words: Vec<OsString>,
    /// Files that they name.
    pub(crate) files: Vec<PathBuf>,
}

/// The options of `command`, without those that do not change the result of a log.
pub(super) fn options(program: &Command, command: &str) -> anyhow::Result<Typed> {
    let matches = program.clone().get_matches();
    let matches = matches.subcommand_matches(command).context("the command is not known")?;
    let known = program.find_subcommand(command).context("the command is not known")?;
    let mut typed = Typed { words: Vec::new(), files: Vec::new() };
    for argument in known.get_arguments() {
        let id = argument.get_id().as_str();
        let given = matches.value_source(id) == Some(ValueSource::CommandLine);
        let Some(long) = argument.get_long().filter(|_| given) else { continue };
        if WITHOUT_EFFECT.contains(&id) {
            continue;
        }
        if matches!(argument.get_action(), ArgAction::SetTrue) {
            typed.words.push(format!("--{long}").into());
            continue;
        }
        for value in matches.get_raw(id).into_iter().flatten() {
            let mut word = OsString::from(format!("--{long}="));
            word.push(value);
            typed.words.push(word);
            typed.files.extend(FILES.contains(&id).then(|| PathBuf::from(value)));
        }
    }
    Ok(typed)
}
