//! tauscope
pub mod batch;
pub mod delay;
pub mod experiment;
pub mod filter;
#[cfg(feature = "rrd")]
pub mod recording;
pub mod report;
pub mod synthetic;
pub mod units;
