//! Recordings of any command.

use std::path::Path;

use crate::delay::Settings;
use crate::delay::sweep::Grid;
use crate::experiment::{ReadOptions, Source};
use crate::report::{ComparedJoint, DesignedJoint, EstimatedJoint, ImprovedJoint, ReportedSweep};

use super::message;
use super::output::{OutputFile, write_file};
use super::progress::{Bar, Verbosity};

/// How many candidates are recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Detail {
    /// Every candidate of every segment
    Full,
    /// At most 25 candidates of an accepted segment: for long logs
    Lean,
}

/// What a recording holds.
#[cfg_attr(not(feature = "rrd"), expect(dead_code, reason = "there is no recording then"))]
pub(super) struct Contents<'a> {
    pub(super) joints: &'a [EstimatedJoint<'a>],
    pub(super) settings: &'a Settings,
    /// What other methods found.
    pub(super) also: &'a [(&'a Settings, &'a [EstimatedJoint<'a>])],
    pub(super) sources: &'a [Source],
    pub(super) reading: &'a ReadOptions,
    pub(super) models: &'a [ComparedJoint<'a>],
    pub(super) revisions: &'a [ImprovedJoint<'a>],
    pub(super) detail: Detail,
}

impl Contents<'_> {
    /// Writes the recording to `path` and says how to look at it.
    pub(super) fn record(&self, path: &Path, verbosity: Verbosity) -> anyhow::Result<()> {
        record(path, verbosity, |file| self.write(file))
    }

    #[cfg(feature = "rrd")]
    fn write(&self, file: &mut OutputFile) -> anyhow::Result<()> {
        self.with_recording(|recording| Ok(crate::recording::write_recording(recording, file)?))
    }

    /// Does `work` with the recording.
    #[cfg(feature = "rrd")]
    pub(super) fn with_recording<T>(
        &self,
        work: impl FnOnce(&crate::recording::Recording<'_>) -> T,
    ) -> T {
        use crate::recording::{self, Beside, Recording};

        let also = self.also.iter().map(|&(settings, joints)| Beside { settings, joints });
        let also: Vec<Beside<'_>> = also.collect();
        let Self { joints, settings, sources, reading, models, revisions, detail, .. } = *self;
        let detail = match detail {
            Detail::Full => recording::Detail::Full,
            Detail::Lean => recording::Detail::Lean,
        };
        let also = also.as_slice();
        let recording =
            Recording { joints, settings, sources, reading, detail, models, also, revisions };
        work(&recording)
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
pub(super) struct SweepContents<'a> {
    pub(super) joints: &'a [ReportedSweep<'a>],
    pub(super) grid: &'a Grid,
    pub(super) tolerance: f64,
    pub(super) sources: &'a [Source],
    pub(super) reading: &'a ReadOptions,
}

impl SweepContents<'_> {
    /// Writes the recording to `path` and says how to look at it.
    pub(super) fn record(&self, path: &Path, verbosity: Verbosity) -> anyhow::Result<()> {
        record(path, verbosity, |file| self.write(file))
    }

    #[cfg(feature = "rrd")]
    fn write(&self, file: &mut OutputFile) -> anyhow::Result<()> {
        Ok(crate::recording::write_sweep(&self.recording(), file)?)
    }

    #[cfg(feature = "rrd")]
    pub(super) fn recording(&self) -> crate::recording::SweepRecording<'_> {
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
pub(super) struct PreviewContents<'a> {
    pub(super) joints: &'a [DesignedJoint],
    pub(super) sources: &'a [Source],
    pub(super) reading: &'a ReadOptions,
    pub(super) model: Option<&'a Path>,
}

impl PreviewContents<'_> {
    /// Writes the recording to `path` and says how to look at it.
    pub(super) fn record(&self, path: &Path, verbosity: Verbosity) -> anyhow::Result<()> {
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
pub(super) fn recordings_are_there() -> anyhow::Result<()> {
    Ok(())
}

#[cfg(not(feature = "rrd"))]
pub(super) fn recordings_are_there() -> anyhow::Result<()> {
    Err(left_out())
}

#[cfg(not(feature = "rrd"))]
pub(super) fn left_out() -> anyhow::Error {
    anyhow::anyhow!("this program was built without recordings: build it with feature `rrd`")
}
