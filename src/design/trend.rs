//! What predictions are off by in the same way each time: an error of the gain, of one direction,
//! or a drift that no short motion shows by itself.
//!
//! The errors `e` at the ends of motions are regressed on their time, on the way that the joint was
//! to go, and on how far it was to come,
//!
//! ```text
//! e = a t + b w + c d
//! ```
//!
//! and a plan is off by as much of each as it has of them.

use nalgebra::{DMatrix, DVector, Vector3};

use crate::numerics::{PseudoInverse, REGRESSORS};

/// Fewest motions from which a trend is found.
const FEWEST: usize = 8;

/// How far and for how long a joint goes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Travel {
    /// Seconds since the start.
    pub seconds: f64,
    /// The way until then, to and fro, output units.
    pub way: f64,
    /// The distance from the start, with its sign, output units.
    pub distance: f64,
}

impl Travel {
    fn vector(&self) -> Vector3<f64> {
        Vector3::new(self.seconds, self.way, self.distance)
    }
}

/// The part of errors that grows in proportion to time, way and distance.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Trend {
    coefficients: Vector3<f64>,
    covariance: nalgebra::Matrix3<f64>,
}

impl Trend {
    /// The one of motions with their errors; `None` where they are few, or do not determine it.
    pub(super) fn of(motions: &[(Travel, f64)]) -> Option<Self> {
        if motions.len() < FEWEST {
            return None;
        }
        let rows = motions.iter().map(|(travel, _)| travel.vector());
        let squares = rows.clone().fold(Vector3::zeros(), |sum, row| sum + row.component_mul(&row));
        let lengths: Vector3<f64> = squares.map(f64::sqrt);
        if lengths.min() <= 0.0 {
            return None;
        }
        let mut products = nalgebra::Matrix3::zeros();
        let mut with = Vector3::zeros();
        for (row, (_, error)) in rows.zip(motions) {
            // Columns of length one: seconds and ways have no common unit.
            let row = row.component_div(&lengths);
            products += row * row.transpose();
            with += row * *error;
        }
        let dynamic = DMatrix::from_column_slice(3, 3, products.as_slice());
        let inverse = PseudoInverse::of(dynamic, REGRESSORS);
        if inverse.rank() < 3 {
            return None;
        }
        let (scaled, explained) = inverse.solve(&DVector::from_column_slice(with.as_slice()));
        let total: f64 = motions.iter().map(|(_, error)| error * error).sum();
        // Three coefficients.
        let variance = (total - explained).max(0.0) / (motions.len() - 3) as f64;
        let scaled = Vector3::from_column_slice(scaled.as_slice());
        let inverse = nalgebra::Matrix3::from_column_slice(inverse.matrix().as_slice());
        let unscaled = lengths * lengths.transpose();
        let covariance = (variance * inverse).component_div(&unscaled);
        Some(Self { coefficients: scaled.component_div(&lengths), covariance })
    }

    /// By how much a prediction is off after `travel`, and a standard deviation more.
    pub(super) fn at(&self, travel: Travel) -> f64 {
        let travel = travel.vector();
        // xᵀCx.
        let variance = travel.dot(&(self.covariance * travel));
        self.coefficients.dot(&travel).abs() + variance.max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strokes of 60 units to and fro at several speeds, off by a drift and by noise.
    fn strokes(drift: f64) -> Vec<(Travel, f64)> {
        let one = |k: u32| {
            let seconds = f64::from(2 + k / 2 % 4);
            let distance = if k.is_multiple_of(2) { 60.0 } else { -60.0 };
            let noise = 0.1 * (f64::from(k) * 1.7).sin();
            (Travel { seconds, way: 60.0, distance }, drift * seconds + 0.01 * distance + noise)
        };
        (0..24).map(one).collect()
    }

    #[test]
    fn a_drift_is_found_beside_an_error_of_the_gain() {
        let rest = Travel { seconds: 100.0, ..Travel::default() };
        let drifting = Trend::of(&strokes(0.2)).unwrap().at(rest);
        assert!((18.0..26.0).contains(&drifting), "{drifting}");
        let still = Trend::of(&strokes(0.0)).unwrap().at(rest);
        assert!(still < 5.0, "{still}");
        // What is lost upward is gained downward.
        let to_and_fro = Travel { seconds: 1.0, way: 600.0, distance: 0.0 };
        assert!(Trend::of(&strokes(0.0)).unwrap().at(to_and_fro) < 1.0);
    }

    #[test]
    fn motions_of_one_speed_and_few_motions_show_none() {
        let mut same = strokes(0.2);
        for (travel, _) in &mut same {
            travel.seconds = 3.0;
        }
        assert_eq!(Trend::of(&same), None);
        assert_eq!(Trend::of(&strokes(0.2)[..7]), None);
    }
}
