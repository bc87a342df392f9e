//! What a missing effect could add to the output of an integrating joint.

use std::mem::take;

use super::lags::centre;
use crate::experiment::Trial;
use crate::fit::{Evaluation, FitRecord, Window};
use crate::model::Simulated;

/// Levels of the input that get a shape of their own.
const MAX_LEVELS: usize = 10;

/// Parts of the record that get a shape of their own.
const TIME_PARTS: usize = 8;

/// Knots on the angle's range at which a sensor's error gets a shape of its own.
const ANGLE_KNOTS: usize = 24;

/// Time constants of transients after a step, in seconds.
const TRANSIENTS_S: [f64; 4] = [0.03, 0.1, 0.3, 1.0];

/// The columns of [`super::lack_of_fit`]: for each shape, window and sample its value.
///
/// Shapes of the velocity are integrated over the window; all are less their mean in the
/// window, as the residual is.
pub(super) fn shapes(
    record: &FitRecord<'_>,
    evaluation: &Evaluation,
    windows: &[Window],
) -> Vec<Vec<Vec<f64>>> {
    let scales = Scales::of(record, evaluation);
    let mut windows: Vec<Vec<Vec<f64>>> = windows
        .iter()
        .filter_map(|window| {
            Some(of_window(record, evaluation.simulated.get(window.trial)?, window, &scales))
        })
        .collect();
    let count = windows.first().map_or(0, Vec::len);
    let column = |index: usize| windows.iter_mut().map(|shapes| take(&mut shapes[index])).collect();
    (0..count).map(column).collect()
}

/// Sizes that make the shapes comparable from window to window.
struct Scales {
    levels: Vec<f64>,
    middle: f64,
    half_span: f64,
    duration_s: f64,
}

impl Scales {
    fn of(record: &FitRecord<'_>, evaluation: &Evaluation) -> Self {
        let mut levels: Vec<f64> =
            evaluation.simulated.iter().flat_map(|s| s.acting.iter().copied()).collect();
        levels.sort_by(f64::total_cmp);
        let count = levels.len();
        let quantile = |part: usize| levels.get(part * (count - 1) / MAX_LEVELS).copied();
        let mut edges: Vec<f64> = (0..=MAX_LEVELS).filter_map(quantile).collect();
        edges.dedup();
        let outputs = || record.joint().trials.iter().flat_map(|t| t.output().iter().copied());
        let (low, high) =
            (outputs().fold(f64::INFINITY, f64::min), outputs().fold(f64::NEG_INFINITY, f64::max));
        let trials = record.joint().trials.iter().enumerate();
        let ends =
            trials.map(|(index, trial)| since_start_s(record, index, trial, trial.len() - 1));
        Self {
            levels: edges,
            middle: f64::midpoint(low, high),
            // So that products of angle and speed are of the size of the speed.
            half_span: ((high - low) / 2.0).max(f64::MIN_POSITIVE),
            duration_s: ends.fold(f64::MIN_POSITIVE, f64::max),
        }
    }
}

/// Time of the sample of `trial` with this index, in seconds from the start of the record.
fn since_start_s(record: &FitRecord<'_>, index: usize, trial: &Trial, sample: usize) -> f64 {
    record.start_s(index) + sample as f64 * trial.period().seconds()
}

/// All shapes in one window.
fn of_window(
    record: &FitRecord<'_>,
    simulated: &Simulated,
    window: &Window,
    scales: &Scales,
) -> Vec<Vec<f64>> {
    let Some(trial) = record.joint().trials.get(window.trial) else { return Vec::new() };
    let period = trial.period().seconds();
    let cut = |values: &[f64]| values.get(window.start..window.end).unwrap_or_default().to_vec();
    let (acting, speed) = (cut(&simulated.acting), cut(&simulated.velocity));
    let scaled = |angles: &[f64]| -> Vec<f64> {
        cut(angles).iter().map(|y| (y - scales.middle) / scales.half_span).collect()
    };
    let angle = scaled(trial.output());
    let first = since_start_s(record, window.trial, trial, window.start);
    let time: Vec<f64> =
        (0..acting.len()).map(|k| (first + k as f64 * period) / scales.duration_s).collect();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<f64>>();
    let mut velocities = vec![vec![1.0; acting.len()], speed.clone(), angle.clone(), time.clone()];
    velocities.extend(bands(&acting, &scales.levels));
    velocities.extend([product(&speed, &angle), product(&speed, &product(&angle, &angle))]);
    velocities.extend([product(&speed, &time), product(&angle, &angle)]);
    velocities.push(speed.iter().map(|v| v.abs()).collect());
    velocities.extend(edges(&speed, &angle));
    velocities.extend(parts(&time));
    let mut shapes: Vec<Vec<f64>> =
        velocities.into_iter().map(|velocity| integrated(&velocity, period)).collect();
    shapes.extend(transients(&acting, period));
    // Of the simulated angle: the measured one has the noise in it that is tested.
    shapes.extend(tents(&scaled(&simulated.output)));
    shapes.push(speed);
    for shape in &mut shapes {
        centre(shape);
    }
    shapes
}

/// One where the input lies between two neighbouring edges, zero elsewhere.
fn bands(acting: &[f64], edges: &[f64]) -> Vec<Vec<f64>> {
    let inside = |low: f64, high: f64| {
        acting.iter().map(|u| f64::from(u8::from(*u > low && *u <= high))).collect()
    };
    edges.windows(2).filter_map(|pair| Some(inside(*pair.first()?, *pair.last()?))).collect()
}

/// The speed where the joint is near one end of its range.
fn edges(speed: &[f64], angle: &[f64]) -> Vec<Vec<f64>> {
    /// Part of the half range that counts as its end.
    const END: f64 = 0.8;
    let where_ = |is_there: fn(f64) -> bool| {
        let pairs = speed.iter().zip(angle);
        pairs.map(|(v, y)| if is_there(*y) { *v } else { 0.0 }).collect::<Vec<f64>>()
    };
    vec![where_(|y| y > END), where_(|y| y < -END)]
}

/// What a sensor may add at each angle: a tent over each of some knots, which overlap
/// half, so that together they make any broken line.
fn tents(angle: &[f64]) -> Vec<Vec<f64>> {
    let last = (ANGLE_KNOTS - 1) as f64;
    let tent = |knot: usize| {
        let distance = |y: &f64| f64::midpoint(1.0, *y) * last - knot as f64;
        angle.iter().map(|y| (1.0 - distance(y).abs()).max(0.0)).collect()
    };
    (0..ANGLE_KNOTS).map(tent).collect()
}

/// One in each part of the record.
fn parts(time: &[f64]) -> Vec<Vec<f64>> {
    let part = |index: usize| {
        let (from, to) = (index as f64 / TIME_PARTS as f64, (index + 1) as f64 / TIME_PARTS as f64);
        time.iter().map(|t| f64::from(u8::from(*t >= from && *t < to))).collect()
    };
    (0..TIME_PARTS).map(part).collect()
}

/// Each change of the input, fading away with a time constant.
fn transients(acting: &[f64], period: f64) -> Vec<Vec<f64>> {
    let fading = |time_constant: f64| {
        let keep = (-period / time_constant).exp();
        let mut before = acting.first().copied().unwrap_or_default();
        let mut value = 0.0;
        let step = |u: &f64| {
            // The exact decay of a first order over a sample.
            value = value * keep + (u - before);
            before = *u;
            value
        };
        acting.iter().map(step).collect()
    };
    TRANSIENTS_S.iter().map(|time_constant| fading(*time_constant)).collect()
}

fn integrated(velocity: &[f64], period: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let before = |v: &f64| {
        let before = sum;
        sum += v * period;
        before
    };
    velocity.iter().map(before).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transient_starts_at_its_step_and_fades() {
        let acting = [0.0, 0.0, 1.0, 1.0, 1.0];
        let fading = &transients(&acting, 0.1)[1];
        assert!((fading[2] - 1.0).abs() < 1e-12);
        assert!((fading[4] - (-2.0f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn the_integral_starts_at_zero() {
        assert_eq!(integrated(&[2.0, 2.0, 0.0], 0.5), [0.0, 1.0, 2.0]);
    }

    #[test]
    fn tents_add_up_to_one_within_the_range() {
        let angle = [-1.0, -0.33, 0.0, 0.71, 1.0];
        for k in 0..angle.len() {
            let sum: f64 = tents(&angle).iter().map(|tent| tent[k]).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn each_sample_lies_in_one_part() {
        let time = [0.0, 0.3, 0.99];
        for k in 0..3 {
            let sum: f64 = parts(&time).iter().map(|part| part[k]).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}
