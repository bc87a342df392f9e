//! How the residual is correlated with itself and with the input, lag by lag.

use super::chunk::Chunks;
use super::error::RecordError;
use super::layers::Layers;
use super::panels::{self, Placed};
use super::paths;
use crate::figure::Role;
use crate::figure::correlogram::panels;
use crate::report::ComparedJoint;

/// Draws the correlations of `models`: a curve and a band per model.
pub(super) fn add(chunks: &mut Chunks, models: &[&ComparedJoint<'_>]) -> Result<(), RecordError> {
    let models = models.iter().enumerate();
    let models: Vec<_> = models.map(|(n, one)| (Role::of_revision(n), one.comparison)).collect();
    let mut left = -505.0;
    let placed = panels(&models).map(|panel| {
        left += 615.0;
        Placed::new(panel, (left, left + 490.0), 46.0..=324.0)
    });
    panels::add(&mut Layers::fixed(chunks, paths::CORRELATION), [placed.into()])
}
