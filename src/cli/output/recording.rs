//! Recordings of any command.

use std::path::Path;

use crate::delay::Settings;
use crate::delay::sweep::Grid;
use crate::experiment::{ReadOptions, Source};
use crate::report::{ComparedJoint, DesignedJoint, EstimatedJoint, ImprovedJoint, ReportedSweep};

use crate::study::OtherResult;

use super::file::{OutputFile, write_file};
use crate::cli::console::{Bar, Verbosity, message};

/// How many candidates are recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Detail {
    /// Every candidate of every segment
    Full,
    /// At most 25 candidates of an accepted segment: for long logs
    Lean,
}

/// What a recording holds.
#[cfg_attr(not(feature = "rrd"), expect(dead_code, reason = "there is no recording then"))]
pub(crate) struct Contents<'a> {
    /// The name of the command.
    pub(crate) command: &'a str,
    pub(crate) joints: &'a [EstimatedJoint<'a>],
    pub(crate) settings: &'a Settings,
    /// What is shown beside it.
    pub(crate) also: &'a [OtherResult],
    pub(crate) sources: &'a [Source],
    pub(crate) reading: &'a ReadOptions,
    pub(crate) models: &'a [ComparedJoint<'a>],
    pub(crate) revisions: &'a [ImprovedJoint<'a>],
    pub(crate) detail: Detail,
}

impl Contents<'_> {
    /// Writes the recording to `path` and says how to look at it.
    pub(crate) fn record(&self, path: &Path, verbosity: Verbosity) -> anyhow::Result<()> {
        record(path, verbosity, |file| self.write(file))
    }

    #[cfg(feature = "rrd")]
    fn write(&self, file: &mut OutputFile) -> anyhow::Result<()> {
        self.with_recording(|recording| Ok(crate::recording::write_recording(recording, file)?))
    }

    /// Does `work` with the recording.
    #[cfg(feature = "rrd")]
    pub(crate) fn with_recording<T>(
        &self,
        work: impl FnOnce(&crate::recording::Recording<'_>) -> T,
    ) -> T {
        use crate::recording::{self, Recording};

        let Self { command, joints, settings, sources, reading, .. } = *self;
        let Self { models, revisions, detail, also, .. } = *self;
        let detail = match detail {
            Detail::Full => recording::Detail::Full,
            Detail::Lean => recording::Detail::Lean,
        };
        work(&Recording {
            command,
            joints,
            settings,
            sources,
            reading,
            detail,
            models,
            also,
            revisions,
        })
    }

    #[cfg(not(feature = "rrd"))]
    #[expect(clippy::unused_self, reason = "with recordings it is used")]
    fn write(&self, _: &mut OutputFile) -> anyhow::Result<()> {
        Err(left_out())
    }
}

/// Delays over all settings, to be recorded.
#[derive(Clone, Copy)]
#[cfg_attr(not(feature = "rrd"), expect(dead_code, reason = "there is no recording then"))]
pub(crate) struct SweepContents<'a> {
    pub(crate) joints: &'a [ReportedSweep<'a>],
    pub(crate) grid: &'a Grid,
    pub(crate) tolerance: f64,
    pub(crate) sources: &'a [Source],
    pub(crate) reading: &'a ReadOptions,
}

impl SweepContents<'_> {
    /// Writes the recording to `path` and says how to look at it.
    pub(crate) fn record(&self, path: &Path, verbosity: Verbosity) -> anyhow::Result<()> {
        record(path, verbosity, |file| self.write(file))
    }

    #[cfg(feature = "rrd")]
    fn write(&self, file: &mut OutputFile) -> anyhow::Result<()> {
        Ok(crate::recording::write_sweep(&self.recording(), file)?)
    }

    #[cfg(feature = "rrd")]
    pub(crate) fn recording(&self) -> crate::recording::SweepRecording<'_> {
        let Self { joints, grid, tolerance, sources, reading } = *self;
        crate::recording::SweepRecording { joints, grid, tolerance, sources, reading }
    }

    #[cfg(not(feature = "rrd"))]
    #[expect(clippy::unused_self, reason = "with recordings it is used")]
    fn write(&self, _: &mut OutputFile) -> anyhow::Result<()> {
        Err(left_out())
    }
}

/// What is to be played, to be recorded before it is.
#[derive(Clone, Copy)]
#[cfg_attr(not(feature = "rrd"), expect(dead_code, reason = "there is no recording then"))]
pub(crate) struct PreviewContents<'a> {
    pub(crate) joints: &'a [DesignedJoint],
    pub(crate) sources: &'a [Source],
    pub(crate) reading: &'a ReadOptions,
    pub(crate) model: Option<&'a Path>,
}

impl PreviewContents<'_> {
    /// Writes the recording to `path` and says how to look at it.
    pub(crate) fn record(&self, path: &Path, verbosity: Verbosity) -> anyhow::Result<()> {
        record(path, verbosity, |file| self.write(file))
    }

    #[cfg(feature = "rrd")]
    fn write(&self, file: &mut OutputFile) -> anyhow::Result<()> {
        let Self { joints, sources, reading, model } = *self;
        let preview = crate::recording::PreviewRecording { joints, sources, reading, model };
        Ok(crate::recording::write_preview(&preview, file)?)
    }

    #[cfg(not(feature = "rrd"))]
    #[expect(clippy::unused_self, reason = "with recordings it is used")]
    fn write(&self, _: &mut OutputFile) -> anyhow::Result<()> {
        Err(left_out())
    }
}

/// Writes a recording to `path` and says how to look at it.
fn record(
    path: &Path,
    verbosity: Verbosity,
    write: impl FnOnce(&mut OutputFile) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    {
        let _bar = Bar::spinner(verbosity, "recording");
        write_file(path, write)?;
    }
    if verbosity == Verbosity::Normal {
        let path = path.display();
        message("recording", &format!("{path}; look at it with: rerun {path}"));
    }
    Ok(())
}

/// Says before the work is done whether its recording can be written.
#[cfg(feature = "rrd")]
#[expect(clippy::unnecessary_wraps, reason = "without recordings it fails")]
pub(crate) fn check_recordings() -> anyhow::Result<()> {
    Ok(())
}

#[cfg(not(feature = "rrd"))]
pub(crate) fn check_recordings() -> anyhow::Result<()> {
    Err(left_out())
}

#[cfg(not(feature = "rrd"))]
pub(crate) fn left_out() -> anyhow::Error {
    anyhow::anyhow!("this program was built without recordings: build it with feature `rrd`")
}
