//! What a model has for every sample.

use rerun::{EntityPath, Scalars};

use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::layout::{JointLayout, TrialLayout};

/// Adds the values of each trial, and an empty row behind it.
pub(super) fn signal<'a>(
    chunks: &mut Chunks,
    entity: EntityPath,
    layout: &JointLayout<'a>,
    values: impl Fn(&TrialLayout<'a>) -> Vec<f64>,
) -> Result<(), RecordError> {
    let mut index = Index::default();
    let (mut all, mut lengths) = (Vec::new(), Vec::new());
    for trial in &layout.trials {
        let values = values(trial);
        index.extend(trial.moments(values.len() + 1));
        lengths.extend(std::iter::repeat_n(1, values.len()).chain([0]));
        all.extend(values);
    }
    chunks.push(entity, index.without_segment(), Scalars::new(all).columns(lengths)?)
}
