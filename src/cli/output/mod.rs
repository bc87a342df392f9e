//! What is written to files: whole or not at all, tables by the name's ending, recordings.

mod file;
mod outputs;
mod recording;

pub(crate) use file::{
    FileKind, OutputFile, filled_file, meet_file_limits, target_of, write_bytes, write_file,
    write_parquet, write_table,
};
pub(crate) use outputs::{OutputKind, Outputs};
#[cfg(not(feature = "rrd"))]
pub(crate) use recording::left_out;
pub(crate) use recording::{Detail, Recorded, of_delays};
