//! Other results that decisions are compared with: `--against`.

use std::path::PathBuf;

use clap::Args as ClapArgs;

/// Results to compare with.
#[derive(ClapArgs, Debug)]
pub(crate) struct AgainstArgs {
    /// Show where decisions differ from those of another result: the JSON of an earlier
    /// `estimate --format json`, its table of `--decisions`, or another log of the experiment,
    /// which is estimated with the same settings. May be repeated
    #[arg(long, value_name = "FILE")]
    pub(crate) against: Vec<PathBuf>,
}
