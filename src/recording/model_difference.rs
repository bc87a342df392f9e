//! Where one model is better than another along the record.

use rerun::{EntityPath, SeriesLines};

use super::chunk::Chunks;
use super::error::RecordError;
use super::layout::{JointLayout, TrialLayout};
use super::model_signal::signal;
use super::palette::{self, color};
use super::paths::{self, at, child};
use crate::report::ComparedJoint;

/// Adds the sum so far of what each further model's squared residual is larger than the first
/// one's: it rises where the first model is better.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    layout: &JointLayout<'_>,
    models: &[&ComparedJoint<'_>],
) -> Result<(), RecordError> {
    let Some((first, others)) = models.split_first() else { return Ok(()) };
    for (other, rgb) in others.iter().zip(palette::models().skip(1)) {
        let mut sum = 0.0;
        let mut all: Vec<(usize, Vec<f64>)> = Vec::new();
        for trial in &layout.trials {
            let residuals = |model: &ComparedJoint<'_>| {
                let all = &model.comparison.fit.evaluation.residuals;
                all.get(trial.index).cloned().unwrap_or_default()
            };
            let pairs = residuals(other).into_iter().zip(residuals(first));
            let sums = pairs.map(|(other, own)| {
                sum += other * other - own * own;
                sum
            });
            all.push((trial.index, sums.collect()));
        }
        let of_trial = |trial: &TrialLayout<'_>| {
            let found = all.iter().find(|(index, _)| *index == trial.index);
            found.map(|(_, sums)| sums.clone()).unwrap_or_default()
        };
        let entity = child(&at(root, paths::MODEL_DIFFERENCE), other.model);
        let name = format!("{} − {}", other.model, first.model);
        let style = SeriesLines::new().with_names([name]).with_colors([color(rgb)]);
        chunks.push_static(entity.clone(), &style.with_widths([1.5]))?;
        signal(chunks, entity, layout, of_trial)?;
    }
    Ok(())
}
