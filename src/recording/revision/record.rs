//! The whole record: what was measured, what a revision simulates, and the residual.

use std::ops::RangeInclusive;

use crate::figure::Role;
use crate::recording::canvas::Layers;
use crate::recording::error::RecordError;
use crate::recording::layout::JointLayout;
use crate::recording::panels::{self, Placed};
use crate::report::ComparedJoint;
use crate::report::page::simulated::{simulated_panels, worst_panel};
use crate::report::page::timeline::named;

/// Width and height of the sheet, and of that with ladder, what the model misses and ranking.
pub(in crate::recording) const SIZE: (f32, f32) = (1860.0, 470.0);

/// Top and bottom of the plots of the output: above them their titles.
const ROWS: RangeInclusive<f32> = 56.0..=198.0;

/// Adds the drawings of models, which follow one another on the timeline of `rows`.
pub(in crate::recording) fn add(
    rows: &mut Layers<'_>,
    layout: &JointLayout<'_>,
    models: &[ComparedJoint<'_>],
) -> Result<(), RecordError> {
    let timeline = layout.timeline();
    let drawn = |(number, compared): (usize, &ComparedJoint<'_>)| {
        let role = Role::of_revision(number);
        let fails = named(compared.joint, compared.comparison);
        let [output, residual] = simulated_panels(compared, role, &timeline, fails);
        let close_up = worst_panel(compared, role, &timeline);
        let end = SIZE.0 - 15.0;
        let right = if close_up.is_some() { 1060.0 } else { end };
        let close_up = close_up.map(|panel| Placed::new(panel, (1180.0, end), ROWS));
        let whole = [
            Placed::new(output, (120.0, right), ROWS),
            Placed::new(residual, (120.0, end), 284.0..=426.0),
        ];
        whole.into_iter().chain(close_up).collect()
    };
    panels::add(rows, models.iter().enumerate().map(drawn))
}
