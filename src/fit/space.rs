//! The parameters that a fit may change, and how far.

use nalgebra::DVector;

use super::bounds::Bounds;
use super::covariance::Covariance;
use super::result::Status;
use crate::effect::{Dimension, RecordRange};
use crate::model::JointModel;

/// The free parameters of a model and their bounds.
pub(super) struct Space {
    /// Index in [`JointModel::values`] of each free parameter.
    pub(super) free: Vec<usize>,
    pub(super) bounds: Vec<Bounds>,
    /// For each of them the values, one for each gap between levels of the input, between
    /// which an effect may do nothing but switch; none for what is not a level.
    pub(super) flats: Vec<Vec<f64>>,
}

impl Space {
    pub(super) fn of(model: &JointModel, range: &RecordRange<'_>) -> Self {
        /// No joint of this kind reacts later than this.
        const LONGEST_DELAY_S: f64 = 5.0;
        let delay = (0.0, LONGEST_DELAY_S.min(0.5 * range.duration_s));
        // Beside measured delays it would only make up for those that are not known.
        let has_delay = !model.takes_measured_delays();
        let mut bounds = vec![(f64::MIN, f64::MAX, true), (delay.0, delay.1, has_delay)];
        for component in model.components() {
            let effect = component.effect();
            let has_law = !component.takes_measured_delays();
            let parameters = effect.spec().parameters.iter();
            let fitted = parameters.map(|parameter| parameter.fitted && has_law);
            bounds
                .extend(effect.bounds(range).into_iter().zip(fitted).map(|((l, h), f)| (l, h, f)));
        }
        let values = model.values();
        let all = bounds.iter().zip(&values).enumerate();
        let free = all.filter(|(_, ((_, _, fitted), value))| *fitted && !value.fixed);
        let (free, bounds): (Vec<_>, Vec<_>) = free
            .map(|(index, ((low, high, _), value))| {
                let low = value.min.map_or(*low, |min| min.max(*low));
                let high = value.max.map_or(*high, |max| max.min(*high));
                (index, Bounds { low, high })
            })
            .unzip();
        let flats = free.iter().zip(&bounds).map(|(index, bounds)| {
            if is_level(model, *index) {
                bounds.within(&range.thresholds(usize::MAX))
            } else {
                Vec::new()
            }
        });
        Self { flats: flats.collect(), free, bounds }
    }

    /// What a fit could do with a free parameter.
    pub(super) fn status(&self, covariance: &Covariance, free: usize) -> Status {
        let is_lost = |error| self.bounds[free].is_lost_in(error);
        match covariance.std_error(free) {
            _ if covariance.is_at_bound(free) => Status::AtBound,
            Some(error) if !is_lost(error) => Status::Fitted,
            _ => Status::Undetermined,
        }
    }

    /// All values of the model, with the free ones where the optimiser's variables are.
    pub(super) fn values(&self, start: &[f64], variables: &DVector<f64>) -> Vec<f64> {
        let mut values = start.to_vec();
        for ((index, bounds), variable) in self.free.iter().zip(&self.bounds).zip(variables.iter())
        {
            values[*index] = bounds.value(*variable);
        }
        values
    }
}

/// Whether a parameter of `model` is a level of the input.
fn is_level(model: &JointModel, index: usize) -> bool {
    let specs = model.components().iter().flat_map(|c| c.effect().spec().parameters);
    let of_effects = index.checked_sub(2);
    of_effects
        .and_then(|index| specs.clone().nth(index))
        .is_some_and(|p| p.dimension == Dimension::Input)
}
