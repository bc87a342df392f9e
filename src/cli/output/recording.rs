//! Recordings of any command.

use std::path::{Path, PathBuf};

use anyhow::bail;

use super::file::{OutputFile, filled_file, is_file, write_file};
use super::outputs::{OutputKind, Outputs};
use crate::cli::console::{Bar, Verbosity};
use crate::delay::Settings;
use crate::experiment::Experiment;
use crate::report::{self, EstimatedJoint, Recording, SweepRecording};

/// How many candidates are recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Detail {
    /// All candidates up to 200,000 of them, else as `lean`
    Auto,
    /// Every candidate of every segment
    Full,
    /// At most 25 candidates of an accepted segment that is not doubtful
    Lean,
}

/// Joints up to which all are in one recording: with more of them a viewer takes long to open
/// it, and gigabytes.
const TOGETHER: usize = 20;

/// Joints of a file, where there are more.
const OF_A_FILE: usize = 8;

/// Candidates up to which all are recorded. Each takes 230 bytes: above it they are more than half
/// of a recording of 14 joints of 100,000 samples.
const CANDIDATES: usize = 200_000;

impl Detail {
    /// How many are recorded of `joints`.
    pub(crate) fn of(self, joints: &[EstimatedJoint<'_>]) -> report::Detail {
        let trials = joints.iter().flat_map(|joint| joint.estimate.estimated());
        let decisions = trials.flat_map(|trial| &trial.decisions);
        let all = || decisions.map(|decision| decision.candidates.len()).sum::<usize>();
        match self {
            Self::Full => report::Detail::Full,
            Self::Auto if all() <= CANDIDATES => report::Detail::Full,
            Self::Auto | Self::Lean => report::Detail::Lean,
        }
    }
}

/// The delays of `joints`, alone.
pub(crate) fn of_delays<'a>(
    command: &'a str,
    experiment: &'a Experiment,
    (joints, settings): (&'a [EstimatedJoint<'a>], &'a Settings),
) -> Recording<'a> {
    let Experiment { sources, options: reading, .. } = experiment;
    let (also, models, revisions, detail) = (&[], &[], &[], Detail::Auto.of(joints));
    Recording { command, joints, settings, sources, reading, detail, models, also, revisions }
}

impl Recording<'_> {
    /// Writes the recording to `path` and says how to look at it. Of many joints the first are in
    /// `path`, and others in files beside it: none has its name before all are whole.
    pub(crate) fn record(&self, path: &Path, verbosity: Verbosity) -> anyhow::Result<()> {
        if self.joints.len() <= TOGETHER || !is_file(path) {
            return Recorded::Decisions(self).record(path, verbosity);
        }
        let bar = Bar::spinner(verbosity, "recording");
        let groups = self.joints.chunks(OF_A_FILE);
        let paths: Vec<PathBuf> = (1..=groups.len()).map(|number| part(path, number)).collect();
        self.check_parts(&paths)?;
        let mut files = Vec::new();
        for (joints, path) in groups.zip(&paths) {
            // A viewer lists recordings by name.
            let ends = joints.first().into_iter().chain(joints.last());
            let ends: Vec<&str> = ends.map(|joint| joint.joint.name.as_str()).collect();
            let command = format!("{} of {}", self.command, ends.join(" … "));
            let some = Recording { joints, command: &command, ..*self };
            files.push(filled_file(path, |file| Recorded::Decisions(&some).write(file))?);
        }
        files.into_iter().try_for_each(OutputFile::commit)?;
        drop(bar);
        let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        let (all, names) = (self.joints.len(), names.join(" "));
        verbosity.say(
            "recording",
            format!("{all} joints, {OF_A_FILE} in a file; open some of: rerun {names}"),
        );
        Ok(())
    }

    /// Refuses to replace an input; or, where no recording is at the first of `paths`, what can be no
    /// part of an earlier one.
    fn check_parts(&self, paths: &[PathBuf]) -> anyhow::Result<()> {
        let inputs: Vec<PathBuf> = self.sources.iter().map(|source| source.path.clone()).collect();
        Outputs::default().with(OutputKind::Recording, paths).check(&inputs)?;
        let Some((first, others)) = paths.split_first() else { return Ok(()) };
        if let Some(other) = others.iter().find(|other| other.exists() && !first.exists()) {
            bail!(
                "{}: exists already, and a recording of many joints needs files of this name beside \
                 {}; give the recording another name",
                other.display(),
                first.display()
            );
        }
        Ok(())
    }
}

/// The name of a file of a recording at `path`: `x.rrd`, `x_2.rrd` and so on.
fn part(path: &Path, number: usize) -> PathBuf {
    if number == 1 {
        return path.to_owned();
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().map(|ending| format!(".{}", ending.to_string_lossy()));
    path.with_file_name(format!("{stem}_{number}{}", ending.unwrap_or_default()))
}

/// What goes into one file.
#[derive(Clone, Copy)]
#[cfg_attr(not(feature = "rrd"), expect(dead_code, reason = "there is no recording then"))]
pub(crate) enum Recorded<'a> {
    Decisions(&'a Recording<'a>),
    Sweep(&'a SweepRecording<'a>),
}

impl Recorded<'_> {
    /// Writes the recording to `path` and says how to look at it.
    pub(crate) fn record(self, path: &Path, verbosity: Verbosity) -> anyhow::Result<()> {
        {
            let _bar = Bar::spinner(verbosity, "recording");
            write_file(path, |file| self.write(file))?;
        }
        let path = path.display();
        verbosity.say("recording", format!("{path}; open it with: rerun {path}"));
        Ok(())
    }

    #[cfg(feature = "rrd")]
    fn write(self, file: &mut OutputFile) -> anyhow::Result<()> {
        use crate::recording::{write_recording, write_sweep};

        match self {
            Self::Decisions(recording) => write_recording(recording, file)?,
            Self::Sweep(recording) => write_sweep(recording, file)?,
        }
        Ok(())
    }

    #[cfg(not(feature = "rrd"))]
    #[expect(clippy::unused_self, reason = "with recordings it is used")]
    fn write(self, _: &mut OutputFile) -> anyhow::Result<()> {
        Err(left_out())
    }
}

#[cfg(not(feature = "rrd"))]
pub(crate) fn left_out() -> anyhow::Error {
    anyhow::anyhow!("this program was built without recordings: build it with feature `rrd`")
}
