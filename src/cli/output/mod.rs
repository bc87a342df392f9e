//! What is written to files: whole or not at all, tables by the name's ending, recordings.

mod file;
mod limit;
mod recording;
mod table;

pub(crate) use file::{
    OutputFile, check_outputs, check_places, check_recorded, filled_file, target_of, write_file,
};
pub(crate) use limit::meet_file_limits;
#[cfg(not(feature = "rrd"))]
pub(crate) use recording::left_out;
pub(crate) use recording::{
    Contents, Detail, PreviewContents, SweepContents, check_beside_parts, check_recordings,
};
pub(crate) use table::{CsvText, FileKind, check_tables, write_csv, write_parquet, write_table};
