//! The files that `tauscope estimate` writes.

use std::path::PathBuf;

use tauscope::report::{write_decisions, write_delays};

use super::Estimated;
use super::args::OutputArgs;
use crate::cli::message;
use crate::cli::output::OutputFile;
use crate::cli::progress::Verbosity;

/// The files that were asked for, open before the work starts.
pub(super) struct Files {
    recording: Option<(PathBuf, OutputFile)>,
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
            record(result, file)?;
            if verbosity == Verbosity::Normal {
                let path = path.display();
                message("recording", &format!("{path}; look at it with: rerun {path}"));
            }
        }
        Ok(())
    }
}

#[cfg(feature = "rrd")]
fn record(result: &Estimated<'_>, mut file: OutputFile) -> anyhow::Result<()> {
    let recording = tauscope::recording::EstimateRecording {
        joints: result.joints,
        settings: result.settings,
        sources: &result.experiment.sources,
        detail: tauscope::recording::Detail::Full,
    };
    tauscope::recording::write_estimate(&recording, &mut file)?;
    file.commit()
}

#[cfg(not(feature = "rrd"))]
fn record(_: &Estimated<'_>, _: OutputFile) -> anyhow::Result<()> {
    anyhow::bail!("this program was built without recordings (feature `rrd`)")
}
