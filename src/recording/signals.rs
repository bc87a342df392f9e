//! Input, output, delay and covariates, sample by sample.

use rerun::{SeriesLines, components::InterpolationMode};

use super::chunk::{Chunks, line};
use super::error::RecordError;
use super::layout::{JointLayout, TrialLayout};
use super::palette::{self, Rgb};
use super::paths::{self, child};
use crate::wording::bracketed;

/// Adds all signals of `joint` below the entity `root`.
pub(super) fn add(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    type Values = fn(&TrialLayout<'_>) -> Vec<Option<f64>>;
    type Drawn = (&'static str, String, (Rgb, f32), InterpolationMode, Values);
    // Input and delay are held between samples; what was measured is drawn from point to point.
    let (held, drawn) = (InterpolationMode::StepAfter, InterpolationMode::Linear);
    let joint = layout.joint;
    let unit = |unit: &Option<String>| bracketed("", unit.as_deref());
    let (input, output) = (unit(&joint.input_unit), unit(&joint.output_unit));
    let signals: [Drawn; 4] = [
        (paths::INPUT, format!("input{input}"), (palette::INPUT, 1.5), held, |trial| {
            known(trial.trial.input())
        }),
        (paths::OUTPUT_RAW, format!("measured{output}"), (palette::RAW, 1.0), drawn, |trial| {
            trial.logged(trial.trial.output())
        }),
        (
            paths::OUTPUT_SMOOTHED,
            format!("smoothed{output}"),
            (palette::SMOOTHED, 1.5),
            drawn,
            |trial| known(trial.output()),
        ),
        (paths::TAU, "delay τ [samples]".to_owned(), (palette::ACCEPTED, 1.5), held, |trial| {
            trial.estimate.profile.iter().collect()
        }),
    ];
    for (path, name, (rgb, width), mode, values) in signals {
        let style = line(name, rgb, width).with_interpolation_mode(mode);
        chunks.series(path, &style, layout.series(values))?;
    }
    for (index, signal) in joint.covariates.iter().enumerate() {
        let entity = child(paths::COVARIATE, &signal.name);
        let style =
            SeriesLines::new().with_names([format!("{}{}", signal.name, unit(&signal.unit))]);
        let values = layout.series(|trial| {
            let values = trial.trial.covariates().get(index);
            values.into_iter().flatten().map(|v| (!v.is_nan()).then_some(*v)).collect()
        });
        chunks.series(entity, &style, values)?;
    }
    Ok(())
}

/// Values at every sample.
fn known(values: &[f64]) -> Vec<Option<f64>> {
    values.iter().copied().map(Some).collect()
}
