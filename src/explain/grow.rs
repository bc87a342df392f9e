//! A model that grows effect by effect, until nothing significant is left.

use super::Workers;
use super::candidate::Candidate;
use super::evidence::Noise;
use super::race::{Options, fitted, parameters, race};
use super::verdict::Verdict;
use crate::diagnosis::{LackOfFit, floor_of, lack_of};
use crate::fit::{Fit, Record};
use crate::model::JointModel;

/// What a revision changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Nothing: the model as it was given.
    Start,
    /// An effect was added.
    Added(&'static str),
    /// An effect that others made useless was removed.
    Removed(&'static str),
}

/// A model on the way.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub(super) change: Change,
    pub(super) fit: Fit,
    pub(super) lack_of_fit: Option<LackOfFit>,
    /// The candidates for what comes next, best first; none where none was looked for.
    pub(super) ranking: Vec<Candidate>,
}

impl Step {
    pub(super) fn new(record: &Record<'_>, change: Change, fit: Fit) -> Self {
        Self { change, lack_of_fit: lack_of(record, &fit), fit, ranking: Vec::new() }
    }

    /// Whether no lack of fit is shown.
    pub(super) fn is_adequate(&self) -> bool {
        self.lack_of_fit.is_none_or(|test| test.adequate)
    }
}

/// Adds to `first` what it lacks, one effect after the other, and removes what has become
/// useless. `visit` sees each step once; where it says no, nothing more is tried.
///
/// Effects of `given` stay.
pub(super) fn grow(
    record: &Record<'_>,
    first: Step,
    given: &[&'static str],
    options: &Options,
    workers: &impl Workers,
    mut visit: impl FnMut(&Step) -> bool,
) -> Verdict {
    let mut step = first;
    loop {
        if step.is_adequate() {
            visit(&step);
            return Verdict::Adequate;
        }
        if step.ranking.is_empty() {
            let floor = floor_of(record, &step.fit).unwrap_or(0.0);
            step.ranking = race(record, &step.fit, floor, options, workers);
        }
        let found = step.ranking.first().filter(|best| best.is_significant()).cloned();
        let added = ids(&step.fit.model).len().saturating_sub(given.len());
        let goes_on = visit(&step) && added < options.max_effects;
        let Some(found) = found.filter(|_| goes_on) else {
            return Verdict::of(step.ranking.first().is_some_and(Candidate::is_significant));
        };
        let newest = found.effects.first().copied().unwrap_or_default();
        step = Step::new(record, Change::Added(newest), found.fit);
        while let Some((id, fit)) = useless(record, &step.fit, given, newest, workers) {
            if !visit(&step) {
                return Verdict::of(!step.is_adequate());
            }
            step = Step::new(record, Change::Removed(id), fit);
        }
    }
}

/// Ids of the effects of `model`.
pub(super) fn ids(model: &JointModel) -> Vec<&'static str> {
    model.components().iter().map(|component| component.effect().spec().id).collect()
}

/// An effect without which the model is as good, and the model without it: none that was
/// given, nor the newest.
fn useless(
    record: &Record<'_>,
    whole: &Fit,
    given: &[&'static str],
    newest: &str,
    workers: &impl Workers,
) -> Option<(&'static str, Fit)> {
    let own = ids(&whole.model).into_iter();
    let may_go: Vec<&'static str> = own.filter(|id| *id != newest && !given.contains(id)).collect();
    let without = |id: &&'static str| Some((*id, fitted(record, &whole.model.without(id))?));
    let smaller = workers.map(&may_go, without).into_iter().flatten();
    let noise = Noise::of(record, &whole.evaluation);
    let criterion =
        |fit: &Fit| noise.evidence(record, &fit.evaluation, parameters(fit)).criterion();
    let best = smaller.min_by(|a, b| criterion(&a.1).total_cmp(&criterion(&b.1)))?;
    (criterion(&best.1) <= criterion(whole)).then_some(best)
}
