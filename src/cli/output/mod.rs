//! What is written to files: whole or not at all, tables by the name's ending, recordings.

mod file;
mod limit;
mod outputs;
mod recording;
mod table;

pub(crate) use file::{OutputFile, filled_file, target_of, write_bytes, write_file};
pub(crate) use limit::meet_file_limits;
pub(crate) use outputs::{OutputKind, Outputs};
#[cfg(not(feature = "rrd"))]
pub(crate) use recording::left_out;
pub(crate) use recording::{Detail, Recorded, of_delays};
pub(crate) use table::{FileKind, write_parquet, write_table};
