//! The files that `tauscope estimate` writes.

use std::path::PathBuf;

use crate::report::{
    decision_table, delay_table, level_table, write_decisions, write_delays, write_level_table,
};

use super::args::OutputArgs;
use super::estimated::Estimated;
use crate::cli::console::Verbosity;
use crate::cli::output::{
    Contents, FileKind, check_outputs, check_tables, write_file, write_parquet,
};
use crate::cli::viewer::Stream;

/// The files that were asked for, found to be writable before the work starts.
pub(crate) struct Files<'a> {
    args: &'a OutputArgs,
}

impl<'a> Files<'a> {
    /// Refuses what cannot be written, or would replace an input or another output.
    pub(crate) fn check(args: &'a OutputArgs, inputs: &[PathBuf]) -> anyhow::Result<Self> {
        let outputs = [&args.recording, &args.decisions, &args.delays, &args.table];
        let outputs = outputs.into_iter().flatten();
        check_outputs(&outputs.map(PathBuf::as_path).collect::<Vec<_>>(), inputs)?;
        check_tables(args.decisions.iter().chain(&args.delays).chain(&args.table))?;
        Ok(Self { args })
    }

    /// Writes each file whole and gives it its name; shows the recording to who looks on.
    pub(crate) fn write(
        &self,
        result: &Estimated<'_>,
        stream: &Stream,
        verbosity: Verbosity,
    ) -> anyhow::Result<()> {
        if let Some(path) = &self.args.decisions {
            write_file(path, |file| match FileKind::of(path) {
                FileKind::Csv => Ok(write_decisions(result.runs, file)?),
                FileKind::Parquet => write_parquet(&decision_table(result.runs)?, file),
            })?;
        }
        if let Some(path) = &self.args.delays {
            write_file(path, |file| match FileKind::of(path) {
                FileKind::Csv => Ok(write_delays(result.joints, file)?),
                FileKind::Parquet => write_parquet(&delay_table(result.joints), file),
            })?;
        }
        if let Some(path) = &self.args.table {
            write_file(path, |file| match FileKind::of(path) {
                FileKind::Csv => Ok(write_level_table(result.joints, file)?),
                FileKind::Parquet => write_parquet(&level_table(result.joints)?, file),
            })?;
        }
        let contents = Contents {
            joints: result.joints,
            settings: result.settings,
            also: result.runs.get(1..).unwrap_or_default(),
            sources: &result.experiment.sources,
            reading: &result.experiment.options,
            models: &[],
            revisions: &[],
            detail: self.args.detail,
        };
        if let Some(path) = &self.args.recording {
            contents.record(path, verbosity)?;
        }
        stream.send(&contents, None)
    }
}
