//! Explain and add, until nothing significant is missing.

use super::attribution::{Grown, LeftOut};
use super::contribution::Attribution;
use super::eligible::{could_be_missing, signal_range};
use super::extension::ids;
use super::misfit::Misfit;
use super::options::Options;
use super::revision::{Change, Improvement, Revision};
use super::separate::separate;
use super::stepwise::{Ended, Step, add_stepwise};
use super::verdict::Verdict;
use super::workers::Workers;
use crate::diagnosis::compare_knowing;
use crate::fit::{Fit, FitRecord, fit_to_compare};
use crate::model::Component;

/// Adds what is missing from the model of `fit`, one effect after the other.
///
/// After each effect, those that were added before and have become useless are removed. At the
/// end, unless [`Options::keeps_refinements`], those without practical consequence go, too: see
/// [`Attribution`]. `done` is called with each revision; where it says no, nothing more is tried.
pub fn improve(
    record: &FitRecord<'_>,
    fit: Fit,
    options: &Options,
    workers: &impl Workers,
    mut done: impl FnMut(&Revision) -> bool,
) -> Improvement {
    let start = fit;
    let given = ids(&start.model);
    let first = Step::new(record, Change::Start, start.clone());
    let mut revisions = Vec::new();
    let mut visit = |step: &Step| {
        let Step { change, fit, lack_of_fit, mut ranking } = step.clone();
        separate(record, &mut ranking, workers);
        let comparison = compare_knowing(record, fit, lack_of_fit);
        let revision = Revision { change, comparison, ranking };
        let goes_on = done(&revision);
        revisions.push(revision);
        goes_on
    };
    let misfit = Misfit::of(record, &start);
    let (first, goes_on) = if misfit.is_far_beyond_noise() {
        climbed(record, first, options, &mut visit)
    } else {
        (first, true)
    };
    let ended = if goes_on {
        add_stepwise(record, first, &given, options, workers, misfit, &mut visit)
    } else {
        Ended { verdict: Verdict::MissingEffect, fit: first.fit, was_stopped: true }
    };
    let verdict = ended.verdict;
    let attribution = if ended.was_stopped {
        Attribution::default()
    } else {
        attributed(record, &start, ended.fit, options, workers, visit)
    };
    Improvement { revisions, verdict, attribution }
}

/// What an engineer tries first on a hydraulic joint, in this order.
const LADDER: [&str; 4] = ["dead_band", "input_saturation", "direction_gain", "end_stop"];

/// The model with the effects of the ladder, as far as they may be added, one after the other;
/// whether to go on.
///
/// Where the misfit is far beyond the noise, every effect is significant, and the one that
/// explains most by itself is often what several usual ones do together. Those of no consequence
/// go at the end.
fn climbed(
    record: &FitRecord<'_>,
    first: Step,
    options: &Options,
    visit: &mut impl FnMut(&Step) -> bool,
) -> (Step, bool) {
    let mut step = first;
    for effect in LADDER.iter().filter_map(|id| options.effects.iter().find(|e| e.spec().id == *id))
    {
        let added = ids(&step.fit.model).len();
        if added >= options.max_effects || !could_be_missing(record, &step.fit.model, *effect) {
            continue;
        }
        let model = step.fit.model.with(Component::neutral(*effect));
        let levels = record.input_levels();
        let Ok(fit) = fit_to_compare(record, &model, &signal_range(record, &model, &levels)) else {
            continue;
        };
        if !visit(&step) {
            return (step, false);
        }
        step = Step::new(record, Change::Added(effect.spec().id), fit);
    }
    (step, true)
}

/// What each effect of `whole` carries, without those of no consequence, which are removed one
/// after the other, the least first. `visit` sees each model on the way.
fn attributed(
    record: &FitRecord<'_>,
    first: &Fit,
    mut whole: Fit,
    options: &Options,
    workers: &impl Workers,
    mut visit: impl FnMut(&Step) -> bool,
) -> Attribution {
    let mut removed = Vec::new();
    loop {
        let grown = Grown { record, first, whole: &whole, options };
        let mut left_out = grown.left_out(workers);
        let may_go = |least: &_| !options.keeps_refinements && !LeftOut::has_consequence(least);
        let Some(least) = left_out.pop_if(|least| may_go(least)) else {
            return grown.attribution_of(&left_out, removed, workers);
        };
        removed.push(least.effect);
        if !visit(&Step::new(record, Change::Removed(least.effect), least.fit.clone())) {
            return Attribution::default();
        }
        whole = least.fit;
    }
}
