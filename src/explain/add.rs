//! One effect more in a model, because a user says so.

use super::evidence::Noise;
use super::race::{parameters, range};
use crate::diagnosis::{Comparison, compare};
use crate::effect::Effect;
use crate::fit::{Fit, FitError, Record, fit};
use crate::model::{Component, JointModel};

/// A model before and after an effect was added.
#[derive(Clone, Debug)]
pub struct Addition {
    /// The model as it was, fitted.
    pub before: Comparison,
    /// The model with the effect, fitted.
    pub after: Comparison,
    /// Probability of so much or more when the effect is not there, on the training part;
    /// `None` where the two models do not nest.
    pub p_value: Option<f64>,
}

/// Why an effect cannot be added.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AddError {
    /// The model has it.
    #[error("`{effect}` is in the model already; `tauscope compare --fit` fits it again")]
    AlreadyThere {
        /// Its id.
        effect: &'static str,
    },
    /// The model has an effect that contains it.
    #[error("`{effect}` is a part of `{whole}`, which is in the model already")]
    Contained {
        /// Its id.
        effect: &'static str,
        /// The id of the other.
        whole: &'static str,
    },
    /// The model cannot be fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// Fits the model of `base` with `effect`, which starts where it changes nothing.
///
/// # Errors
/// [`AddError`] when the model has the effect, or cannot be fitted with it.
pub fn add(
    record: &Record<'_>,
    base: Fit,
    effect: &'static dyn Effect,
) -> Result<Addition, AddError> {
    check(&base.model, effect)?;
    let model = base.model.with(Component::neutral(effect));
    let levels = record.input_levels();
    let with = fit(record, &model, &range(record, &model, &levels))?;
    let noise = Noise::of(record, &with);
    let evidence = |fit: &Fit| noise.evidence(record, &fit.evaluation, parameters(fit));
    let p_value = evidence(&with).p_value_against(&evidence(&base));
    Ok(Addition {
        before: compare(record, base),
        after: compare(record, with),
        p_value: effect.nests().then_some(p_value),
    })
}

fn check(model: &JointModel, effect: &'static dyn Effect) -> Result<(), AddError> {
    let effect = effect.spec().id;
    let mut specs = model.components().iter().map(|component| component.effect().spec());
    if specs.clone().any(|spec| spec.id == effect) {
        return Err(AddError::AlreadyThere { effect });
    }
    match specs.find(|spec| spec.absorbs.contains(&effect)) {
        Some(whole) => Err(AddError::Contained { effect, whole: whole.id }),
        None => Ok(()),
    }
}
