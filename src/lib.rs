#![doc = include_str!("../README.md")]
//!
//! ## Where things are
//!
//! Each module uses only those above it; `tests/house/layering.rs` checks it.
//!
//! - [`units`]: scalars that are valid once they exist
//! - [`numerics`]: statistics, filters, projections, noise models
//! - [`experiment`]: logs, joints, trials, and the formats they are read from
//! - [`synthetic`]: logs of joints with known delays and effects, made by plants of their own: the
//!   crate `crates/synthetic`, which uses nothing of this one
//! - [`effect`]: the catalogue of physical effects
//! - [`delay`]: the delay of every step of one joint
//! - [`model`]: the grey-box model of a joint, its simulation and its file
//! - [`export`]: models as source code and FMUs
//! - [`fit`]: models fitted to measurements
//! - [`diagnosis`]: how good a model is, and where it fails
//! - [`explain`]: which physical effect a model lacks
//! - [`design`]: the next experiment
//! - [`study`]: all joints of an experiment
//! - [`batch`]: pieces of work on many threads
//! - [`wording`]: what statuses, units, probabilities and numbers are called
//! - `figure`: what is drawn, as data
//! - [`report`]: results as text, CSV and JSON, and as a page with figures
//! - `recording`: results as a Rerun recording (feature `rrd`)
//! - `cli`: arguments, printing and exit status
//!
//! ## Where to add what
//!
//! | what | one file | one line, beside its `mod` |
//! |---|---|---|
//! | an effect | `src/effect/` | `src/effect/registry.rs`; its independent twin for tests: a row in the file of its stage in `crates/synthetic/src/effects/`, and one in `registry.rs` there; a row in `docs/simulating.md`; `tests/models/hidden_effects.rs`, `tests/models/export_models.rs` and `tests/commands/documents.rs` name what is missing |
//! | a method that finds delays | `src/delay/method/` | `src/delay/method/registry.rs`; a row in `docs/methods.md` |
//! | a format of logs | `src/experiment/format/` | `src/experiment/format/registry.rs`; where it needs a library, a feature in `Cargo.toml`; a section in `docs/formats.md`; a target in `fuzz/targets/` (its name in `fuzz/Cargo.toml`, `fuzz/run`, `tests/reading/replay.rs`) |
//! | a field of a command's JSON | the file of the result in `src/report/`; what models have in common in `compare.rs` | |
//! | a mark in a view of a recording | `src/recording/segment_view.rs` and its neighbours draw; what is shared with the report in `src/figure/` | its path in `src/recording/paths.rs`; a new pane in `src/recording/views.rs` |
//! | a language for exported models | `src/export/`, with its template | `src/export/registry.rs` |
//! | a command | `src/cli/command/` | `src/cli/program.rs` |
//!
//! `tests/compare_builds.py OLD NEW` shows what a change makes different in what the program says.

pub mod batch;
#[doc(hidden)]
pub mod cli;
pub mod delay;
pub mod design;
pub mod diagnosis;
pub mod effect;
pub mod experiment;
pub mod explain;
pub mod export;
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

pub use delay::{Method, Settings, estimate};
pub use effect::Effect;
pub use experiment::{Experiment, Joint, Trial};
pub use model::JointModel;
