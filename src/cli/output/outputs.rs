//! What a command writes, checked before its work begins.

use std::path::{Path, PathBuf};

use anyhow::bail;

use super::file::{FileKind, OutputFile, place_of, target_of};
use crate::experiment::{MemoryLimit, Survey, is_named_like_a_log};

/// What an output is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OutputKind {
    /// A recording for the viewer.
    Recording,
    /// A table, CSV or Parquet by its name's ending.
    Table,
    /// A table that is CSV alone.
    Csv,
    /// A log as CSV, which may be made anew.
    Log,
    /// A model, or the columns of a log.
    Toml,
    /// Of which the command itself says how it is called.
    Other,
}

impl OutputKind {
    /// How its name may end, where that says what a file is.
    fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Recording => &[".rrd"],
            Self::Table => &[".csv", ".txt", ".parquet", ".pq"],
            Self::Csv | Self::Log => &[".csv", ".txt"],
            Self::Toml => &[".toml"],
            Self::Other => &[],
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Self::Recording => {
                "`-o` writes a recording for the Rerun viewer; call it FILE.rrd (tables of `estimate`: \
                 `--decisions` and `--delays`; a page: `tauscope report`)"
            }
            Self::Table => "a table is written as CSV or Parquet; call it FILE.csv or FILE.parquet",
            Self::Csv | Self::Log => "it is written as CSV; call it FILE.csv",
            Self::Toml => "it is written as TOML; call it FILE.toml",
            Self::Other => "",
        }
    }

    /// Refuses a name that says that the file is of another kind.
    fn check_name(self, path: &Path) -> anyhow::Result<()> {
        const OTHERS: [&str; 9] =
            [".html", ".htm", ".md", ".json", ".toml", ".pdf", ".rrd", ".xls", ".ods"];
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let ends = |endings: &[&str]| endings.iter().any(|ending| name.ends_with(ending));
        let says_another = is_named_like_a_log(&name) || ends(&OTHERS);
        if self != Self::Other && says_another && !ends(self.endings()) {
            bail!("{}: {}", path.display(), self.remedy());
        }
        Ok(())
    }
}

/// The files that a command writes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outputs<'a>(Vec<(OutputKind, &'a Path)>);

impl<'a> Outputs<'a> {
    /// With files of one kind.
    pub(crate) fn with<P: AsRef<Path> + ?Sized + 'a>(
        mut self,
        kind: OutputKind,
        paths: impl IntoIterator<Item = &'a P>,
    ) -> Self {
        self.0.extend(paths.into_iter().map(|path| (kind, path.as_ref())));
        self
    }

    /// Refuses what cannot be written, or would replace one of the `inputs`, one another, or a log;
    /// names that say another kind of file; and tables that this build cannot write.
    pub(crate) fn check(&self, inputs: &[PathBuf]) -> anyhow::Result<()> {
        let Self(outputs) = self;
        check_places(outputs.iter().map(|(_, path)| *path), inputs)?;
        for (kind, path) in outputs {
            let name = path.display();
            if *kind != OutputKind::Log && is_log(path) {
                bail!(
                    "{name}: this is a log, which would be replaced; give the output another name"
                );
            }
            kind.check_name(path)?;
            let is_parquet = *kind == OutputKind::Table && FileKind::of(path) == FileKind::Parquet;
            if is_parquet && !cfg!(feature = "parquet") {
                bail!(
                    "{name}: Parquet is not in this build of tauscope; build it with `--features \
                     parquet`, or give the file a name that ends in .csv"
                );
            }
        }
        Ok(())
    }
}

fn check_places<'a>(
    outputs: impl Iterator<Item = &'a Path>,
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
