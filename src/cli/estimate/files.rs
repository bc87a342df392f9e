//! The files that `tauscope estimate` writes.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use tauscope::report::{write_decisions, write_delays};

use super::Estimated;
use super::args::{Detail, OutputArgs};
use crate::cli::message;
use crate::cli::output::{OutputFile, target_of};
use crate::cli::progress::Verbosity;

/// The files that were asked for, found to be writable before the work starts.
pub(super) struct Files<'a> {
    args: &'a OutputArgs,
}

impl<'a> Files<'a> {
    /// Refuses what cannot be written, or would replace an input or another output.
    pub(super) fn check(args: &'a OutputArgs, inputs: &[PathBuf]) -> anyhow::Result<Self> {
        let mut taken: Vec<PathBuf> = inputs.to_vec();
        for path in [&args.recording, &args.decisions, &args.delays].into_iter().flatten() {
            let target = target_of(path);
            let name = path.display();
            // A device, such as /dev/null, may take any number of outputs.
            let is_file = !target.exists() || target.is_file();
            if inputs.contains(&target) {
                bail!("{name}: this is a file that is read; give the output another name");
            }
            if is_file && taken.contains(&target) {
                bail!("{name}: two outputs have this name; give each its own");
            }
            OutputFile::probe(path)?;
            taken.push(target);
        }
        Ok(Self { args })
    }

    /// Writes each file whole and gives it its name.
    pub(super) fn write(&self, result: &Estimated<'_>, verbosity: Verbosity) -> anyhow::Result<()> {
        if let Some(path) = &self.args.decisions {
            write_file(path, |file| Ok(write_decisions(result.joints, file)?))?;
        }
        if let Some(path) = &self.args.delays {
            write_file(path, |file| Ok(write_delays(result.joints, file)?))?;
        }
        if let Some(path) = &self.args.recording {
            write_file(path, |file| record(result, file, self.args.detail))?;
            if verbosity == Verbosity::Normal {
                let path = path.display();
                message("recording", &format!("{path}; look at it with: rerun {path}"));
            }
        }
        Ok(())
    }
}

/// Lets `write` fill a file and gives it its name when that went well.
fn write_file(
    path: &Path,
    write: impl FnOnce(&mut OutputFile) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut file = OutputFile::create(path)?;
    write(&mut file).with_context(|| format!("{}: cannot be written", path.display()))?;
    file.commit()
}

#[cfg(feature = "rrd")]
fn record(result: &Estimated<'_>, file: &mut OutputFile, detail: Detail) -> anyhow::Result<()> {
    use tauscope::recording::{self, EstimateRecording, write_estimate};

    let detail = match detail {
        Detail::Full => recording::Detail::Full,
        Detail::Lean => recording::Detail::Lean,
    };
    let (joints, settings) = (result.joints, result.settings);
    let sources = &result.experiment.sources;
    let recording = EstimateRecording { joints, settings, sources, detail };
    Ok(write_estimate(&recording, file)?)
}

#[cfg(not(feature = "rrd"))]
fn record(_: &Estimated<'_>, _: &mut OutputFile, _: Detail) -> anyhow::Result<()> {
    anyhow::bail!("this program was built without recordings: build it with feature `rrd`")
}
