//! Recordings of any command.

use std::path::Path;
#[cfg(feature = "rrd")]
use std::path::PathBuf;

#[cfg(feature = "rrd")]
use anyhow::bail;

#[cfg(feature = "rrd")]
use super::file::filled_file;
use super::file::{OutputFile, is_file, write_file};
#[cfg(feature = "rrd")]
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
#[cfg(feature = "rrd")]
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
    /// Writes the recording to `path` and says how to look at it. Of many joints it writes a
    /// recording of some of them each to `path_1`, `path_2` and so on, and to `path` one that leads
    /// to them.
    pub(crate) fn record(&self, path: &Path, verbosity: Verbosity) -> anyhow::Result<()> {
        if self.joints.len() <= TOGETHER || !is_file(path) {
            return Recorded::Decisions(self).record(path, verbosity);
        }
        let parts = {
            let _bar = Bar::spinner(verbosity, "recording");
            self.write_parts(path)?
        };
        let path = path.display();
        let ends = parts.first().zip(parts.last());
        let said = ends.map(|(first, last)| format!("{first} … {last}")).unwrap_or_default();
        verbosity.say("recording", format!("{path}; open it with: rerun {path}; joints: {said}"));
        Ok(())
    }

    /// Writes the files of some joints each, and what leads to them; their names. None has its
    /// name before all are whole.
    #[cfg(feature = "rrd")]
    fn write_parts(&self, path: &Path) -> anyhow::Result<Vec<String>> {
        use crate::recording::{IndexRecording, Volume, write_index};

        let groups: Vec<_> = self.joints.chunks(OF_A_FILE).collect();
        let paths: Vec<PathBuf> = (1..=groups.len()).map(|number| part(path, number)).collect();
        let inputs: Vec<PathBuf> = self.sources.iter().map(|source| source.path.clone()).collect();
        let outputs: Vec<&Path> = paths.iter().map(PathBuf::as_path).collect();
        Outputs::default().with(OutputKind::Recording, &paths).check(&inputs)?;
        check_own(path, &outputs)?;
        let mut files = Vec::new();
        for (joints, path) in groups.iter().zip(&paths) {
            // A viewer lists recordings by name.
            let (first, last) = (joints.first(), joints.last());
            let ends = first.into_iter().chain(last).map(|joint| joint.joint.name.as_str());
            let ends: Vec<&str> = ends.collect();
            let command = format!("{} of {}", self.command, ends.join(" … "));
            let some = Recording { joints, command: &command, ..*self };
            files.push(filled_file(path, |file| Recorded::Decisions(&some).write(file))?);
        }
        let volume = |(path, joints): (&PathBuf, &&[EstimatedJoint<'_>])| Volume {
            file: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            joints: joints.len(),
        };
        let volumes: Vec<Volume> = paths.iter().zip(&groups).map(volume).collect();
        let index = |file: &mut OutputFile| {
            write_index(&IndexRecording { all: self, volumes: &volumes }, file)
        };
        files.push(filled_file(path, |file| Ok(index(file)?))?);
        files.into_iter().try_for_each(OutputFile::commit)?;
        Ok(volumes.into_iter().map(|volume| volume.file).collect())
    }

    #[cfg(not(feature = "rrd"))]
    #[expect(clippy::unused_self, reason = "with recordings it is used")]
    fn write_parts(&self, _: &Path) -> anyhow::Result<Vec<String>> {
        Err(left_out())
    }
}

/// Refuses to replace a file that lies where a part of the recording at `path` goes, and cannot be
/// of an earlier one: no recording is at `path`.
#[cfg(feature = "rrd")]
fn check_own(path: &Path, parts: &[&Path]) -> anyhow::Result<()> {
    match parts.iter().find(|part| part.exists()) {
        Some(part) if !path.exists() => bail!(
            "{}: exists already, and a recording of many joints needs files of this name beside \
             {}; give the recording another name",
            part.display(),
            path.display()
        ),
        _ => Ok(()),
    }
}

/// The name of the file `number` beside `path`: `x_1.rrd` beside `x.rrd`.
#[cfg(feature = "rrd")]
fn part(path: &Path, number: usize) -> PathBuf {
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
