//! What is to be separated, on which joint, within which limits; and what was found out on the
//! way.

use super::limits::Limits;
use super::predict::TestRig;
use super::result::Design;
use super::suspects::Suspects;
use crate::model::JointModel;

/// What is to be separated, on which joint, and within which limits.
#[derive(Clone, Copy)]
pub(super) struct Problem<'a> {
    pub(super) suspects: &'a Suspects,
    pub(super) rig: &'a TestRig,
    pub(super) limits: Limits,
}

/// What inputs that did not pass have shown.
#[derive(Default)]
pub(super) struct Findings {
    /// Numbers of each suspect at which a rehearsal failed.
    pub(super) hard: [Vec<JointModel>; 2],
    /// Inputs that were rehearsed.
    pub(super) attempts: usize,
    /// The one whose rehearsals went best.
    pub(super) runner_up: Option<Design>,
    /// The best power.
    pub(super) power: f64,
    /// The best power of each suspect by itself.
    pub(super) powers: [f64; 2],
}
