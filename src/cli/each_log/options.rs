//! The options that make the result of a log.

use std::ffi::OsString;
use std::path::PathBuf;

use crate::cli::typed::Typed;

/// Options that do not change the result of a log, and the logs.
const WITHOUT_EFFECT: [&str; 8] =
    ["data", "results", "shard", "summary", "decisions", "format", "threads", "quiet"];

/// Options that name a file, whose content counts.
const FILES: [&str; 2] = ["columns", "model"];

/// What was typed beside the logs that changes the result of one.
pub(crate) struct LogOptions {
    /// Options and their values.
    pub(crate) words: Vec<OsString>,
    /// Files that they name.
    pub(crate) files: Vec<PathBuf>,
}

impl LogOptions {
    pub(super) fn of(typed: &Typed) -> Self {
        let mut options = Self { words: Vec::new(), files: Vec::new() };
        for (name, value) in typed.of(|name| !WITHOUT_EFFECT.contains(&name)) {
            let mut word = OsString::from(format!("--{name}"));
            if let Some(value) = value {
                word.push("=");
                word.push(value);
                options.files.extend(FILES.contains(&name).then(|| PathBuf::from(value)));
            }
            options.words.push(word);
        }
        options
    }
}
