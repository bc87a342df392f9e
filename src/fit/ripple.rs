//! The period, in output units, at which the speed of a joint ripples with its angle.
//!
//! While the input is held the joint moves along a line, and a gain `1 + a sin(2π y/p + φ)` adds to
//! it about `−(a p/2π) cos(2π y/p + φ)`. Of each hold the part after its start, less its own line,
//! is regressed on a cosine and a sine of the angle, all holds together, for many periods (Lomb,
//! N. R., "Least-squares frequency analysis of unequally spaced data", Astrophysics and Space Science
//! 39, 1976); the period that leaves least is where a fit of a ripple starts. Whether there is one
//! is for the fit to say.

use std::f64::consts::TAU;

use super::window::changes;
use crate::experiment::{Property, Record, Trial};

/// The period at which the speed ripples most, output units; none where no hold moves far enough.
#[derive(Debug)]
pub(super) struct RipplePeriod(pub(super) Option<f64>);

impl Property for RipplePeriod {
    fn find(record: &Record) -> Self {
        /// Holds, and samples of each, that are enough to see a ripple.
        const HOLDS: usize = 100;
        let all: Vec<Hold> = record.iter().flat_map(holds).collect();
        let every = all.len().div_ceil(HOLDS).max(1);
        let holds: Vec<Hold> = all.into_iter().step_by(every).collect();
        Self(best_period(&holds))
    }
}

/// A part of a hold in which the joint moves: its angles, and what they are beside a line in time.
struct Hold {
    angles: Vec<f64>,
    beside: Vec<f64>,
}

/// The moving parts of the holds of a trial.
fn holds(trial: &Trial) -> Vec<Hold> {
    /// The part of a hold in which the joint may still react to its start.
    const STARTING: f64 = 0.4;
    /// Samples of a hold, at least and at most.
    const FEWEST: usize = 20;
    const MOST: usize = 40;
    let borders = std::iter::once(0).chain(changes(trial.input())).chain([trial.len()]);
    let borders: Vec<usize> = borders.collect();
    let part = |pair: &[usize]| {
        let &[start, end] = pair else { return None };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a part")]
        let from = start + (STARTING * (end - start) as f64) as usize;
        let output = trial.output().get(from..end).filter(|part| part.len() >= FEWEST)?;
        let angles: Vec<f64> =
            output.iter().copied().step_by(output.len().div_ceil(MOST)).collect();
        let beside = without_line(&angles);
        let is_moving = (angles.last()? - angles.first()?).abs() > 20.0 * root_mean_square(&beside);
        is_moving.then_some(Hold { angles, beside })
    };
    borders.windows(2).filter_map(part).collect()
}

/// The period with which a cosine and a sine of the angle explain most of what is beside the lines.
fn best_period(holds: &[Hold]) -> Option<f64> {
    /// Cycles over all angles, from the fewest that are a ripple on, and their distance: half of what
    /// turns a cosine by a cycle over the range.
    const FEWEST: f64 = 2.0;
    const MOST: f64 = 200.0;
    const STEP: f64 = 0.5;
    let angles = || holds.iter().flat_map(|hold| hold.angles.iter().copied());
    let (low, high) =
        (angles().fold(f64::INFINITY, f64::min), angles().fold(f64::NEG_INFINITY, f64::max));
    let span = high - low;
    if !(span > 0.0 && span.is_finite()) {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let count = ((MOST - FEWEST) / STEP) as u32;
    let coarse = (0..=count).map(|step| FEWEST + STEP * f64::from(step));
    let explained = |cycles: f64| explained(holds, span / cycles);
    let best = coarse.map(|cycles| (explained(cycles), cycles)).max_by(|a, b| a.0.total_cmp(&b.0));
    let (_, near) = best?;
    let fine = (-5..=5).map(|step| near + 0.1 * STEP * f64::from(step));
    let best = fine.map(|cycles| (explained(cycles), cycles)).max_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(explained, _)| *explained > 0.0).map(|(_, cycles)| span / cycles)
}

/// The sum of squares that a cosine and a sine of this period explain.
fn explained(holds: &[Hold], period: f64) -> f64 {
    // Normal equations: of the cosine c, the sine s and what is beside the lines b.
    let [mut cc, mut ss, mut cs, mut cb, mut sb] = [0.0; 5];
    for Hold { angles, beside } in holds {
        let phases = || angles.iter().map(|angle| TAU * angle / period);
        let cosine = without_line(&phases().map(f64::cos).collect::<Vec<_>>());
        let sine = without_line(&phases().map(f64::sin).collect::<Vec<_>>());
        for ((c, s), b) in cosine.iter().zip(&sine).zip(beside) {
            cc += c * c;
            ss += s * s;
            cs += c * s;
            cb += c * b;
            sb += s * b;
        }
    }
    let determinant = cc * ss - cs * cs;
    if determinant <= 1e-9 * cc * ss {
        return 0.0;
    }
    (cb * cb * ss - 2.0 * cb * sb * cs + sb * sb * cc) / determinant
}

/// `values`, evenly spaced, less their least-squares line.
fn without_line(values: &[f64]) -> Vec<f64> {
    let count = values.len() as f64;
    let middle = (count - 1.0) / 2.0;
    let times = || (0..values.len()).map(|k| k as f64 - middle);
    let mean = values.iter().sum::<f64>() / count;
    let slope = times().zip(values).map(|(t, value)| t * value).sum::<f64>()
        / times().map(|t| t * t).sum::<f64>();
    times().zip(values).map(|(t, value)| value - mean - slope * t).collect()
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    #[test]
    fn the_period_of_a_ripple_is_found() {
        for period in [3.0_f64, 7.0, 17.0] {
            let levels = [1.0, -0.5, 1.5, -2.0, 0.7, -0.6, 2.0, -1.0, 1.2, -1.4];
            let input: Vec<f64> = (0..4000).map(|k| levels[k / 200 % 10]).collect();
            let mut angle = 0.0_f64;
            let mut turn = |u: &f64| {
                angle += 0.1 * u * (1.0 + 0.2 * (TAU * angle / period + 0.4).sin());
                angle
            };
            let output = input.iter().map(&mut turn).collect();
            let dt = SamplePeriod::from_seconds(0.01).unwrap();
            let trial = Trial::new("1", 0.0, dt, input.clone(), output).unwrap();
            let found = RipplePeriod::find(&[trial].into()).0.unwrap();
            assert!((found / period - 1.0).abs() < 0.05, "{found} for {period}");
        }
    }

    #[test]
    fn a_joint_at_rest_has_none() {
        let dt = SamplePeriod::from_seconds(0.01).unwrap();
        let trial = Trial::new("1", 0.0, dt, vec![0.0; 100], vec![3.0; 100]).unwrap();
        assert_eq!(RipplePeriod::find(&[trial].into()).0, None);
    }
}
