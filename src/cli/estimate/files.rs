//! The files that `tauscope estimate` writes.

use std::path::PathBuf;

use tauscope::report::{write_decisions, write_delays};

use super::Estimated;
use super::args::OutputArgs;
use crate::cli::output::{check_outputs, write_file};
use crate::cli::progress::Verbosity;
use crate::cli::record::Contents;

/// The files that were asked for, found to be writable before the work starts.
pub(super) struct Files<'a> {
    args: &'a OutputArgs,
}

impl<'a> Files<'a> {
    /// Refuses what cannot be written, or would replace an input or another output.
    pub(super) fn check(args: &'a OutputArgs, inputs: &[PathBuf]) -> anyhow::Result<Self> {
        let outputs = [&args.recording, &args.decisions, &args.delays].into_iter().flatten();
        check_outputs(&outputs.map(PathBuf::as_path).collect::<Vec<_>>(), inputs)?;
        Ok(Self { args })
    }

    /// Writes each file whole and gives it its name.
    pub(super) fn write(&self, result: &Estimated<'_>, verbosity: Verbosity) -> anyhow::Result<()> {
        if let Some(path) = &self.args.decisions {
            write_file(path, |file| Ok(write_decisions(result.runs, file)?))?;
        }
        if let Some(path) = &self.args.delays {
            write_file(path, |file| Ok(write_delays(result.joints, file)?))?;
        }
        if let Some(path) = &self.args.recording {
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
            contents.record(path, verbosity)?;
        }
        Ok(())
    }
}
