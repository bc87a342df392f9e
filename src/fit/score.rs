//! A linear screen of effects: the residual in the directions of their starts.
//!
//! With `r` the residual of a model, `J` its slopes to the free parameters, and `d` the change
//! of the residual from where an effect is neutral to where it would start, all less their projection on
//! `J`, the effect's share of the sum of squares is, to first order,
//!
//! ```text
//! max(0, −r·d)² / (d·d r·r)
//! ```
//!
//! as in a score test (Rao 1948), but with the whole way to the start instead of a slope:
//! a threshold has none where it is neutral. Only ways towards the start count: an effect
//! undone is no effect.
//!
//! # References
//! C. R. Rao, "Large sample tests of statistical hypotheses concerning several parameters with
//! applications to problems of estimation", Proceedings of the Cambridge Philosophical Society
//! 44 (1948), 50-57.

use nalgebra::DVector;

use super::record::FitRecord;
use super::search::Search;
use super::space::Space;
use super::starts::starts;
use crate::effect::RecordRange;
use crate::model::JointModel;
use crate::numerics::{Basis, rank};

/// A model's residual, less what its own parameters can explain.
#[derive(Debug)]
pub struct Score<'r> {
    /// Training windows that are short enough for an error to count where it is made.
    record: FitRecord<'r>,
    /// The residual as it is.
    raw: DVector<f64>,
    /// An orthonormal basis of the slopes to the free parameters.
    slopes: Basis,
    /// The residual without them, of length one.
    unit: DVector<f64>,
}

/// Where an effect would go from where it is neutral: for each of its starts the change of the
/// residual with its sign turned, of length one, and the part of the residual that it explains.
#[derive(Clone, Debug)]
pub struct Directions {
    units: Vec<(DVector<f64>, f64)>,
}

impl<'r> Score<'r> {
    /// The residual of `model` on the training windows of `record`; `None` where there is none
    /// to speak of.
    pub fn of(record: &FitRecord<'r>, model: &JointModel, range: &RecordRange<'_>) -> Option<Self> {
        let record = record.for_training().coarser_for(model).shortened();
        let space = Space::of(model, range);
        let start = model.values().iter().map(|value| value.value).collect();
        let search = Search::new(&record, model, &space, start);
        let raw = search.problem.residuals();
        let jacobian = search.problem.jacobian(&raw);
        if !jacobian.iter().all(|slope| slope.is_finite()) {
            return None;
        }
        let slopes = Basis::of(jacobian.as_slice(), jacobian.nrows(), rank::DIFFERENCED);
        let unit = unit(residual(&slopes, &raw), raw.norm())?;
        Some(Self { record, raw, slopes, unit })
    }

    /// Whether what the neutral effects of `model` would do, the parameters of the model of the score do
    /// as well: beside these the record cannot show them. An offset of the input beside a leakage is an
    /// angle of balance.
    #[must_use]
    pub fn hides(&self, model: &JointModel, range: &RecordRange<'_>) -> bool {
        /// The part of its size that is left of a change. Chosen: of a change that is linear in its
        /// parameter 1e-6 is left, and of effects that a record can show a hundredth and more.
        const NOTHING: f64 = 1e-3;
        let change = |start: &Vec<f64>| self.change(&model.with_values(start));
        let changes: Vec<_> = starts(model, range).iter().map(change).collect();
        let is_hidden =
            |change: &DVector<f64>| residual(&self.slopes, change).norm() < NOTHING * change.norm();
        !changes.is_empty() && changes.iter().all(is_hidden)
    }

    /// By how much the residual of `model` is less than that of the model of the score.
    fn change(&self, model: &JointModel) -> DVector<f64> {
        &self.raw - self.record.training(&self.record.evaluate_residuals(model).residuals)
    }

    /// The directions of the effects of `model` that are neutral; the model of the score has
    /// none of them.
    #[must_use]
    pub fn directions(&self, model: &JointModel, range: &RecordRange<'_>) -> Directions {
        let direction = |start: Vec<f64>| {
            let change = self.change(&model.with_values(&start));
            let size = change.norm();
            let direction = unit(residual(&self.slopes, &change), size)?;
            let share = direction.dot(&self.unit);
            (share > 0.0).then_some((direction, share))
        };
        Directions { units: starts(model, range).into_iter().filter_map(direction).collect() }
    }
}

impl Directions {
    /// The share of the sum of squares that the best of these and the best of `others` explain
    /// together, 0 to 1.
    #[must_use]
    pub fn share_with(&self, others: &Self) -> f64 {
        let alone = |directions: &Self| directions.units.iter().fold(0.0, |m: f64, u| m.max(u.1));
        let alone = alone(self).max(alone(others)).powi(2);
        let pairs = self.units.iter().flat_map(|a| others.units.iter().map(move |b| (a, b)));
        let shares = pairs.map(|((a, of_a), (b, of_b))| share_of_two(*of_a, *of_b, a.dot(b)));
        shares.fold(alone, f64::max)
    }
}

/// The share that two directions explain together, each forwards, from what they explain alone and the
/// cosine between them; 0 where one alone is as good.
fn share_of_two(one: f64, two: f64, cosine: f64) -> f64 {
    /// Directions nearer than this are one.
    const ALIKE: f64 = 0.999;
    let forwards = one > cosine * two && two > cosine * one;
    if !forwards || cosine.abs() > ALIKE {
        return 0.0;
    }
    (one * one + two * two - 2.0 * cosine * one * two) / (1.0 - cosine * cosine)
}

/// What of a change of the residual no parameter of the model makes.
fn residual(slopes: &Basis, change: &DVector<f64>) -> DVector<f64> {
    DVector::from_vec(slopes.residual(change.as_slice()))
}

/// The residual `vector` with length one; `None` where it is dependent: next to none of the
/// `size` it had.
fn unit(vector: DVector<f64>, size: f64) -> Option<DVector<f64>> {
    let length = vector.norm();
    (length.is_finite() && length > rank::DIFFERENCED * size).then(|| vector / length)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::effect::{DeadBand, Effect, GravityLoad, InputOffset, Leakage};
    use crate::experiment::{Joint, Trial};
    use crate::fit::{Horizon, Split, fit};
    use crate::model::{Component, Value};
    use crate::units::SamplePeriod;

    #[test]
    fn the_share_of_two_directions_is_that_of_least_squares() {
        let vector = |phase: f64| {
            let values = (0..40).map(|k| (f64::from(k) * 0.3 + phase).sin() + phase);
            unit(DVector::from_iterator(40, values), 1.0).unwrap()
        };
        let (target, one, two) = (vector(0.4), vector(0.9), vector(0.1));
        let columns = DMatrix::from_columns(&[one.clone(), two.clone()]);
        let best = columns.clone().svd(true, true).solve(&target, 1e-12).unwrap();
        assert!(best.min() > 0.0, "both go forwards: {best}");
        let share = 1.0 - (&target - columns * best).norm_squared();
        let found = share_of_two(one.dot(&target), two.dot(&target), one.dot(&two));
        assert!((found - share).abs() < 1e-9, "{found} is not {share}");
    }

    #[test]
    fn one_that_would_go_backwards_does_not_count() {
        assert!(share_of_two(0.9, 0.1, 0.5) <= 0.0);
        assert!((share_of_two(0.6, 0.6, 0.0) - 0.72).abs() < 1e-12);
    }

    /// A joint with a dead band and an offset of the input, which hide each other in part.
    fn joint() -> Joint {
        let input: Vec<f64> =
            (0..3000).map(|k| [-2.0, 0.5, 1.0, -0.5, 2.0, -1.0][(k / 100) % 6]).collect();
        let mut angle = 0.0;
        let output = input.iter().enumerate().map(|(k, u)| {
            let driven = *u + 0.15;
            let beyond = driven - driven.clamp(-0.3, 0.3);
            angle += 0.01 * 10.0 * beyond;
            angle + 0.02 * (k as f64 * 12.9898).sin()
        });
        let output: Vec<f64> = output.collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        Joint {
            name: "boom".to_owned(),
            input_unit: None,
            output_unit: None,
            covariates: Vec::new(),
            trials: [Trial::new("1", 0.0, period, input, output).unwrap()].into(),
        }
    }

    #[test]
    fn an_offset_does_not_show_beside_a_leakage() {
        let joint = joint();
        let record = FitRecord::new(&joint, Split::Time(0.7), Horizon::Steps);
        let range = record.range(20.0);
        let leaking = Component::new(&Leakage, [0.05, 5.0].map(Value::from).to_vec()).unwrap();
        let model = JointModel::integrator(10.0, 0.0).with(leaking);
        let score = Score::of(&record, &model, &range).unwrap();
        let hides = |effect: &'static dyn Effect| {
            score.hides(&model.with(Component::neutral(effect)), &range)
        };
        assert!(hides(&InputOffset));
        assert!(!hides(&DeadBand) && !hides(&GravityLoad));
    }

    #[test]
    fn what_is_there_scores_best() {
        let joint = joint();
        let record = FitRecord::new(&joint, Split::Time(0.7), Horizon::Steps);
        let range = record.range(20.0);
        let base = fit(&record, &JointModel::integrator(8.0, 0.05), &range)
            .unwrap()
            .assessment
            .assessed
            .model;
        let score = Score::of(&record, &base, &range).unwrap();
        let of = |effect: &'static dyn Effect| {
            score.directions(&base.with(Component::neutral(effect)), &range)
        };
        let (band, offset, load) = (of(&DeadBand), of(&InputOffset), of(&GravityLoad));
        let both = band.share_with(&offset);
        assert!(both > 0.8 && both <= 1.0, "{both}");
        assert!(both > band.share_with(&load) && both > offset.share_with(&load));
    }
}
