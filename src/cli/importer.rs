//! The program as a viewer calls it: `rerun LOG.csv` opens the whole recording of the log.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::{Context as _, bail};

use super::console::{Hosting, message};
use super::program;
use super::viewer::{DECLINED, asked_about};
use crate::experiment::{MemoryLimit, Survey, is_named_like_a_log};

/// Runs the command that the arguments name, or what a viewer asks for that has called the program
/// `rerun-importer-tauscope`.
///
/// Exit status: 0 all done; 1 some joints or files failed; 2 nothing usable. Of an importer: 66 a
/// file that is no log of joints; 2 a log that cannot be read.
pub fn run() -> ExitCode {
    let Some(log) = asked_about(std::env::args_os()) else { return program::run() };
    if !is_for_us(&log) {
        return ExitCode::from(DECLINED);
    }
    match import(&log) {
        Ok(()) => ExitCode::SUCCESS,
        // Files are declined in silence that may be anything.
        Err(_) if !has_joints(&log) => ExitCode::from(DECLINED),
        Err(error) => {
            message("error", &format!("{error:#}"));
            ExitCode::from(2)
        }
    }
}

/// Whether a file is named like a log. A viewer asks about every file that it opens.
fn is_for_us(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    cfg!(feature = "rrd") && is_named_like_a_log(&name) && path.is_file()
}

/// Whether joints are recognized in a file.
fn has_joints(path: &Path) -> bool {
    Survey::of(path, MemoryLimit::default()).is_ok_and(|survey| !survey.map.joints.is_empty())
}

/// Writes the recording of a log to standard output: what `tauscope estimate LOG -o FILE.rrd` makes.
fn import(log: &Path) -> anyhow::Result<()> {
    let folder = tempfile::tempdir().context("no folder for the recording can be made")?;
    let recording = folder.path().join("log.rrd");
    let arguments = ["estimate".into(), log.as_os_str().to_owned(), "-o".into()];
    let arguments: Vec<OsString> =
        arguments.into_iter().chain([recording.into_os_string()]).collect();
    if let Err(refused) = program::run_within(&arguments, Arc::new(Silent)) {
        bail!("{}", refused.message);
    }
    for part in parts(folder.path())? {
        io::copy(&mut File::open(part)?, &mut io::stdout())?;
    }
    Ok(())
}

/// The files of the recording: several of many joints.
fn parts(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let files = fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut files: Vec<PathBuf> = files.collect::<io::Result<_>>()?;
    files.sort();
    Ok(files)
}

/// Whoever looks at the recording alone: it says itself what was found and how the log was read.
struct Silent;

impl Hosting for Silent {}
