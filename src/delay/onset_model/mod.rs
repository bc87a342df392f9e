//! One onset model: a window, a response, a profile.
//!
//! A step of the input changes the speed of a joint, or the level to which its output settles,
//! after a dead time of its own. What follows is a response that all steps of the joint share: its
//! [`Shape`](shape::Shape), with one or two parameters. In the window of a step everything but the
//! onset and these parameters is linear; the onset is a profile of the squared error, which may have
//! its least before the step, and its interval is where the profile is not plainly worse.
//!
//! - [`dynamics`]: a response as a linear state, and the error of a window at any onset
//! - [`shape`]: the responses, one entry each; [`response`]: their linear states
//! - [`windows`]: the windows of a joint's steps, and one pass over them
//! - [`alignment`]: about which delay all onsets have
//! - [`search`]: the shape and its parameters, by evidence over all steps
//! - [`pole_more`]: where the search for a shape with a pole more begins
//! - [`reaction`]: whether anything happened in one window
//! - [`from_rest`]: the onset of a joint that gathers speed from rest
//! - [`follows`]: whether the output follows this input at all
//! - [`uncertainty`]: what an interval is made of
//! - [`excerpt`]: what of a record is searched
//! - [`kinds`]: shapes by kind of step, where one for all fails
//! - [`model`]: all of it

mod alignment;
mod dynamics;
mod excerpt;
mod follows;
mod from_rest;
mod kinds;
mod model;
mod pole_more;
mod reaction;
mod residual;
mod response;
mod search;
mod shape;
mod uncertainty;
mod windows;

pub(super) use from_rest::{FromRest, gradual_onset};
pub(super) use reaction::{Bend, Bends};
pub(super) use residual::memory;
pub(super) use shape::Family;

pub use model::{Obstacle, OnsetModel, ResponseOfKind, StepOnset};
