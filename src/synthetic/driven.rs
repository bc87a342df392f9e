//! What became of one joint that was driven.

use super::drive::Drive;

/// What became of one joint.
#[derive(Clone, Debug)]
pub(super) struct Driven {
    pub(super) drive: Drive,
    /// Change of speed that each step caused, in output units per second; none for one
    /// that was overtaken.
    pub(super) speed_changes: Vec<Option<f64>>,
    /// What an ideal sensor shows at each sample.
    pub(super) angles: Vec<f64>,
}

impl Driven {
    /// A joint that each step gives another steady speed.
    pub(super) fn steadily(drive: Drive, angles: Vec<f64>) -> Self {
        Self { speed_changes: drive.speed_changes(), drive, angles }
    }
}
