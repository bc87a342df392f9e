//! What a program reads: input, expected outputs and their difference, sample by sample.

use rerun::components::InterpolationMode;
use rerun::{EntityPath, SeriesLines};

use super::expected::{Expectation, Preview};
use crate::recording::chunk::{Chunks, line};
use crate::recording::error::RecordError;
use crate::recording::palette::{self, dimmed};
use crate::recording::paths::{self, at, child};
use crate::recording::signals::known;
use crate::wording::bracketed;

/// Adds all signals below `root`.
pub(super) fn add(chunks: &mut Chunks, preview: &Preview<'_>) -> Result<(), RecordError> {
    let mut add = |entity: EntityPath, style: SeriesLines, values: &[f64]| {
        let style = match style.interpolation_mode {
            Some(_) => style,
            None => style.with_interpolation_mode(InterpolationMode::Linear),
        };
        chunks.series(entity, &style, (preview.samples(values.len()), known(values)))
    };
    let rig = &preview.joint.rig;
    let input = line(bracketed("input", rig.input_unit.as_deref()), palette::INPUT, 1.5);
    let input = input.with_interpolation_mode(InterpolationMode::StepAfter);
    add(paths::INPUT.into(), input, &preview.joint.schedule.input())?;
    let unit = bracketed("", rig.output_unit.as_deref());
    for Expectation { name, prediction, rgb } in &preview.expected {
        let output = child(paths::EXPECTED, name);
        for (part, sign) in [(paths::LOW, -1.0), (paths::HIGH, 1.0)] {
            let both = prediction.output.iter().zip(&prediction.margin);
            let edge: Vec<f64> = both.map(|(output, margin)| output + sign * margin).collect();
            let style = line(format!("{name}, {part}{unit}"), dimmed(*rgb), 1.0);
            add(at(&output, part), style, &edge)?;
        }
        let style = line(format!("{name}{unit}"), *rgb, 1.5);
        add(at(&output, paths::OUTPUT), style, &prediction.output)?;
    }
    if let Some((low, high)) = rig.range {
        let range = EntityPath::from(paths::RANGE);
        for (part, value) in [(paths::LOW, low), (paths::HIGH, high)] {
            let all = vec![value; preview.joint.schedule.samples()];
            let style = line(format!("range, {part}{unit}"), palette::REJECTED, 1.5);
            add(at(&range, part), style, &all)?;
        }
    }
    let Some(apart) = &preview.apart else { return Ok(()) };
    let style = line("difference over noise", palette::ERROR, 1.5);
    add(paths::APART.into(), style, &apart.over_noise)
}
