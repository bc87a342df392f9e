//! Steps of the input that lie between the samples of the log.
//!
//! A logger that is not the controller notes a step of the input with the next sample, up to one
//! period `h` after it happened. The delay of a model fits the mean step; step `i`, which happened
//! `ε` later than that, moves the output of an integrating joint by what its speed changes by:
//!
//! ```text
//! r(t) = −ε_i (v(t) − v_i)     after its arrival, v_i being the speed before it
//! ```
//!
//! and keeps it moved until the simulation restarts. The `ε` of each window are found by least
//! squares. They are the logger's where they are spread evenly over one period and have nothing to
//! do with the step: no sampled record separates such a delay from that of the joint, and no
//! effect is missing for it.
//!
//! # References
//! K. J. Åström and B. Wittenmark, "Computer-Controlled Systems", 1997, chapter 1 (asynchronous
//! sampling).

use serde::Serialize;

use super::lags::centre;
use crate::fit::{Evaluation, FitRecord, Window, follows_input};
use crate::numerics::{Regression, dot, quantile, spearman};

/// Steps of the input whose times are known to no better than a sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct InputEdges {
    /// Steps whose times were found.
    pub steps: usize,
    /// Seconds over which the middle 80 % of them are spread.
    pub spread_s: f64,
    /// The part of the squared residual that they explain.
    #[serde(rename = "share_of_squared_residual")]
    pub share: f64,
}

/// The time at which a step happened, beside the one of the mean step.
#[derive(Clone, Copy, Debug)]
struct Edge {
    late_s: f64,
    /// Seconds between the samples of its trial.
    period_s: f64,
    before: f64,
    after: f64,
    /// Whether noise leaves its time known.
    is_known: bool,
}

/// What the times of steps between samples leave of the residuals of `evaluation`, and how they
/// are spread; `None` where they are not the logger's. `noise` is that of the measurement.
pub(super) fn without_edges(
    record: &FitRecord<'_>,
    evaluation: &Evaluation,
    noise: f64,
) -> Option<(InputEdges, Evaluation)> {
    // Where the output follows the input itself, the speed does not say how far it is moved.
    if follows_input(record.joint()).is_some() {
        return None;
    }
    let mut rest = evaluation.clone();
    let mut edges = Vec::new();
    for window in record.windows() {
        let residual = rest.residuals.get_mut(window.trial)?.get_mut(window.start..window.end)?;
        edges.extend(subtract_edges(record, evaluation, window, residual, noise)?);
    }
    let known: Vec<Edge> = edges.into_iter().filter(|edge| edge.is_known).collect();
    if !are_even(&known) || depend_on_step(&known) {
        return None;
    }
    let late: Vec<f64> = known.iter().map(|edge| edge.late_s).collect();
    // Steps at the edges of the window are spread by noise: the middle 80 %.
    let spread_s = quantile(&late, 0.9)? - quantile(&late, 0.1)?;
    let square = |of: &Evaluation| -> f64 {
        let own = |w: &Window| of.residuals.get(w.trial)?.get(w.start..w.end);
        record.windows().iter().filter_map(own).map(|values| dot(values, values)).sum()
    };
    let share = 1.0 - square(&rest) / square(evaluation);
    Some((InputEdges { steps: known.len(), spread_s, share }, rest))
}

/// Subtracts from the `residual` of a window what the times of its steps explain of it, no more of
/// each than half a period to either side; `None` where there is no speed, or too many steps.
fn subtract_edges(
    record: &FitRecord<'_>,
    evaluation: &Evaluation,
    window: &Window,
    residual: &mut [f64],
    noise: f64,
) -> Option<Vec<Edge>> {
    /// Part of a period to which noise must leave the time of a step known: an even spread over
    /// one period is then distinguished from none.
    const KNOWN: f64 = 1.0 / 6.0;
    /// Steps of a window that are looked at together: work grows with the square of them.
    const MOST_TOGETHER: usize = 200;
    let simulated = evaluation.simulated.get(window.trial)?;
    let period_s = record.joint().trials.get(window.trial)?.period().seconds();
    let velocity = simulated.velocity.get(window.start..window.end)?;
    let acting = simulated.acting.get(window.start..window.end)?;
    let arrivals: Vec<usize> =
        (1..acting.len()).filter(|&k| (acting[k] - acting[k - 1]).abs() > 0.0).collect();
    if arrivals.len() > MOST_TOGETHER {
        return None;
    }
    let ends = arrivals.iter().skip(1).copied().chain([acting.len()]);
    let shapes: Vec<Vec<Vec<f64>>> =
        arrivals.iter().zip(ends).map(|(&at, end)| vec![moved(velocity, at, end)]).collect();
    if shapes.is_empty() {
        return Some(Vec::new());
    }
    let found = Regression::of(&[residual.to_vec()], &shapes.iter().collect::<Vec<_>>());
    let edge = |((&at, shape), late_s): ((&usize, &Vec<Vec<f64>>), &f64)| {
        let length = shape.iter().map(|window| dot(window, window)).sum::<f64>().sqrt();
        // The standard error of ε is σ/|shape|.
        let is_known = noise < KNOWN * period_s * length;
        Edge { late_s: *late_s, period_s, before: acting[at - 1], after: acting[at], is_known }
    };
    let edges: Vec<Edge> =
        arrivals.iter().zip(&shapes).zip(found.coefficients.iter()).map(edge).collect();
    for (edge, shape) in edges.iter().zip(&shapes) {
        let late_s = edge.late_s.clamp(-period_s / 2.0, period_s / 2.0);
        let shape = shape.iter().flatten();
        residual.iter_mut().zip(shape).for_each(|(value, shape)| *value -= late_s * shape);
    }
    Some(edges)
}

/// By how much the output moves for each second that the step which arrives with sample `at` is
/// later, less its mean in the window, as the residual is; another one arrives with sample `end`.
fn moved(velocity: &[f64], at: usize, end: usize) -> Vec<f64> {
    // The speed until sample `at` is that before the step, and of a part of an interval that after.
    let before = velocity[at.saturating_sub(2)];
    let at_sample = |k: usize| if k < at { 0.0 } else { before - velocity[k.min(end) - 1] };
    let mut shape: Vec<f64> = (0..velocity.len()).map(at_sample).collect();
    centre(&mut shape);
    shape
}

/// Whether the times are spread evenly over one period.
fn are_even(edges: &[Edge]) -> bool {
    /// Steps from which on a spread says something.
    const FEWEST: usize = 20;
    /// Periods over which the middle 80 % of an even spread lie: 0.8, give or take three
    /// standard deviations of those of 20 steps and what noise adds.
    const MIDDLE: std::ops::RangeInclusive<f64> = 0.55..=1.05;
    /// Part of a period within which all but 5 % lie to either side of the median: one half, and
    /// what noise adds.
    const HALF: f64 = 0.7;
    if edges.len() < FEWEST {
        return false;
    }
    let late: Vec<f64> = edges.iter().map(|edge| edge.late_s / edge.period_s).collect();
    let [low, median, high] = [0.1, 0.5, 0.9].map(|part| quantile(&late, part).unwrap_or(f64::NAN));
    let outside = late.iter().filter(|late| (*late - median).abs() > HALF).count();
    MIDDLE.contains(&(high - low)) && outside * 20 <= late.len()
}

/// Whether the times have to do with the step, as a delay has that depends on it.
fn depend_on_step(edges: &[Edge]) -> bool {
    /// Probability of calling chance a dependence, of any of the four.
    const SIGNIFICANCE: f64 = 1e-3;
    let late: Vec<f64> = edges.iter().map(|edge| edge.late_s).collect();
    let features: [fn(&Edge) -> f64; 4] = [
        |edge| edge.after,
        |edge| edge.after.abs(),
        |edge| edge.after - edge.before,
        |edge| (edge.after - edge.before).abs(),
    ];
    features.iter().any(|feature| {
        let values: Vec<f64> = edges.iter().map(feature).collect();
        spearman(&values, &late).is_some_and(|test| test.p_value < SIGNIFICANCE)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(late_s: f64, after: f64) -> Edge {
        Edge { late_s, period_s: 0.02, before: 0.0, after, is_known: true }
    }

    /// Times of steps, in parts of a period, and their levels in an order of their own.
    fn edges(late: impl Fn(f64) -> f64) -> Vec<Edge> {
        let part = |k: usize| (k as f64 + 0.5) / 40.0 - 0.5;
        (0..40).map(|k| edge(0.02 * late(part(k)), part(k * 17 % 40))).collect()
    }

    #[test]
    fn an_even_spread_over_one_period_is_the_loggers() {
        assert!(are_even(&edges(|part| part)) && !depend_on_step(&edges(|part| part)));
        // On the samples, over three periods, and in two groups a period apart.
        assert!(!are_even(&edges(|part| 0.1 * part)));
        assert!(!are_even(&edges(|part| 3.0 * part)));
        assert!(!are_even(&edges(|part| part.signum() * 0.75)));
        assert!(!are_even(&edges(|part| part)[..15]));
    }

    #[test]
    fn a_delay_that_depends_on_the_step_is_not() {
        let by_level = |late: f64| edge(0.02 * late, late);
        let edges: Vec<Edge> = (0..40).map(|k| by_level((f64::from(k) - 19.5) / 40.0)).collect();
        assert!(are_even(&edges) && depend_on_step(&edges));
    }

    #[test]
    fn a_late_step_moves_the_output_against_its_speed() {
        let shape = moved(&[1.0, 1.0, 3.0, 3.0, 3.0, 3.0], 2, 6);
        let mean = -2.0 * 3.0 / 6.0;
        let expected = [0.0, 0.0, 0.0, -2.0, -2.0, -2.0].map(|value| value - mean);
        assert!(shape.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{shape:?}");
    }
}
