//! Whether a record determines an effect of a fitted model.
//!
//! An effect none of whose parameters is determined may lower the error all the same: at the bound of
//! its exponent or level it is another shape than its name says. That is no reason to name it.

use super::extension::components_of;
use crate::effect::{Dimension, Effect, Parameter, RecordRange, Stage, UNLIMITED, by_id};
use crate::fit::{self, AssessedModel, FitRecord, Status};
use crate::model::Component;

/// Whether the record of `fit` determines each of the effects `new` of its model, within what it reaches,
/// and a finer form of a simple effect in what it has more than that.
pub(super) fn are_determined(fit: &AssessedModel, new: &[&'static str]) -> bool {
    components_of(&fit.model, new).all(|one| {
        is_reached(fit, one)
            && is_determined(fit, one)
            && (one.effect().spec().refines.is_none() || is_distinct(fit, one, DISTINCT))
    })
}

/// Whether the record of `fit` determines at least one parameter of an effect of its model, or, with
/// nothing to fit, does not have to.
///
/// A level between two that the input had, or a limit between two places of the joint, is nowhere
/// else than between them, which is enough.
pub(super) fn is_determined(fit: &AssessedModel, component: &Component) -> bool {
    let mut free = free_parameters(fit, component).peekable();
    free.peek().is_none()
        || free.any(|(parameter, status)| match status {
            Status::Fitted => true,
            Status::Undetermined => is_limit(component.effect(), parameter),
            // Of a value that changes nothing nearby no bound can be far.
            Status::AtBound => switches_at(component.effect(), parameter),
            Status::BeyondReach | Status::Fixed => false,
        })
}

/// Standard errors by which a value is another than that at which its effect does nothing.
pub(super) const DISTINCT: f64 = 2.0;

/// Standard errors by which it is beside an effect that looks like it: two frictions and an overlap
/// together follow many a curve that is none of them. Chosen: of 252 records with known effects
/// (`docs/hidden_effect_table.md`) none loses one by it.
pub(super) const BESIDE_ITS_LIKE: f64 = 3.0;

/// Whether a value of an effect is known to be another than that at which it does nothing, by
/// `errors` standard errors, where there are any.
///
/// What an effect that it contains has as well, as a lag its time constant, does not count: that
/// could be there without the rest.
pub(super) fn is_distinct(fit: &AssessedModel, component: &Component, errors: f64) -> bool {
    let spec = component.effect().spec();
    let contained = spec.absorbs.iter().filter_map(|id| by_id(id));
    let theirs: Vec<&str> =
        contained.flat_map(|effect| effect.spec().parameters).map(|one| one.name).collect();
    let own = fitted(fit, component).filter(|(parameter, _)| !theirs.contains(&parameter.name));
    let distances = own.filter_map(|(parameter, fitted)| distance_from_neutral(parameter, fitted));
    let mut known = distances.peekable();
    known.peek().is_none() || known.any(|distance| distance > errors)
}

/// How many standard errors a value is from the one at which it does nothing, where there are any. Of a
/// scale or a level that does nothing where it is infinite it is the reciprocal that is 0 there, and as many
/// of its standard errors from 0 as the value is of its own; a place of the joint is at 0 as well as
/// elsewhere.
pub(super) fn distance_from_neutral(parameter: &Parameter, fitted: &fit::Parameter) -> Option<f64> {
    let is_infinite =
        parameter.neutral.abs() >= UNLIMITED && parameter.dimension != Dimension::Output;
    let neutral = if is_infinite { 0.0 } else { parameter.neutral };
    Some((fitted.value - neutral).abs() / fitted.std_error?)
}

/// Whether an effect acts within what the record of `fit` reaches: not one of which all levels or
/// limits lie beyond, unless another of its parameters is determined, as the soft knee of a limit.
fn is_reached(fit: &AssessedModel, component: &Component) -> bool {
    let of_limits = |(parameter, _): &(&Parameter, Status)| is_limit(component.effect(), parameter);
    let (limits, others): (Vec<_>, Vec<_>) = free_parameters(fit, component).partition(of_limits);
    limits.is_empty()
        || limits.iter().any(|(_, status)| *status != Status::BeyondReach)
        || others.iter().any(|(_, status)| *status == Status::Fitted)
}

/// The name of a fitted parameter of one of the effects `new` of a fitted model whose value is not plausible;
/// none where all are.
pub(super) fn implausible(
    record: &FitRecord<'_>,
    fit: &AssessedModel,
    new: &[&'static str],
) -> Option<String> {
    let range = record.range_for(&fit.model);
    components_of(&fit.model, new).find_map(|one| implausible_parameter(one, &range))
}

/// The name of a fitted parameter of an effect whose value is not plausible; none where all are.
fn implausible_parameter(component: &Component, range: &RecordRange<'_>) -> Option<String> {
    let spec = component.effect().spec();
    let values = component.parameters().iter().zip(spec.parameters);
    let fitted = values.filter(|(value, parameter)| !value.fixed && parameter.fitted);
    let mut odd = fitted.filter(|(value, parameter)| !parameter.allows(value.value, range));
    odd.next().map(|(_, parameter)| format!("{}.{}", spec.id, parameter.name))
}

/// Whether a parameter of `effect` is a level of the input or a limit of the output.
fn is_limit(effect: &dyn Effect, parameter: &Parameter) -> bool {
    let spec = effect.spec();
    match parameter.dimension {
        Dimension::Input => spec.stage == Stage::Input,
        Dimension::Output => spec.acts_on_state,
        _ => false,
    }
}

/// Whether `effect` does not change with a parameter but in jumps: a limit of the output, or a level of
/// what remembers on which side of it the input was.
fn switches_at(effect: &dyn Effect, parameter: &Parameter) -> bool {
    let has_memory = effect.spec().memory > 0;
    is_limit(effect, parameter) && (parameter.dimension == Dimension::Output || has_memory)
}

/// The parameters of an effect that were free in `fit`, and what the record says of them.
fn free_parameters<'a>(
    fit: &'a AssessedModel,
    component: &'a Component,
) -> impl Iterator<Item = (&'static Parameter, Status)> + 'a {
    let all = fitted(fit, component).map(|(parameter, fitted)| (parameter, fitted.status));
    all.filter(|(_, status)| *status != Status::Fixed)
}

/// The parameters of an effect beside those of `fit`.
pub(super) fn fitted<'a>(
    fit: &'a AssessedModel,
    component: &'a Component,
) -> impl Iterator<Item = (&'static Parameter, &'a fit::Parameter)> + 'a {
    let spec = component.effect().spec();
    spec.parameters.iter().filter_map(move |parameter| {
        let name = format!("{}.{}", spec.id, parameter.name);
        Some((parameter, fit.parameters.iter().find(|fitted| fitted.name == name)?))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{EndStop, VariableDelay};

    #[test]
    fn a_scale_that_may_be_infinite_is_not_known_to_be_another() {
        let distance = |effect: &dyn Effect, name: &str, value: f64, std_error: f64| {
            let own = effect.spec().parameters.iter().find(|own| own.name == name).unwrap();
            let (name, std_error) = (name.to_owned(), Some(std_error));
            let fitted = fit::Parameter { name, value, std_error, status: Status::Fitted };
            distance_from_neutral(own, &fitted).unwrap()
        };
        assert!((distance(&VariableDelay, "size_scale", 9.0, 18.0) - 0.5).abs() < 1e-12);
        assert!((distance(&VariableDelay, "size", -0.3, 0.1) - 3.0).abs() < 1e-12);
        assert!(distance(&EndStop, "low", 0.1, 0.2) > 1e9, "an end of the way may be at 0");
    }
}
