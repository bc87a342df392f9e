//! `tauscope merge`: the tables of all logs, from the results of parts.

use std::path::PathBuf;

use crate::report::folder::FolderReport;
use clap::Args as ClapArgs;

use crate::cli::args::Format;
use crate::cli::console::Verbosity;
use crate::cli::each_log::{Merged, Tables, kept_in, present, read_folders};
use crate::cli::exit::Completion;

/// Merge the results of many logs into tables of all logs
///
/// The results are those of `estimate` or `improve` with `--results`, and `--shard`. The
/// tables are the same, byte for byte, as those of one run over all logs.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// Folders of results
    #[arg(required = true, value_name = "RESULTS")]
    folders: Vec<PathBuf>,

    /// Write the decisions of all logs, as CSV or Parquet
    #[arg(long, value_name = "FILE")]
    decisions: Option<PathBuf>,

    /// Write a row per log and joint, as CSV or Parquet
    #[arg(long, value_name = "FILE")]
    summary: Option<PathBuf>,

    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,

    /// No notices
    #[arg(short, long)]
    quiet: bool,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let (decisions, summary) = (args.decisions.as_deref(), args.summary.as_deref());
    let tables = Tables { decisions, summary };
    tables.check(&kept_in(&args.folders)?)?;
    let Merged { command, results, failures, notes } = read_folders(&args.folders)?;
    let verbosity = Verbosity::from(args.quiet);
    for note in &notes {
        verbosity.say("note", note);
    }
    let report = FolderReport::new(&command, results);
    if command != "estimate" && tables.decisions.is_some() {
        anyhow::bail!("--decisions: these are results of `{command}`, which makes no decisions");
    }
    present(&report, &failures, tables, args.format, verbosity)
}
