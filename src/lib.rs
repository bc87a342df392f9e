#![doc = include_str!("../README.md")]
//!
//! ## Where things are
//!
//! Each module uses only those above it.
//!
//! - [`units`]: scalars that are valid once they exist
//! - [`numerics`]: statistics, filters and least squares
//! - [`effect`]: the catalogue of physical effects
//! - [`experiment`]: logs, joints, trials
//! - [`delay`]: the delay of every step of one joint
//! - [`model`]: the grey-box model of a joint, and its simulation
//! - [`synthetic`]: logs of joints with known delays and effects
//! - [`fit`]: models fitted to measurements
//! - [`diagnosis`]: how good a model is, and where it fails
//! - [`explain`]: which physical effect a model lacks
//! - [`design`]: the next experiment
//! - [`study`]: all joints of an experiment
//! - [`batch`]: pieces of work on many threads
//! - [`wording`]: what statuses, units, probabilities and numbers are called
//! - [`report`]: results as text, CSV and JSON, and as a page with figures
//! - `recording`: results as a Rerun recording (feature `rrd`)

pub mod batch;
#[doc(hidden)]
pub mod cli;
pub mod delay;
pub mod design;
pub mod diagnosis;
pub mod effect;
pub mod experiment;
pub mod explain;
mod figure;
pub mod fit;
pub mod model;
pub mod numerics;
#[cfg(feature = "rrd")]
pub mod recording;
pub mod report;
pub mod study;
pub mod synthetic;
pub mod units;
pub mod wording;
