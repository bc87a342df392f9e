//! What each effect of a model carries of the error, and what could stand in its place.
//!
//! The share of an effect is what the error grows by when that effect alone is left out and the
//! rest is fitted again, in parts of the misfit of the model to which effects were added:
//!
//! ```text
//! share = (e_without − e) / (e₀ − s)
//! ```
//!
//! with the root-mean-square errors `e` of the model, `e_without` without the effect and `e₀` of
//! the first model, on the whole record or on the part that was not fitted, whichever grows more,
//! and `s` the noise of the sensor. It is 1 at most, since rather than a worse model one would keep
//! the first. Effects that do the same work have small shares each, and shares need not sum up to
//! one.
//!
//! # References
//! J. Lei, M. G'Sell, A. Rinaldo, R. J. Tibshirani and L. Wasserman, "Distribution-free
//! predictive inference for regression", Journal of the American Statistical Association 113
//! (2018), 1094-1111 (leave-one-covariate-out).

use super::candidate::ALIKE;
use super::contribution::{Attribution, Contribution};
use super::decide::is_founded;
use super::determined::is_determined;
use super::eligible::{are_as_simple, could_be_missing, is_due};
use super::evidence::NoiseMemory;
use super::exchange::{Exchange, exchanges_for};
use super::extension::{components_of, ids};
use super::likeness::looks_like;
use super::limiting_case::limiting_case;
use super::misfit::{Errors, Misfit, generalizes};
use super::options::Options;
use super::outcome::FitOutcome;
use super::removal::{FINALISTS, fitted_of, fitted_with};
use super::workers::Workers;
use crate::effect::RecordRange;
use crate::fit::{AssessedModel, Fit, FitRecord, Score};
use crate::model::Component;

/// A model, and the one to which its effects were added.
pub(super) struct Grown<'a, 'r> {
    pub(super) record: &'a FitRecord<'r>,
    pub(super) first: &'a FitOutcome,
    pub(super) whole: &'a Fit,
    pub(super) misfit: Misfit,
    pub(super) options: &'a Options,
}

/// An effect that was left out, its share, and the rest fitted again.
pub(super) struct LeftOut {
    pub(super) effect: &'static str,
    pub(super) share: f64,
    pub(super) fit: FitOutcome,
}

/// The share below which an effect that the record does not determine is a refinement. Chosen: what
/// carries a tenth of the misfit is there under one name or another, and its bound is said.
const UNDETERMINED: f64 = 0.1;

impl Grown<'_, '_> {
    /// Each effect that was added left out in turn, the largest share first.
    pub(super) fn left_out(&self, workers: &impl Workers) -> Vec<LeftOut> {
        let given = ids(&self.first.model);
        let mut added = ids(&self.whole.model);
        added.retain(|id| !given.contains(id));
        let without = |effect: &&'static str| {
            let fit = self.without(effect)?;
            Some(LeftOut { effect, share: self.share(&fit), fit })
        };
        let mut left_out: Vec<_> = workers.map(&added, without).into_iter().flatten().collect();
        left_out.sort_by(|a, b| b.share.total_cmp(&a.share));
        left_out
    }

    /// Whether what was left out has no practical consequence, or little of it and no parameter that the
    /// record determines.
    pub(super) fn is_refinement(&self, one: &LeftOut) -> bool {
        let mut components = self.whole.model.components().iter();
        let component = components.find(|component| component.effect().spec().id == one.effect);
        let is_known = component.is_some_and(|component| is_determined(self.whole, component));
        !self.has_consequence(one) || !is_known && one.share < UNDETERMINED
    }

    /// The effects that look like `effect` and would not show beside it in the whole model, of which
    /// `score` is.
    fn hidden_beside<'s>(
        &'s self,
        effect: &'static str,
        score: &'s Score<'_>,
    ) -> impl Iterator<Item = &'static str> + 's {
        let model = &self.whole.model;
        let alike = self.options.effects.iter().filter(move |other| {
            let spec = other.spec();
            looks_like(effect, spec.id)
                && !spec.is_free_form
                && !spec.absorbs.contains(&effect)
                && could_be_missing(self.record, model, **other)
                && is_due(model, spec, self.options)
        });
        let hidden = alike.filter(move |other| {
            score.hides(&model.with(Component::neutral(**other)), &self.range())
        });
        hidden.map(|other| other.spec().id)
    }

    /// How large the signals of the record are for the whole model.
    fn range(&self) -> RecordRange<'_> {
        self.record.range_for(&self.whole.model)
    }

    /// Whether what was left out has a practical consequence.
    fn has_consequence(&self, one: &LeftOut) -> bool {
        let own = Errors::of(self.record, self.whole);
        one.share >= self.misfit.least_share(&one.fit.errors)
            || self.misfit.has_consequence(&one.fit.errors, &own)
    }

    /// What is attributed to which effect.
    pub(super) fn attribution(&self, workers: &impl Workers) -> Attribution {
        let left_out = self.left_out(workers);
        let exchanged = self.exchanged(&left_out, workers);
        self.attribution_of(&left_out, &exchanged, Vec::new())
    }

    /// The model with each effect of consequence exchanged for one, or two, that look like it, fitted.
    pub(super) fn exchanged(
        &self,
        left_out: &[LeftOut],
        workers: &impl Workers,
    ) -> Vec<(Exchange, FitOutcome)> {
        let found = left_out.iter().filter(|one| self.has_consequence(one));
        self.with_each_exchanged(found.map(|one| one.effect), workers)
    }

    /// The model with each of `effects` exchanged for one, or two, that look like it, fitted.
    fn with_each_exchanged(
        &self,
        effects: impl Iterator<Item = &'static str>,
        workers: &impl Workers,
    ) -> Vec<(Exchange, FitOutcome)> {
        let others = |old| exchanges_for(self.record, &self.whole.model, old, self.options);
        let (free, lawful): (Vec<_>, Vec<_>) = effects.partition(|old| self.is_any_form(old));
        let exchanges =
            |of: Vec<&'static str>| of.into_iter().flat_map(others).collect::<Vec<Exchange>>();
        let mut exchanged = fitted_with(self.record, self.whole, &exchanges(lawful), workers);
        // Which laws a free form resembles most is asked, though they leave more.
        let kept = |costs: &[f64]| costs.len().min(FINALISTS);
        exchanged.extend(fitted_of(self.record, self.whole, &exchanges(free), kept, workers));
        exchanged
    }

    /// The exchange that leaves as little and is as likely with the fewest parameters, where it
    /// needs fewer than the model: of such models the simpler one is named. A friction without
    /// inertia is a dead band. In the place of an effect that does not show the feature after which it is
    /// named it need not be as likely: a resonance that does not swing is a lag, and its second pole a detail.
    fn simpler<'f>(
        &self,
        exchanged: &'f [(Exchange, FitOutcome)],
    ) -> Option<&'f (Exchange, FitOutcome)> {
        let noise = NoiseMemory::of(self.record, self.whole);
        let of_whole = noise.evidence(self.record, self.whole).criterion();
        let is_as_likely = |fit: &FitOutcome| {
            noise.evidence(self.record, &fit.on(self.record)).criterion() < of_whole + ALIKE
        };
        let own = Errors::of(self.record, self.whole);
        let count = |fit: &AssessedModel| fit.parameters.len();
        let fewer = exchanged.iter().filter(|(_, fit)| count(fit) < count(self.whole));
        let as_little = fewer.filter(|(exchange, fit)| {
            let new: Vec<&str> = exchange.new_effects().collect();
            self.leaves_as_little(fit)
                && is_founded(self.record, fit, &new, self.options)
                && generalizes(&own, &fit.errors)
                && (is_as_likely(fit)
                    || self.is_to_limiting_case(exchange)
                    || exchange.old().is_some_and(|old| self.is_any_form(old)))
        });
        as_little.min_by_key(|(_, fit)| count(fit))
    }

    /// The exchanges that lead to a simpler model that leaves as little, and the models: one, or one after a lag or a rate limit was put to the other side of the valve. Where the model limits the
    /// rate after the valve and the plant before it, a gain by direction looks like a weight.
    pub(super) fn simplified(
        &self,
        exchanged: &[(Exchange, FitOutcome)],
        workers: &impl Workers,
    ) -> Vec<(Exchange, FitOutcome)> {
        if let Some(simpler) = self.simpler(exchanged) {
            return vec![simpler.clone()];
        }
        let changes_side = |(exchange, fit): &&(Exchange, FitOutcome)| {
            exchange.one_for_one().is_some_and(|(old, new)| are_as_simple(old, new))
                && self.leaves_as_little(fit)
        };
        let behind = |moved: &(Exchange, FitOutcome)| {
            let whole = moved.1.on(self.record);
            let added = ids(&whole.model).into_iter();
            let others = added.filter(|id| {
                moved.0.new_effects().all(|new| new != *id) && !ids(&self.first.model).contains(id)
            });
            let grown = Grown { whole: &whole, ..*self };
            let exchanged = grown.with_each_exchanged(others, workers);
            Some(vec![moved.clone(), grown.simpler(&exchanged)?.clone()])
        };
        exchanged.iter().filter(changes_side).find_map(behind).unwrap_or_default()
    }

    /// Whether an exchange is that for the limiting case of which the record shows no more.
    fn is_to_limiting_case(&self, exchange: &Exchange) -> bool {
        let Some((old, new)) = exchange.one_for_one() else { return false };
        let case = |old| limiting_case(self.record, self.whole, old, self.options);
        let old = [old];
        let mut cases = components_of(&self.whole.model, &old).filter_map(case);
        cases.any(|case| case.effects == [new])
    }

    /// What is attributed to which effect, given what each leaves behind, what was `exchanged` for
    /// it, and what has no consequence beside it.
    pub(super) fn attribution_of(
        &self,
        left_out: &[LeftOut],
        exchanged: &[(Exchange, FitOutcome)],
        mut refinements: Vec<&'static str>,
    ) -> Attribution {
        let (found, small): (Vec<_>, Vec<_>) =
            left_out.iter().partition(|one| self.has_consequence(one));
        let score = Score::of(self.record, &self.whole.model, &self.range());
        let alternatives = |one: &LeftOut| {
            let own = exchanged.iter().filter(|(exchange, fit)| {
                exchange.old() == Some(one.effect) && self.share(fit) < self.hardly(one, fit)
            });
            let mut others: Vec<Vec<_>> =
                own.map(|(exchange, _)| exchange.new_effects().collect()).collect();
            // Beside one that will do alone, another says nothing.
            let alone: Vec<_> =
                others.iter().filter(|one| one.len() == 1).flatten().copied().collect();
            others.retain(|other| other.len() == 1 || !other.iter().any(|id| alone.contains(id)));
            others
        };
        let contribution = |one: &LeftOut| Contribution {
            effect: one.effect,
            error_share: one.share,
            error_without: one.fit.errors.judged(),
            alternatives: alternatives(one),
            hidden: score.iter().flat_map(|of| self.hidden_beside(one.effect, of)).collect(),
        };
        refinements.extend(small.iter().map(|one| one.effect));
        let own = Errors::of(self.record, self.whole);
        let is_credible = |one: &&LeftOut| self.misfit.is_credible(&one.fit.errors, &own);
        let (credible, doubtful): (Vec<_>, Vec<_>) = found.into_iter().partition(is_credible);
        Attribution {
            found: credible.into_iter().map(contribution).collect(),
            doubtful: doubtful.into_iter().map(contribution).collect(),
            refinements,
        }
    }

    /// Whether what the error of `fit` is larger by has no consequence.
    fn leaves_as_little(&self, fit: &FitOutcome) -> bool {
        self.share(fit) < self.misfit.least_share(&fit.errors)
    }

    /// The share by which the error may be larger with another effect in the place of one, for the two
    /// to be alternatives. A curve of any form, or one that does not show the feature after which it is
    /// named, is resembled by the law that has most of its share.
    fn hardly(&self, one: &LeftOut, other: &FitOutcome) -> f64 {
        /// The part of its share that such a law may miss. Chosen: half, as of a credible effect.
        const RESEMBLES: f64 = 0.5;
        let least = self.misfit.least_share(&other.errors);
        if self.is_any_form(one.effect) { least.max(RESEMBLES * one.share) } else { least }
    }

    /// Whether an effect of the whole model has a free form, or does not show the feature after which it
    /// is named.
    fn is_any_form(&self, id: &'static str) -> bool {
        let range = self.range();
        let effect = [id];
        let mut component = components_of(&self.whole.model, &effect);
        component.any(|one| {
            let effect = one.effect();
            effect.spec().is_free_form || !effect.shows_its_form(&one.plain(), &range)
        })
    }

    /// The model without `effect`, the rest fitted again.
    fn without(&self, effect: &str) -> Option<FitOutcome> {
        let model = self.whole.model.without(effect);
        if ids(&model) == ids(&self.first.model) {
            return Some(self.first.clone());
        }
        let range = self.record.range_for(&model);
        FitOutcome::fitted(self.record, &model, &range)
    }

    /// What the error is larger in `fit` than in the whole model, in parts of the misfit of the
    /// first.
    fn share(&self, fit: &FitOutcome) -> f64 {
        let own = Errors::of(self.record, self.whole);
        self.misfit.share_of_either(&fit.errors, &own).min(1.0)
    }
}
