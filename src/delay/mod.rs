//! The delay of every input step of one joint.
//!
//! Algorithm 1 of Albrecht and Taylor: around each input step the output is cut into a
//! segment, every pair of regression lines through it is a candidate, the pair with the
//! least squared error wins, and six conditions decide whether its breakpoint counts.
//!
//! - [`steps`](InputStep): where the input changes
//! - [`Segment`]: which samples belong to a step
//! - [`Candidates`]: every pair of lines, with its squared error
//! - [`Check`]: the conditions, with the numbers compared
//! - [`estimate`]: all of it, in the order of the steps
//! - [`DelayProfile`]: the delay of every sample
//! - [`AgainstState`]: what the delay may depend on
//!
//! Sample numbers are the paper's: counted from 1 within the trial.

mod against;
mod condition;
mod estimate;
mod line;
mod profile;
mod search;
mod segment;
mod steps;

pub use against::{AgainstState, Correlation, Direction, StepState};
pub use condition::{Check, Condition, Outcome};
pub use estimate::{
    Breakpoint, Decision, EstimateError, Settings, SettingsError, TrialEstimate, Verdict, estimate,
};
pub use line::Line;
pub use profile::{DelayProfile, Interpolation};
pub use search::{Candidate, Candidates};
pub use segment::Segment;
pub use steps::{InputStep, input_steps};
