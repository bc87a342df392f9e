//! The formats of logs: one file or folder each, and one entry in the registry.
//!
//! A new format is a file with `open`, which gives an
//! [`OpenTable`](super::table::OpenTable), and an entry in `registry.rs`: its name, the
//! endings of its files, its first bytes, its feature and `open`.

mod cell;
mod csv;
mod date;
mod fence;
mod first_bytes;
mod line;
#[cfg(feature = "mat")]
mod mat;
#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "parquet")]
mod parquet;
mod registry;
mod spelling;
mod text;
#[cfg(feature = "xlsx")]
mod xlsx;

pub(super) use date::date_of_seconds;
pub(super) use registry::{endings, open};
pub(crate) use registry::{format_names, is_named_like_a_log, is_text};
pub(super) use text::text_of;
