//! The grey-box model of a joint, and its simulation.
//!
//! A joint integrates: `dy/dt = gain · s`, where `s` is the input after its delay and
//! after the effects of the catalogue. Models are plain values; adding an effect makes a
//! new one.
//!
//! - [`JointModel`]: structure, effects, parameters
//! - [`ModelFile`]: models in TOML, as users write them, and their revisions
//! - [`simulate`]: what the model says the output is
//! - [`simulate_input`]: that for an input of one trial, from an output to start at
//! - [`Arrivals`]: when each level of the input begins to act

mod arrivals;
mod delay_law;
mod file;
mod joint_model;
mod motion;
mod neutral;
mod simulate;
mod start;

pub use arrivals::{Arrival, Arrivals, Commands};
pub use file::{Fitted, FittedParameter, LogHash, ModelError, ModelFile, Revision, RevisionErrors};
pub use joint_model::{Component, JointModel, Value};
pub use motion::{Restart, Signals, Surroundings};
pub(crate) use neutral::coded_neutral;
pub(crate) use simulate::{BESIDE, Driven, outputs_together, simulate_together};
pub use simulate::{Simulated, simulate, simulate_input};
pub use start::integrators;
