//! Recordings of any command.

use std::path::Path;

use tauscope::delay::Settings;
use tauscope::experiment::{ReadOptions, Source};
use tauscope::report::{ComparedJoint, EstimatedJoint, ImprovedJoint};

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
        {
            let _bar = Bar::spinner(verbosity, "recording");
            write_file(path, |file| self.write(file))?;
        }
        if verbosity == Verbosity::Normal {
            let path = path.display();
            message("recording", &format!("{path}; look at it with: rerun {path}"));
        }
        Ok(())
    }

    #[cfg(feature = "rrd")]
    fn write(&self, file: &mut OutputFile) -> anyhow::Result<()> {
        self.with_recording(|recording| Ok(tauscope::recording::write_recording(recording, file)?))
    }

    /// Does `work` with the recording.
    #[cfg(feature = "rrd")]
    pub(super) fn with_recording<T>(
        &self,
        work: impl FnOnce(&tauscope::recording::Recording<'_>) -> T,
    ) -> T {
        use tauscope::recording::{self, Beside, Recording};

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
        anyhow::bail!("this program was built without recordings: build it with feature `rrd`")
    }
}
