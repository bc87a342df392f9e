//! Recordings shown while they are made, by the Rerun viewer.

mod program;
#[cfg(feature = "rrd")]
mod start;
mod stream;

pub(crate) use program::{DECLINED, IMPORTER, NEWEST, VERSION, asked_about, installed, on_path};
pub(crate) use stream::{Stream, StreamArgs};
