//! What the residual of models depends on: four quantities, sample by sample; where the error arises, its
//! share in each part of each feature beside the share of time; itself and the input, lag by lag.

use super::canvas::{Layers, TAB};
use super::chunk::Chunks;
use super::error::RecordError;
use super::panels::{self, Placed};
use super::paths;
use crate::diagnosis::Comparison;
use crate::experiment::Joint;
use crate::figure::{Axis, Mark, Panel, Place, Role, Span, correlogram, error_share};
use crate::numerics::quantile;
use crate::report::ComparedJoint;
use crate::wording::bracketed;

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

/// Draws the residuals of `models` against four quantities; the points are those of the one that is
/// `judged`, the curves those of all.
pub(super) fn add(
    chunks: &mut Chunks,
    models: &[&ComparedJoint<'_>],
    judged: &ComparedJoint<'_>,
) -> Result<(), RecordError> {
    let all: Vec<Vec<Pairs>> = models.iter().map(|model| quantities(model)).collect();
    let unit = judged.joint.output_unit.as_deref();
    let place = |(place, pairs): (usize, Pairs)| {
        let curves = all.iter().enumerate().map(|(number, all)| {
            let curve = all.get(place).map_or_else(Vec::new, curve);
            (Role::of_revision(number), curve)
        });
        let left = 460.0 * place as f32;
        // There is room for one name above each plot; the residual is named above the first.
        let y = if place == 0 { bracketed("residual", unit) } else { String::new() };
        Placed::new(panel(&pairs, curves, y), (left + 105.0, left + 445.0), 48.0..=324.0)
    };
    let placed = quantities(judged).into_iter().enumerate().map(place).collect();
    panels::add(&mut Layers::fixed(chunks, paths::SCATTER), [placed])
}

/// The residual of a model against the quantity that its mean follows most, in the colour of `role`.
pub(super) fn clearest(compared: &ComparedJoint<'_>, role: Role) -> Option<Panel> {
    let curves = quantities(compared).into_iter().map(|pairs| (curve(&pairs), pairs));
    let followed = |curve: &[Place]| curve.iter().map(|(_, mean)| mean * mean).sum::<f64>();
    let (curve, pairs) = curves.max_by(|a, b| followed(&a.0).total_cmp(&followed(&b.0)))?;
    let name = bracketed("residual", compared.joint.output_unit.as_deref());
    Some(panel(&pairs, [(role, curve)].into_iter(), name))
}

/// The points of `pairs`, and curves through those of models; what is off the plot is left out.
fn panel(pairs: &Pairs, curves: impl Iterator<Item = (Role, Vec<Place>)>, name: String) -> Panel {
    let x = Span::around(most_of(&pairs.x), 0.03);
    let y = Span::around(most_of(&pairs.residual), 0.05);
    let every = pairs.x.len().div_ceil(POINTS).max(1);
    let places = pairs.x.iter().copied().zip(pairs.residual.iter().copied()).step_by(every);
    let mut marks = vec![Mark::dots(Role::Measured, places.collect())];
    marks.extend(curves.map(|(role, curve)| Mark::lines(role, 2.4, vec![curve])));
    let y = Axis::new(y, name, 3.0);
    Panel { x: Axis::new(x, pairs.name.clone(), 4.0), y, height: 190, marks }
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
    let outputs = all(joint.trials.iter().map(|trial| trial.output().to_vec()).collect());
    let periods = joint.trials.iter().map(|trial| trial.period().seconds());
    let since =
        all(periods.zip(&evaluation.simulated).map(|(t, s)| since_step(&s.acting, t)).collect());
    let quantity = |name: String, x: Vec<f64>| Pairs { name, x, residual: residual.clone() };
    vec![
        quantity(format!("acting input{input}"), acting),
        quantity(format!("output{output}"), outputs),
        quantity(format!("speed{speed}"), velocity),
        quantity("time since the step [s]".to_owned(), since),
    ]
}

/// Seconds since the acting input last changed.
fn since_step(acting: &[f64], period_s: f64) -> Vec<f64> {
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
fn curve(pairs: &Pairs) -> Vec<Place> {
    let mut sorted: Vec<Place> =
        pairs.x.iter().copied().zip(pairs.residual.iter().copied()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = sorted.len().div_ceil(BINS).max(1);
    let mean = |bin: &[Place]| {
        let n = bin.len() as f64;
        bin.iter().fold((0.0, 0.0), |(x, r), pair| (x + pair.0 / n, r + pair.1 / n))
    };
    sorted.chunks(size).map(mean).collect()
}

/// Plots in a row.
const COLUMNS: usize = 4;

/// Draws the regions of `models` below `root`.
pub(super) fn add_shares(
    chunks: &mut Chunks,
    models: &[&ComparedJoint<'_>],
) -> Result<(), RecordError> {
    let Some(first) = models.first() else { return Ok(()) };
    let models = models.iter().enumerate();
    let models: Vec<_> = models.map(|(n, one)| (Role::of_revision(n), one.comparison)).collect();
    let placed = placed_shares(first.joint, &models);
    panels::add(&mut Layers::fixed(chunks, paths::ERROR_SHARE), [placed])
}

/// Each panel in one of eight places on the sheet, below its quantity: the name of the view says what
/// its bars and lines are, for which there is no room above each.
pub(super) fn placed_shares(joint: &Joint, models: &[(Role, &Comparison)]) -> Vec<Placed> {
    let place = |(place, mut panel): (usize, Panel)| {
        panel.y.name.clear();
        panel.marks.iter_mut().for_each(Mark::unname);
        let rows = if place < COLUMNS { 46.0..=140.0 } else { 232.0..=326.0 };
        let width = TAB.0 / COLUMNS as f32;
        let left = (place % COLUMNS) as f32 * width;
        Placed::new(panel, (left + 95.0, left + width - 20.0), rows)
    };
    error_share::panels(joint, models).into_iter().enumerate().map(place).collect()
}

/// Draws the correlations of `models`: a curve and a band per model.
pub(super) fn add_correlograms(
    chunks: &mut Chunks,
    models: &[&ComparedJoint<'_>],
) -> Result<(), RecordError> {
    let models = models.iter().enumerate();
    let models: Vec<_> = models.map(|(n, one)| (Role::of_revision(n), one.comparison)).collect();
    let mut left = -505.0;
    let placed = correlogram::panels(&models).map(|panel| {
        left += 615.0;
        Placed::new(panel, (left, left + 490.0), 46.0..=324.0)
    });
    panels::add(&mut Layers::fixed(chunks, paths::CORRELATION), [placed.into()])
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
