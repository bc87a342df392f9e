//! The files that `tauscope estimate` writes.

use std::path::PathBuf;

use tauscope::report::{write_decisions, write_delays};

use super::Estimated;
use super::args::{Detail, OutputArgs};
use crate::cli::message;
use crate::cli::output::OutputFile;
use crate::cli::progress::Verbosity;

/// The files that were asked for, open before the work starts.
pub(super) struct Files {
    recording: Option<(PathBuf, OutputFile)>,
    detail: Detail,
    decisions: Option<OutputFile>,
    delays: Option<OutputFile>,
}

impl Files {
    pub(super) fn create(args: &OutputArgs) -> anyhow::Result<Self> {
        let open =
            |path: &Option<PathBuf>| path.as_ref().map(|path| OutputFile::create(path)).transpose();
        let recording = open(&args.recording)?;
        Ok(Self {
            recording: args.recording.clone().zip(recording),
            detail: args.detail,
            decisions: open(&args.decisions)?,
            delays: open(&args.delays)?,
        })
    }

    /// Writes each file whole and gives it its name.
    pub(super) fn write(self, result: &Estimated<'_>, verbosity: Verbosity) -> anyhow::Result<()> {
        if let Some(mut file) = self.decisions {
            write_decisions(result.joints, &mut file)?;
            file.commit()?;
        }
        if let Some(mut file) = self.delays {
            write_delays(result.joints, &mut file)?;
            file.commit()?;
        }
        if let Some((path, file)) = self.recording {
            record(result, file, self.detail)?;
            if verbosity == Verbosity::Normal {
                let path = path.display();
                message("recording", &format!("{path}; look at it with: rerun {path}"));
            }
        }
        Ok(())
    }
}

#[cfg(feature = "rrd")]
fn record(result: &Estimated<'_>, mut file: OutputFile, detail: Detail) -> anyhow::Result<()> {
    use tauscope::recording::{self, EstimateRecording, write_estimate};

    let detail = match detail {
        Detail::Full => recording::Detail::Full,
        Detail::Lean => recording::Detail::Lean,
    };
    let (joints, settings) = (result.joints, result.settings);
    let sources = &result.experiment.sources;
    let recording = EstimateRecording { joints, settings, sources, detail };
    write_estimate(&recording, &mut file)?;
    file.commit()
}

#[cfg(not(feature = "rrd"))]
fn record(_: &Estimated<'_>, _: OutputFile, _: Detail) -> anyhow::Result<()> {
    anyhow::bail!("this program was built without recordings: build it with feature `rrd`")
}
