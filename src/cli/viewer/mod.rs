//! Recordings shown while they are made, by the Rerun viewer.

mod importer;
mod program;
#[cfg(feature = "rrd")]
mod start;
mod stream;

pub(crate) use importer::{DECLINED, IMPORTER, asked_about, installed};
pub(crate) use program::{NEWEST, VERSION, on_path};
pub(crate) use stream::{Stream, StreamArgs};
