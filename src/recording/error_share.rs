//! Where the error arises: its share in each part of each feature, beside the share of time.

use super::canvas::TAB;
use super::chunk::Chunks;
use super::error::RecordError;
use super::layers::Layers;
use super::panels::{self, Placed};
use super::paths;
use crate::diagnosis::Comparison;
use crate::experiment::Joint;
use crate::figure::error_share::panels;
use crate::figure::{Mark, Panel, Role};
use crate::report::ComparedJoint;

/// Plots in a row.
const COLUMNS: usize = 4;

/// Draws the regions of `models` below `root`.
pub(super) fn add(chunks: &mut Chunks, models: &[&ComparedJoint<'_>]) -> Result<(), RecordError> {
    let Some(first) = models.first() else { return Ok(()) };
    let models = models.iter().enumerate();
    let models: Vec<_> = models.map(|(n, one)| (Role::of_revision(n), one.comparison)).collect();
    let placed = placed(first.joint, &models);
    panels::add(&mut Layers::fixed(chunks, paths::ERROR_SHARE), [placed])
}

/// Each panel in one of eight places on the sheet, below its quantity: the name of the view says what
/// its bars and lines are, for which there is no room above each.
pub(super) fn placed(joint: &Joint, models: &[(Role, &Comparison)]) -> Vec<Placed> {
    let place = |(place, mut panel): (usize, Panel)| {
        panel.y.name.clear();
        panel.marks.iter_mut().for_each(Mark::unname);
        let rows = if place < COLUMNS { 46.0..=140.0 } else { 232.0..=326.0 };
        let width = TAB.0 / COLUMNS as f32;
        let left = (place % COLUMNS) as f32 * width;
        Placed::new(panel, (left + 95.0, left + width - 20.0), rows)
    };
    panels(joint, models).into_iter().enumerate().map(place).collect()
}
