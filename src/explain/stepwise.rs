//! Stepwise addition: effects are added to a model one after the other, until nothing
//! significant is missing, and removed again where later ones make them useless.
//!
//! # References
//! T. Hastie, R. Tibshirani and J. Friedman, "The Elements of Statistical Learning", 2009,
//! section 3.3.2 (forward stepwise selection); M. A. Efroymson, "Multiple regression analysis",
//! 1960 (with removal).

use std::ops::ControlFlow;

use super::candidate::Candidate;
use super::decide::Judge;
use super::exchange::changed;
use super::extension::ids;
use super::judgement::Refusal;
use super::misfit::{Errors, Misfit};
use super::options::{Options, Tried};
use super::ranking::{Beside, Scope, rank, rank_beside};
use super::removal::Removal;
use super::revision::Change;
use super::verdict::Verdict;
use super::workers::Workers;
use crate::delay::are_strokes;
use crate::diagnosis::{BEYOND_NOISE, ErrorFigures, LackOfFit, lack_of, sensor_noise};
use crate::fit::{Fit, FitRecord, fit_to_compare};
use crate::model::JointModel;

/// A model on the way.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) change: Change,
    pub(super) fit: Fit,
    pub(super) lack_of_fit: Option<LackOfFit>,
    /// Whether the error is far beyond the noise of the sensor, which no test has to show.
    is_large: bool,
    /// The candidates for what comes next, best first; none where none was looked for.
    pub(super) ranking: Vec<Candidate>,
}

impl Step {
    pub(super) fn new(record: &FitRecord<'_>, change: Change, fit: Fit) -> Self {
        let noise = sensor_noise(&record.measured().trials);
        let error = ErrorFigures::of_record(record, &fit.evaluation);
        let is_beyond = |(error, noise): (ErrorFigures, f64)| error.rmse > BEYOND_NOISE * noise;
        let is_large = error.zip(noise).is_some_and(is_beyond) && !record.is_exact(&fit.evaluation);
        let lack_of_fit = lack_of(record, &fit);
        Self { change, lack_of_fit, is_large, fit, ranking: Vec::new() }
    }

    /// Whether no lack of fit is shown; where there are too few samples to test for one, whether the
    /// error is not far beyond the noise.
    fn is_adequate(&self) -> bool {
        self.lack_of_fit.map_or(!self.is_large, |test| test.adequate)
    }

    /// Whether nothing can be missing: the residual is hardly more than the noise.
    fn is_at_the_noise(&self) -> bool {
        self.lack_of_fit.map_or(!self.is_large, |test| test.adequate && test.is_near_noise())
    }

    /// Ranks what may be missing, where that is not done; whether anything is. The first of
    /// the ranking is then one that is significant, if any is.
    ///
    /// A model that passes the test lacks something still when an effect shows it beyond
    /// doubt: the test knows shapes, the effects know physics.
    pub(super) fn rank_missing(
        &mut self,
        record: &FitRecord<'_>,
        misfit: Misfit,
        options: &Options,
        workers: &impl Workers,
    ) -> bool {
        if self.is_at_the_noise() && options.tried == Tried::WhereLacking {
            return false;
        }
        if self.ranking.is_empty() {
            let scope = if self.is_adequate() { Scope::SingleEffects } else { Scope::Everything };
            let judge = Judge::new(record, &self.fit, misfit, options);
            self.ranking = rank(&judge, scope, workers);
        }
        let lacks = !self.is_at_the_noise()
            && (!self.is_adequate() || self.ranking.iter().any(Candidate::is_beyond_doubt));
        match self.ranking.iter().position(Candidate::is_significant) {
            _ if !lacks && options.tried == Tried::Always => self.refuse_all(),
            _ if !lacks => self.ranking.clear(),
            Some(index) => self.ranking[..=index].rotate_right(1),
            None => {}
        }
        lacks
    }
}

impl Step {
    /// Refuses all candidates, as nothing is missing.
    fn refuse_all(&mut self) {
        for candidate in &mut self.ranking {
            candidate.judgement.refusal = Some(Refusal::NothingMissing);
        }
    }
}

/// Magnitudes of the input, with rest, that many curves of a valve match. Chosen: two parameters of a
/// curve and the gain match three.
const FEW_LEVELS: usize = 3;

/// How stepwise addition ended.
pub(super) struct Ended {
    pub(super) verdict: Verdict,
    /// The last model.
    pub(super) fit: Fit,
    /// Whether nothing more was to be tried.
    pub(super) was_stopped: bool,
    /// What would have come next, had it a practical consequence.
    pub(super) refinements: Vec<&'static str>,
}

/// Adds to `first` what it lacks, one effect after the other, and removes what has become
/// useless. `visit` sees each step once; where it says no, nothing more is tried.
///
/// Effects of `given` stay. Without [`Options::keeps_refinements`] only effects are added that
/// have a practical consequence.
pub(super) fn add_stepwise(
    record: &FitRecord<'_>,
    first: Step,
    given: &[&'static str],
    options: &Options,
    workers: &impl Workers,
    misfit: Misfit,
    mut visit: impl FnMut(&Step) -> bool,
) -> Ended {
    let ended =
        |verdict, fit, was_stopped| Ended { verdict, fit, was_stopped, refinements: Vec::new() };
    // Few levels, as those of strokes, are matched by many curves.
    let are_few = record.input_levels().len() <= FEW_LEVELS;
    let matched_by_many = are_strokes(&record.joint().trials) || are_few;
    let mut step = first;
    loop {
        if !step.rank_missing(record, misfit, options, workers) {
            let was_stopped = !visit(&step);
            return ended(Verdict::Adequate, step.fit, was_stopped);
        }
        let mut judge = Judge::new(record, &step.fit, misfit, options);
        judge.are_levels_few = matched_by_many;
        let added = ids(&step.fit.model).len().saturating_sub(given.len());
        let others: &[Beside] = match added {
            _ if step.is_adequate() => &[],
            0 => &[Beside::Pairs, Beside::FreeForms],
            _ => &[Beside::FreeForms],
        };
        let found = chosen(&mut step.ranking, others, record, &judge, workers);
        if found.is_none() && step.ranking.iter().any(Candidate::is_significant) {
            let refused = step.ranking.iter().find(|candidate| candidate.judgement.is_sound());
            let refinements = refused.map(|refused| refused.effects.clone()).unwrap_or_default();
            let is_explained = misfit.is_explained(&Errors::of(record, &step.fit));
            let verdict = if is_explained { Verdict::Adequate } else { Verdict::Unexplained };
            let was_stopped = !visit(&step);
            return Ended { refinements, ..ended(verdict, step.fit, was_stopped) };
        }
        if let Some(index) = found {
            step.ranking[..=index].rotate_right(1);
        }
        let found = found.and(step.ranking.first().cloned());
        let explained = found.is_some();
        let goes_on = visit(&step);
        let Some(found) = found.filter(|_| goes_on && added < options.max_effects) else {
            let verdict = if explained { Verdict::MissingEffect } else { Verdict::Unexplained };
            return ended(verdict, step.fit, !goes_on);
        };
        let changes = match found.effects[..] {
            [first, second] => vec![Change::Added(first), Change::Added(second)],
            _ => vec![Change::between(&step.fit.model, &found.fit.model, found.newest())],
        };
        let (between, last) = steps_to(record, &step.fit.model, &changes, found.fit.on(record));
        for next in between {
            step = next;
            if !visit(&step) {
                return ended(Verdict::MissingEffect, step.fit, true);
            }
        }
        step = last;
        let removal = Removal { given, kept: found.effects, options, misfit };
        step = match exchanged(record, step, removal, workers, &mut visit) {
            ControlFlow::Continue(step) => step,
            ControlFlow::Break(ended) => return ended,
        };
    }
}

/// The place in `ranking` of what is added: a single effect, or else the first of `others` of which one is.
fn chosen(
    ranking: &mut Vec<Candidate>,
    others: &[Beside],
    record: &FitRecord<'_>,
    judge: &Judge<'_, '_>,
    workers: &impl Workers,
) -> Option<usize> {
    let single = judge.judge_all(ranking);
    if single.is_some() {
        return single;
    }
    let mut beside =
        others.iter().filter_map(|what| found_beside(*what, ranking, record, judge, workers));
    let (index, found) = beside.next()?;
    *ranking = found;
    Some(index)
}

/// The ranking of `singles`, of which none is added though some show, beside pairs or curves of any
/// form, and the place of the one that is added.
///
/// Where these do not come near the noise either, they are not what is missing, unless a law of the model
/// is a curve: then one of any form takes the place of that. Pairs are tried where the model is far from
/// the noise.
fn found_beside(
    what: Beside,
    singles: &[Candidate],
    record: &FitRecord<'_>,
    judge: &Judge<'_, '_>,
    workers: &impl Workers,
) -> Option<(usize, Vec<Candidate>)> {
    let is_far = |errors: &Errors| judge.misfit.is_far_from_noise(errors);
    let is_due = what == Beside::FreeForms || is_far(&Errors::of(record, judge.base));
    if !is_due || !singles.iter().any(Candidate::is_significant) {
        return None;
    }
    let mut ranking = rank_beside(judge, (singles, what), workers);
    let index = judge.judge_all(&mut ranking)?;
    let found = &ranking[index];
    let change = Change::between(&judge.base.model, &found.fit.model, found.newest());
    let takes_a_place = what == Beside::FreeForms && matches!(change, Change::Replaced { .. });
    (takes_a_place || !is_far(&found.fit.errors)).then_some((index, ranking))
}

/// `step` with effects removed or exchanged for as long as that is better; how the search ended
/// where `visit` says no.
fn exchanged(
    record: &FitRecord<'_>,
    mut step: Step,
    mut removal: Removal<'_>,
    workers: &impl Workers,
    visit: &mut impl FnMut(&Step) -> bool,
) -> ControlFlow<Ended, Step> {
    while let Some((exchange, fit)) = removal.better(record, &step.fit, workers) {
        let (between, last) = steps_to(record, &step.fit.model, &exchange.0, fit);
        for next in between.into_iter().chain([last]) {
            if !visit(&step) {
                let is_adequate = step.is_adequate();
                let verdict = if is_adequate { Verdict::Adequate } else { Verdict::MissingEffect };
                return ControlFlow::Break(Ended {
                    verdict,
                    fit: step.fit,
                    was_stopped: true,
                    refinements: Vec::new(),
                });
            }
            step = next;
        }
    }
    ControlFlow::Continue(step)
}

/// The steps by which `changes` make the model of `fit` of `model`, the last apart: one for each change,
/// which need not be better on the way, or one for all where these cannot be fitted.
pub(super) fn steps_to(
    record: &FitRecord<'_>,
    model: &JointModel,
    changes: &[Change],
    fit: Fit,
) -> (Vec<Step>, Step) {
    let (last, before) = changes.split_last().unwrap_or((&Change::Start, &[]));
    let mut model = model.clone();
    let on_the_way = |change: &Change| {
        model = changed(&model, *change).into_iter().next()?;
        let fit = fit_to_compare(record, &model, &record.range_for(&model)).ok()?;
        Some(Step::new(record, *change, fit))
    };
    let between: Option<Vec<Step>> = before.iter().map(on_the_way).collect();
    let change = if between.is_some() { last } else { &before[0] };
    (between.unwrap_or_default(), Step::new(record, *change, fit))
}
