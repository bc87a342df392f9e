//! Tables as CSV or Parquet, by the ending of the file's name.

use std::path::Path;

use crate::report::DataTable;

use super::file::{OutputFile, write_file};

/// What a table is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FileKind {
    Csv,
    Parquet,
}

impl FileKind {
    /// Parquet where the name ends so, else CSV.
    pub(crate) fn of(path: &Path) -> Self {
        let ending = path.extension().unwrap_or_default();
        let parquet = ["parquet", "pq"].iter().any(|name| ending.eq_ignore_ascii_case(name));
        if parquet { Self::Parquet } else { Self::Csv }
    }
}

/// Writes a table as Parquet.
#[cfg(feature = "parquet")]
pub(crate) fn write_parquet(table: &DataTable, file: &mut OutputFile) -> anyhow::Result<()> {
    Ok(table.write_parquet(file)?)
}

#[cfg(not(feature = "parquet"))]
pub(crate) fn write_parquet(_: &DataTable, _: &mut OutputFile) -> anyhow::Result<()> {
    anyhow::bail!("Parquet is not in this build of tauscope")
}

/// Writes a table as what its name says.
pub(crate) fn write_table(table: &DataTable, path: &Path) -> anyhow::Result<()> {
    write_file(path, |file| match FileKind::of(path) {
        FileKind::Csv => Ok(table.write_csv(file)?),
        FileKind::Parquet => write_parquet(table, file),
    })
}
