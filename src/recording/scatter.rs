//! The residual against what it may depend on: input, angle, speed, time since the step.

use rerun::datatypes::Vec2D;

use super::canvas::{Plot, SHEET, Span};
use super::chunk::Chunks;
use super::error::RecordError;
use super::layers::Layers;
use super::palette;
use super::paths::{self, of_model};
use super::sheet::Sheet;
use crate::numerics::quantile;
use crate::report::ComparedJoint;
use crate::wording::bracketed;

/// Width and height of the sheet: four plots side by side.
pub(super) const SIZE: (f32, f32) = (SHEET.0, 280.0);

/// Points that are drawn of each plot; more hide one another.
const POINTS: usize = 3000;

/// Bins of the curve through the points.
const BINS: usize = 24;

/// A quantity and the residual, sample by sample.
struct Pairs {
    name: String,
    x: Vec<f64>,
    residual: Vec<f64>,
}

/// Draws the residuals of `models` against four quantities below `root`; the points are
/// those of the one that is `judged`, the curves those of all.
pub(super) fn add(
    chunks: &mut Chunks,
    models: &[&ComparedJoint<'_>],
    judged: &ComparedJoint<'_>,
) -> Result<(), RecordError> {
    let (mut sheet, mut points) = (Sheet::default(), Vec::new());
    let mut curves: Vec<Vec<Vec<Vec2D>>> = vec![Vec::new(); models.len()];
    let others: Vec<Vec<Pairs>> = models.iter().map(|model| quantities(model)).collect();
    for (place, pairs) in quantities(judged).iter().enumerate() {
        let plot = plot(place, pairs);
        sheet.draw(&plot, 4.0, &pairs.name);
        let every = pairs.x.len().div_ceil(POINTS).max(1);
        let places = pairs.x.iter().zip(&pairs.residual).step_by(every);
        let inside = places.filter(|(x, _)| is_drawn(&plot, **x));
        points.extend(inside.map(|(x, r)| plot.at(*x, *r)));
        for (curves, all) in curves.iter_mut().zip(&others) {
            curves.extend(all.get(place).map(|pairs| curve(&plot, pairs)));
        }
    }
    let mut layers = Layers::fixed(chunks, paths::SCATTER);
    layers.sheets([sheet])?;
    layers.points("points", palette::RAW, 1.2, [points])?;
    for ((curves, rgb), number) in curves.into_iter().zip(palette::models()).zip(0..) {
        layers.strips(&of_model("curve", number), rgb, 2.4, [curves])?;
    }
    Ok(())
}

/// One of four places on the sheet.
fn plot(place: usize, pairs: &Pairs) -> Plot {
    let left = 400.0 * place as f32;
    let (rows, columns) = (48.0..=226.0, (left + 105.0, left + 385.0));
    let x = Span::around(most_of(&pairs.x), 0.03);
    let y = Span::around(most_of(&pairs.residual), 0.05);
    Plot::within(columns, rows, x, y)
}

/// Whether the plot reaches so far; what is off it upwards or downwards is drawn on its edge.
fn is_drawn(plot: &Plot, x: f64) -> bool {
    (0.0..=1.0).contains(&plot.x_span().part(x))
}

/// Two values between which all but the outermost of `values` lie: one spike would press the
/// others together.
fn most_of(values: &[f64]) -> impl Iterator<Item = f64> {
    /// Part of the values beyond either end.
    const BEYOND: f64 = 0.002;
    [BEYOND, 1.0 - BEYOND].into_iter().filter_map(|part| quantile(values, part))
}

fn quantities(compared: &ComparedJoint<'_>) -> Vec<Pairs> {
    let joint = compared.joint;
    let evaluation = &compared.comparison.fit.evaluation;
    let unit = |unit: &Option<String>| bracketed("", unit.as_deref());
    let (input, output) = (unit(&joint.input_unit), unit(&joint.output_unit));
    let speed = joint.output_unit.as_ref().map_or(String::new(), |u| format!(" [{u}/s]"));
    let residual: Vec<f64> = evaluation.residuals.concat();
    let all = |values: Vec<Vec<f64>>| values.concat();
    let acting = all(evaluation.simulated.iter().map(|s| s.acting.clone()).collect());
    let velocity = all(evaluation.simulated.iter().map(|s| s.velocity.clone()).collect());
    let angle = all(joint.trials.iter().map(|trial| trial.output().to_vec()).collect());
    let periods = joint.trials.iter().map(|trial| trial.period().seconds());
    let since =
        all(periods.zip(&evaluation.simulated).map(|(t, s)| since_step(&s.acting, t)).collect());
    let quantity = |name: String, x: Vec<f64>| Pairs { name, x, residual: residual.clone() };
    vec![
        quantity(format!("acting input{input}"), acting),
        quantity(format!("angle{output}"), angle),
        quantity(format!("speed{speed}"), velocity),
        quantity("time since the step [s]".to_owned(), since),
    ]
}

/// Seconds since the acting input last changed.
pub(super) fn since_step(acting: &[f64], period_s: f64) -> Vec<f64> {
    let (mut before, mut samples) = (f64::NAN, 0.0);
    let since = |level: &f64| {
        #[expect(clippy::float_cmp, reason = "a step is any change")]
        let changed = *level != before;
        samples = if changed { 0.0 } else { samples + 1.0 };
        before = *level;
        samples * period_s
    };
    acting.iter().map(since).collect()
}

/// The mean residual in each of [`BINS`] bins with as many samples each.
fn curve(plot: &Plot, pairs: &Pairs) -> Vec<Vec2D> {
    let mut sorted: Vec<(f64, f64)> =
        pairs.x.iter().copied().zip(pairs.residual.iter().copied()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = sorted.len().div_ceil(BINS).max(1);
    let mean = |bin: &[(f64, f64)]| {
        let n = bin.len() as f64;
        bin.iter().fold((0.0, 0.0), |(x, r), pair| (x + pair.0 / n, r + pair.1 / n))
    };
    let means = sorted.chunks(size).map(mean).filter(|(x, _)| is_drawn(plot, *x));
    plot.places(means)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_since_a_step_starts_anew_at_each() {
        let since = since_step(&[1.0, 1.0, 2.0, 2.0, 2.0], 0.1);
        assert_eq!(since, [0.0, 0.1, 0.0, 0.1, 0.2]);
    }
}
