//! What a command writes, checked before its work begins.

use std::path::{Path, PathBuf};

use anyhow::bail;

use super::file::{OutputFile, place_of, target_of};
use super::table::FileKind;
use crate::experiment::{MemoryLimit, Survey, is_named_like_a_log};

/// The files that a command writes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outputs<'a> {
    /// The recording for the viewer.
    pub(crate) recording: Option<&'a Path>,
    /// Tables, CSV or Parquet by their names' endings.
    pub(crate) tables: Vec<&'a Path>,
    /// Other files.
    pub(crate) files: Vec<&'a Path>,
    /// What has the form of a log, and may be made anew.
    pub(crate) logs: Vec<&'a Path>,
}

impl Outputs<'_> {
    /// Refuses what cannot be written, or would replace one of the `inputs`, one another, or a log; a
    /// recording whose name says that it is something else, or whose parts would replace another output;
    /// and tables that this build cannot write.
    pub(crate) fn check(&self, inputs: &[PathBuf]) -> anyhow::Result<()> {
        let others: Vec<&Path> = [&*self.files, &*self.tables].concat();
        let outputs: Vec<&Path> = self.recording.iter().chain(&others).copied().collect();
        check_places(outputs.iter().chain(&self.logs), inputs)?;
        if let Some(path) = outputs.iter().find(|path| is_log(path)) {
            bail!(
                "{}: this is a log, which would be replaced; give the output another name",
                path.display()
            );
        }
        if let Some(recording) = self.recording {
            check_name(recording)?;
            check_beside_parts(recording, &others)?;
        }
        let parquet = self.tables.iter().find(|path| FileKind::of(path) == FileKind::Parquet);
        match parquet {
            Some(path) if !cfg!(feature = "parquet") => bail!(
                "{}: Parquet is not in this build of tauscope; build it with `--features parquet`, or \
                 give the file a name that ends in .csv",
                path.display()
            ),
            _ => Ok(()),
        }
    }
}

fn check_places<'a>(
    outputs: impl Iterator<Item = &'a &'a Path>,
    inputs: &[PathBuf],
) -> anyhow::Result<()> {
    let inputs: Vec<PathBuf> = inputs.iter().map(|path| target_of(path)).collect();
    let mut taken: Vec<PathBuf> = Vec::new();
    for path in outputs {
        let target = place_of(path);
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
    Ok(())
}

/// Whether a log is at `path`: a table in which a time and at least one joint are recognised.
fn is_log(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let survey = || Survey::of(path, MemoryLimit::default());
    is_named_like_a_log(&name) && path.is_file() && survey().is_ok_and(|log| log.open.is_empty())
}

fn check_name(path: &Path) -> anyhow::Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let others = [".html", ".htm", ".md", ".json", ".toml", ".pdf"];
    if is_named_like_a_log(&name) || others.iter().any(|ending| name.ends_with(ending)) {
        bail!(
            "{}: `-o` writes a recording for the Rerun viewer; call it FILE.rrd (tables of `estimate`: \
             `--decisions` and `--delays`; a page: `tauscope report`)",
            path.display()
        );
    }
    Ok(())
}

/// Refuses `others` that have the name of one of the files to which a recording of many joints at
/// `path` goes.
fn check_beside_parts(path: &Path, others: &[&Path]) -> anyhow::Result<()> {
    let (stem, ending) = (path.file_stem(), path.extension());
    let is_part = |other: &&&Path| {
        let number = other.file_stem().and_then(|name| {
            name.to_str()?.strip_prefix(stem?.to_str()?)?.strip_prefix('_')?.parse::<usize>().ok()
        });
        number.is_some() && other.extension() == ending && other.parent() == path.parent()
    };
    if let Some(other) = others.iter().find(is_part) {
        bail!(
            "{}: a recording of many joints has files of this name beside {}; give it another",
            other.display(),
            path.display()
        );
    }
    Ok(())
}
