#![doc = include_str!("../README.md")]
//!
//! ## Where things are
//!
//! Each module uses only those above it.
//!
//! - [`units`]: scalars that are valid once they exist
//! - [`filter`]: the zero-phase low-pass
//! - [`experiment`]: logs, joints, trials
//! - [`delay`]: the delay of every step of one joint
//! - [`synthetic`]: logs of joints with known delays
//! - [`batch`]: all joints in parallel
//! - [`report`]: results as text, CSV and JSON
//! - `recording`: results as a Rerun recording (feature `rrd`)

pub mod batch;
pub mod delay;
pub mod experiment;
pub mod filter;
#[cfg(feature = "rrd")]
pub mod recording;
pub mod report;
pub mod synthetic;
pub mod units;
