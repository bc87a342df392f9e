//! Tables as CSV or Parquet, by the ending of the file's name.

use std::io::Write;
use std::path::Path;

use crate::experiment::is_control;
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

/// Whether texts in CSV are written so that a spreadsheet program computes nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum CsvText {
    /// As it is: what reads the file again finds the names of the log.
    #[default]
    Plain,
    /// With an apostrophe before what such a program would take for a formula.
    Safe,
}

impl From<bool> for CsvText {
    fn from(is_safe: bool) -> Self {
        if is_safe { Self::Safe } else { Self::Plain }
    }
}

/// Lets `write` write CSV to `file`.
pub(crate) fn write_csv(
    file: &mut OutputFile,
    text: CsvText,
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    if text == CsvText::Plain {
        return write(file);
    }
    let mut table = Vec::new();
    write(&mut table)?;
    Ok(copy_safe(&table, file)?)
}

/// Copies CSV, texts that begin like a formula with an apostrophe before them, and without control
/// characters, which names of files may have.
fn copy_safe(table: &[u8], out: impl Write) -> csv::Result<()> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(table);
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(out);
    for record in reader.byte_records() {
        for cell in &record? {
            writer.write_field(safe(&String::from_utf8_lossy(cell)))?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    Ok(writer.flush()?)
}

/// A cell that no spreadsheet program takes for a formula, whatever mark parts cells for it: where it is
/// the semicolon, a semicolon within a name begins a cell.
fn safe(cell: &str) -> String {
    if cell.parse::<f64>().is_ok() {
        return cell.to_owned();
    }
    let mut is_first = true;
    let mut safe = String::new();
    for letter in cell.chars() {
        if is_first && "=+-@\t\r".contains(letter) {
            safe.push('\'');
        }
        // What is not seen does not hide what follows it.
        is_first = letter == ';' || is_first && (letter == ' ' || letter == '\u{feff}');
        safe.push(if is_control(letter) { '\u{fffd}' } else { letter });
    }
    safe
}

/// Writes a table as what its name says.
pub(crate) fn write_table(table: &DataTable, path: &Path, text: CsvText) -> anyhow::Result<()> {
    write_file(path, |file| match FileKind::of(path) {
        FileKind::Csv => write_csv(file, text, |out| Ok(table.write_csv(out)?)),
        FileKind::Parquet => write_parquet(table, file),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_begins_like_a_formula_is_text_and_numbers_stay() {
        let table = "joint,delay\n\"=HYPERLINK(\"\"x\"\",1)\",-1.5e-3\n@a,+3\n-a,\nplain,4\n";
        let mut safe = Vec::new();
        copy_safe(table.as_bytes(), &mut safe).unwrap();
        let expected = "joint,delay\n\"'=HYPERLINK(\"\"x\"\",1)\",-1.5e-3\n'@a,+3\n'-a,\nplain,4\n";
        assert_eq!(String::from_utf8(safe).unwrap(), expected);
    }

    #[test]
    fn a_semicolon_in_a_name_begins_no_formula() {
        assert_eq!(safe("x;=cmd|' /C calc'!A0;y"), "x;'=cmd|' /C calc'!A0;y");
        assert_eq!(safe("x; @a;b=c"), "x; '@a;b=c");
        assert_eq!(safe("\u{feff}=1+1"), "\u{feff}'=1+1");
    }
}
