//! What a program reads: input, expected outputs and their difference, sample by sample.

use rerun::components::InterpolationMode;
use rerun::{EntityPath, Scalars, SeriesLines};

use super::expected::{Preview, unit_of};
use crate::recording::chunk::Chunks;
use crate::recording::error::RecordError;
use crate::recording::palette::{self, Rgb, color, dimmed};
use crate::recording::paths::{at, child, preview as preview_paths};

/// How a signal is drawn in a plot over time.
struct Style {
    name: String,
    rgb: Rgb,
    width: f32,
    mode: InterpolationMode,
}

impl Style {
    fn line(name: String, rgb: Rgb) -> Self {
        Self { name, rgb, width: 1.5, mode: InterpolationMode::Linear }
    }
}

/// Adds all signals below `root`.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    preview: &Preview<'_>,
) -> Result<(), RecordError> {
    let rig = &preview.joint.rig;
    let input = format!("input{}", unit_of(rig.input_unit.as_deref()));
    let held = Style { mode: InterpolationMode::StepAfter, ..Style::line(input, palette::INPUT) };
    signal(chunks, preview, at(root, preview_paths::INPUT), held, &preview.joint.schedule.input())?;
    let unit = unit_of(rig.output_unit.as_deref());
    for expected in &preview.expected {
        let name = expected.name;
        let output = child(&at(root, preview_paths::EXPECTED), name);
        let prediction = expected.prediction;
        let with = |sign: f64| -> Vec<f64> {
            let both = prediction.output.iter().zip(&prediction.margin);
            both.map(|(output, margin)| output + sign * margin).collect()
        };
        for (part, sign) in [(preview_paths::LOW, -1.0), (preview_paths::HIGH, 1.0)] {
            let edge = Style::line(format!("{name}, {part}{unit}"), dimmed(expected.rgb));
            let edge = Style { width: 1.0, ..edge };
            signal(chunks, preview, at(&output, part), edge, &with(sign))?;
        }
        let line = Style::line(format!("{name}{unit}"), expected.rgb);
        signal(chunks, preview, at(&output, preview_paths::OUTPUT), line, &prediction.output)?;
    }
    if let Some((low, high)) = rig.range {
        let range = at(root, preview_paths::RANGE);
        for (part, value) in [(preview_paths::LOW, low), (preview_paths::HIGH, high)] {
            let limit = Style::line(format!("range, {part}{unit}"), palette::REJECTED);
            let all = vec![value; preview.joint.schedule.samples()];
            signal(chunks, preview, at(&range, part), limit, &all)?;
        }
    }
    let Some(apart) = &preview.apart else { return Ok(()) };
    let line = Style::line("difference over noise".to_owned(), palette::ERROR);
    signal(chunks, preview, at(root, preview_paths::APART), line, &apart.over_noise)
}

fn signal(
    chunks: &mut Chunks,
    preview: &Preview<'_>,
    entity: EntityPath,
    Style { name, rgb, width, mode }: Style,
    values: &[f64],
) -> Result<(), RecordError> {
    let style = SeriesLines::new().with_names([name]).with_colors([color(rgb)]);
    let style = style.with_widths([width]).with_interpolation_mode(mode);
    chunks.push_static(entity.clone(), &style)?;
    let scalars = Scalars::new(values.iter().copied());
    chunks.push(entity, preview.samples(values.len()), scalars.columns_of_unit_batches()?)
}
