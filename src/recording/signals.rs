//! Input, output, delay and covariates, sample by sample.

use rerun::{EntityPath, Scalars, SeriesLines, components::InterpolationMode};

use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::layout::{JointLayout, TrialLayout};
use super::palette::{self, Rgb, color};
use super::paths::{self, at, child};
use crate::experiment::Joint;
use crate::wording::bracketed;

/// Adds all signals of `joint` below the entity `root`.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    joint: &Joint,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    let unit = |unit: &Option<String>| bracketed("", unit.as_deref());
    let (input, output) = (unit(&joint.input_unit), unit(&joint.output_unit));
    // Input and delay are held between samples; what was measured is drawn from point to point.
    let entity = at(root, paths::INPUT);
    style(
        chunks,
        &entity,
        format!("input{input}"),
        palette::INPUT,
        1.5,
        InterpolationMode::StepAfter,
    )?;
    add_signal(chunks, entity, layout, |trial| trial.trial.input())?;
    let entity = at(root, paths::OUTPUT_RAW);
    style(
        chunks,
        &entity,
        format!("measured{output}"),
        palette::RAW,
        1.0,
        InterpolationMode::Linear,
    )?;
    add_signal(chunks, entity, layout, |trial| trial.trial.output())?;
    let entity = at(root, paths::OUTPUT_SMOOTHED);
    style(
        chunks,
        &entity,
        format!("smoothed{output}"),
        palette::SMOOTHED,
        1.5,
        InterpolationMode::Linear,
    )?;
    add_signal(chunks, entity, layout, TrialLayout::output)?;
    for (index, signal) in joint.covariates.iter().enumerate() {
        let entity = child(&at(root, paths::COVARIATE), &signal.name);
        let name = format!("{}{}", signal.name, unit(&signal.unit));
        chunks.push_static(entity.clone(), &SeriesLines::new().with_names([name]))?;
        let values = |trial: &TrialLayout<'_>| {
            let values = trial.trial.covariates().get(index);
            values.into_iter().flatten().map(|v| (!v.is_nan()).then_some(*v)).collect()
        };
        add_sparse(chunks, entity, layout, values)?;
    }
    let entity = at(root, paths::TAU);
    style(
        chunks,
        &entity,
        "delay τ [samples]".to_owned(),
        palette::ACCEPTED,
        1.5,
        InterpolationMode::StepAfter,
    )?;
    add_sparse(chunks, entity, layout, |trial| trial.estimate.profile.iter().collect())
}

fn style(
    chunks: &mut Chunks,
    entity: &EntityPath,
    name: String,
    rgb: Rgb,
    width: f32,
    mode: InterpolationMode,
) -> Result<(), RecordError> {
    let lines = SeriesLines::new().with_names([name]).with_colors([color(rgb)]);
    let lines = lines.with_widths([width]);
    chunks.push_static(entity.clone(), &lines.with_interpolation_mode(mode))
}

/// A signal with a value at every sample, and an empty row behind each trial.
fn add_signal<'a>(
    chunks: &mut Chunks,
    entity: EntityPath,
    layout: &JointLayout<'a>,
    values: impl Fn(&TrialLayout<'a>) -> &'a [f64],
) -> Result<(), RecordError> {
    let mut index = Index::default();
    let mut all = Vec::new();
    let mut lengths = Vec::new();
    for trial in &layout.trials {
        let values = values(trial);
        index.extend(trial.moments(values.len() + 1));
        all.extend_from_slice(values);
        lengths.extend(std::iter::repeat_n(1, values.len()));
        lengths.push(0);
    }
    chunks.push(entity, index.without_segment(), Scalars::new(all).columns(lengths)?)
}

/// A signal that is not there at every sample: no row then, and one empty row where it
/// stops, so that no line is drawn over the gap.
fn add_sparse<'a>(
    chunks: &mut Chunks,
    entity: EntityPath,
    layout: &JointLayout<'a>,
    values: impl Fn(&TrialLayout<'a>) -> Vec<Option<f64>>,
) -> Result<(), RecordError> {
    let mut index = Index::default();
    let mut all = Vec::new();
    let mut lengths = Vec::new();
    for trial in &layout.trials {
        let mut there = false;
        let values = values(trial).into_iter().chain([None]);
        for (moment, value) in trial.moments(trial.trial.len() + 1).zip(values) {
            if value.is_some() || there {
                index.extend([moment]);
                lengths.push(usize::from(value.is_some()));
                all.extend(value);
            }
            there = value.is_some();
        }
    }
    chunks.push(entity, index.without_segment(), Scalars::new(all).columns(lengths)?)
}
