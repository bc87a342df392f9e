//! Test data whose truth is known: hydraulic joints driven by steps of voltage.
//!
//! A [`PlantSpec`], usually a TOML file, names the joints and what drives them;
//! [`simulate`] makes their logs and states the delay of each step; [`write_log`] and
//! [`write_truth`] make files of both. A [`scenario`] is a plant with something to find.
//! Per joint,
//!
//! ```text
//! input → delay → dead band → saturation → gain → lag → ringing → ∫ → angle
//!                                                     angle + noise → encoder → output
//! ```
//!
//! Where a joint hides [`effects`], those of the valve come before the dead band, those of
//! the dynamics before the gain, those of the load before the integral, and stops, play
//! and sensor after it; the joint is then one system of differential equations.
//!
//! The level of step `i` acts from `t_i + τ_i` on, `t_i` being the time of the sample
//! that first shows it and `τ_i` its delay; sample `k` is at `(k - 1) sample_period_s`.
//! A later step that acts before an earlier one wins: the earlier level never comes
//! back.
//!
//! The motion is integrated in time steps finer than a sample, split where a level
//! begins to act: without lag and ringing the angle is exact, its kinks at
//! `t_i + τ_i`. Nothing here is used by a model that is fitted, and nothing here
//! knows how a delay is estimated.
//!
//! A joint with a [`CylinderSpec`] moves by the physics of valve, oil and linkage instead:
//! see `docs/simulating.md`.
//!
//! The random numbers of a joint come from the seed and its place in the file, apart
//! for input, delays and noise: other noise leaves the input as it was.
//!
//! # Examples
//! ```
//! use tauscope_synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};
//!
//! let input = InputSpec::Levels { levels: vec![-1.0, 1.0], hold_s: [1.0, 2.0] };
//! let delay = DelayLaw::Uniform { min: 0.05, max: 0.3 };
//! let elbow = JointSpec { noise: 0.05, ..JointSpec::new("elbow", input, delay) };
//! let made = simulate(&PlantSpec::new(1, 60.0, vec![elbow]))?;
//! assert!(made.truth.iter().all(|step| (0.05..0.3).contains(&step.delay_s)));
//! # Ok::<(), tauscope_synthetic::PlantError>(())
//! ```

mod check;
mod clock;
mod cylinder;
mod delay_law;
mod drive;
mod driver;
pub mod effects;
mod error;
mod input;
mod motion;
mod random;
mod rig;
pub mod scenario;
mod sensor;
mod simulate;
mod spec;
mod statics;
mod truth;
mod write;

pub use cylinder::{CylinderSpec, Part};
pub use delay_law::DelayLaw;
pub use error::{Place, PlantError};
pub use input::InputSpec;
pub use simulate::{Recorded, Simulated, simulate};
pub use spec::{JointSpec, PlantSpec, Ringing, SCHEMA, Spikes};
pub use truth::{StepTruth, TRIAL};
pub use write::{write_log, write_truth};
