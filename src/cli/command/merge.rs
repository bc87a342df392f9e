//! `tauscope merge`: the tables of all logs, from the results of parts.

use std::path::PathBuf;

use crate::report::FolderReport;
use clap::Args as ClapArgs;

use crate::cli::args::Format;
use crate::cli::console::Verbosity;
use crate::cli::each_log::{Tables, present, read_folders};
use crate::cli::exit::Completion;

/// Make the tables of all logs from folders of results
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
    let tables = Tables { decisions: args.decisions.as_deref(), summary: args.summary.as_deref() };
    tables.check(&[])?;
    let (command, results, missing) = read_folders(&args.folders)?;
    let report = FolderReport::new(&command, results);
    if command != "estimate" && tables.decisions.is_some() {
        anyhow::bail!("--decisions: these are results of `{command}`, which makes no decisions");
    }
    let verbosity = if args.quiet { Verbosity::Quiet } else { Verbosity::Normal };
    present(&report, &missing, tables, args.format, verbosity)
}
