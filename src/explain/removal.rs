//! What can be removed from a model, or exchanged, after an effect was added.

use super::candidate::ALIKE;
use super::comparison::MUCH_LESS;
use super::decide::is_founded;
use super::evidence::NoiseMemory;
use super::exchange::{Exchange, by_two, in_place_of_all, replacements};
use super::extension::ids;
use super::misfit::{Errors, Misfit, generalizes};
use super::options::Options;
use super::outcome::FitOutcome;
use super::revision::Change;
use super::screening::fit_best;
use super::workers::Workers;
use crate::fit::{Fit, FitRecord, survey};
use crate::model::JointModel;

/// The p-value below which windows show that a change does harm, whatever the criterion says.
/// Chosen: the usual 1 %.
const HARM: f64 = 0.01;

/// What the cost of a changed model may be after its survey, in parts of the whole model's.
/// Chosen: what is worse by more does not become better by a fit.
const WORSE: f64 = 1.3;

/// What the error of the whole record with two effects in the place of one, or with a finer form of one,
/// must be in parts of that without, whatever the criterion says, which is less sure where more is
/// missing. Chosen: 2 % less, as a single effect has to explain.
const LESS: f64 = 0.98;

/// Exchanges that are fitted, at most. Chosen: each more costs a fit.
pub(super) const FINALISTS: usize = 6;

/// What may be made simpler or better of a model with a new effect.
pub(super) struct Removal<'a> {
    /// Effects that stay: those of the model that was given.
    pub(super) given: &'a [&'static str],
    /// Effects that stay: they were chosen with all others in the model.
    pub(super) kept: Vec<&'static str>,
    pub(super) options: &'a Options,
    pub(super) misfit: Misfit,
}

impl Removal<'_> {
    /// A model that is as likely without one of the effects of `whole`, or more with one other
    /// or two in the place of one.
    pub(super) fn better(
        &mut self,
        record: &FitRecord<'_>,
        whole: &Fit,
        workers: &impl Workers,
    ) -> Option<(Exchange, Fit)> {
        let own = Errors::of(record, whole);
        let exchanges = self.changes(record, &whole.model);
        let tried = fitted_with(record, whole, &exchanges, workers);
        let noise = NoiseMemory::of(record, whole);
        let of_whole = noise.evidence(record, whole);
        let judged = tried.into_iter().filter_map(|(exchange, fit)| {
            let evidence = noise.evidence(record, &fit.on(record));
            let does_harm =
                of_whole.is_nearer_over_windows(&evidence, HARM) || !generalizes(&own, &fit.errors);
            // More parameters in the place of an effect are worth as much as a further effect.
            let is_worth_it = fit.parameters.len() <= whole.parameters.len()
                || self.options.keeps_refinements
                || self.misfit.has_consequence(&own, &fit.errors);
            // Two effects with fewer parameters than one are the simpler explanation.
            let is_unusual =
                exchange.is_unusual() && fit.parameters.len() >= whole.parameters.len();
            let leaves_less = if exchange.has_free_form() {
                fit.errors.leave_less_than(MUCH_LESS, &own)
            } else {
                !is_unusual || fit.errors.leave_less_than(LESS, &own)
            };
            // Two in the place of one have to be ahead of the one, too.
            let hurdle = if is_unusual { ALIKE } else { 0.0 };
            let behind = evidence.criterion() - of_whole.criterion() + hurdle;
            let new: Vec<&str> = exchange.new_effects().collect();
            let is_founded = is_founded(record, &fit, &new, self.options);
            let is_better = behind < 0.0 && leaves_less && !does_harm && is_worth_it;
            // Laws need not be as likely as a curve of any form.
            let is_law = exchange.is_for_free_form()
                && fit.parameters.len() < whole.parameters.len()
                && !self.misfit.has_consequence(&fit.errors, &own);
            ((is_better || is_law) && is_founded).then_some((behind, (exchange, fit)))
        });
        let (_, (exchange, fit)) = judged.min_by(|a, b| a.0.total_cmp(&b.0))?;
        self.kept.extend(exchange.new_effects());
        Some((exchange, fit.on(record)))
    }

    /// Removals of effects that may go, and exchanges for those that look like them.
    ///
    /// The effect that was chosen last was chosen among all single ones, but not among pairs.
    fn changes(&self, record: &FitRecord<'_>, model: &JointModel) -> Vec<Exchange> {
        let was_added = |id: &&'static str| !self.given.contains(id);
        let may_go = |id: &&'static str| was_added(id) && !self.kept.contains(id);
        let others = |old: &'static str| replacements(record, model, old, self.options);
        let added: Vec<&'static str> = ids(model).into_iter().filter(was_added).collect();
        let old: Vec<&'static str> = added.iter().copied().filter(may_go).collect();
        let removals = old.iter().map(|id| Exchange::alone(Change::Removed(id)));
        let single = removals.chain(old.iter().flat_map(|old| others(old)));
        let of_two = added.iter().flat_map(|old| by_two(record, model, old, self.options));
        let of_all = in_place_of_all(record, model, &added, self.options);
        single.chain(of_two).chain(of_all).collect()
    }
}

/// The models after the best few of `exchanges`, of those that a survey does not rule out, fitted.
pub(super) fn fitted_with(
    record: &FitRecord<'_>,
    whole: &Fit,
    exchanges: &[Exchange],
    workers: &impl Workers,
) -> Vec<(Exchange, FitOutcome)> {
    if exchanges.is_empty() {
        return Vec::new();
    }
    let range = record.range_for(&whole.model);
    let Ok(of_whole) = survey(record, &whole.model, &range) else { return Vec::new() };
    let kept = |costs: &[f64]| {
        costs.iter().filter(|cost| **cost < WORSE * of_whole.cost).count().min(FINALISTS)
    };
    fitted_of(record, whole, exchanges, kept, workers)
}

/// The models after the best few of `exchanges`, fitted; `kept` says how many, of the ascending costs of
/// their surveys.
pub(super) fn fitted_of(
    record: &FitRecord<'_>,
    whole: &Fit,
    exchanges: &[Exchange],
    kept: impl FnOnce(&[f64]) -> usize,
    workers: &impl Workers,
) -> Vec<(Exchange, FitOutcome)> {
    let range = record.range_for(&whole.model);
    let after = |(index, exchange): (usize, &Exchange)| {
        exchange.applied(&whole.model).into_iter().map(move |model| (index, model))
    };
    let models: Vec<_> = exchanges.iter().enumerate().flat_map(after).collect();
    let fits = fit_best(record, &models, &range, kept, workers);
    fits.into_iter().map(|(index, fit)| (exchanges[index].clone(), fit)).collect()
}
