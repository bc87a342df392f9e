//! What a reviewer sees: recordings read back, the report, pictures in the viewer.
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

mod decisions;
mod delay;
#[path = "../support/desk.rs"]
#[cfg_attr(
    feature = "rrd",
    expect(dead_code, reason = "recordings of models are read otherwise here")
)]
mod desk;
mod differences;
mod importer;
mod live;
mod models;
mod pictures;
#[cfg(feature = "rrd")]
#[path = "../support/read_back.rs"]
mod read_back;
#[cfg(feature = "rrd")]
#[path = "../support/recorded.rs"]
mod recorded;
mod report;
mod reviewing;
mod sweep;
