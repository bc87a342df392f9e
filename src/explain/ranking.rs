//! Every effect added to a model in turn, and fitted: which of them explains the misfit best.

use super::candidate::Candidate;
use super::comparison::{MUCH_LESS, compared};
use super::decide::Judge;
use super::eligible::{eligible, free_forms, steady_refinements};
use super::extension::Extension;
use super::limiting_case::put_limiting_cases_first;
use super::options::Tried;
use super::outcome::FitOutcome;
use super::pairs::pairs;
use super::screening::{Entrants, Surveyed, fitted, surveyed};
use super::workers::Workers;
use crate::diagnosis::{NEAR_NOISE, sensor_noise};
use crate::effect::{Effect, RecordRange};
use crate::model::{Component, JointModel};

/// What is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    /// Each effect by itself.
    SingleEffects,
    /// Measured delays, too, and pairs where no single effect shows: for a model that lacks
    /// something for sure.
    Everything,
}

/// Effects that are fitted, of those that were surveyed, at most. Chosen: each more costs a fit; of an
/// excavator's arm six leave 0.95 deg, since the survey ranks the effect that is added after them, and nine
/// 0.88.
const FINALISTS: usize = 9;

/// Effects that are fitted before it is asked whether one of them can be added: so many that a ranking says
/// what the best is better than, and two processors are busy with.
const FITTED_AT_ONCE: usize = 4;

/// What the cost of a finalist may be after the survey, in parts of the least. Chosen: with 1.3 six
/// measured joints get the same models in 96 % of the time.
const HOPELESS: f64 = 3.0;

/// Ranks the effects that `judge` is asked about by how well its model with each of them, fitted,
/// explains the record, best first.
///
/// Of a residual that is rounding nothing is left to explain.
pub(super) fn rank(judge: &Judge<'_, '_>, scope: Scope, workers: &impl Workers) -> Vec<Candidate> {
    let Judge { record, base, .. } = *judge;
    if record.is_exact(&base.evaluation) {
        return Vec::new();
    }
    let range = record.range_for(&base.model);
    let search = Search::new(judge, &range);
    let ranking = search.singles(scope, workers);
    let shows = |ranking: &[Candidate]| ranking.iter().any(Candidate::is_significant);
    if scope == Scope::SingleEffects || shows(&ranking) {
        return ranking;
    }
    let paired = search.beside_pairs(&ranking, workers);
    if shows(&paired) { paired } else { search.beside_free_forms(&ranking, workers) }
}

/// What is tried beside single effects, none of which can be added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Beside {
    /// Pairs of effects.
    Pairs,
    /// Effects of a free form, each in the place of the laws that it absorbs: what no law explains may
    /// follow a curve of any form.
    FreeForms,
}

/// A [`rank`]ing of `singles` beside what else may explain the record.
pub(super) fn rank_beside(
    judge: &Judge<'_, '_>,
    (singles, what): (&[Candidate], Beside),
    workers: &impl Workers,
) -> Vec<Candidate> {
    let range = judge.record.range_for(&judge.base.model);
    let search = Search::new(judge, &range);
    match what {
        Beside::Pairs => search.beside_pairs(singles, workers),
        Beside::FreeForms => search.beside_free_forms(singles, workers),
    }
}

/// A model, and what may be missing from it.
struct Search<'a, 'r> {
    judge: &'a Judge<'a, 'r>,
    /// Standard deviation of the measurement noise, output units.
    noise_floor: f64,
    effects: Vec<&'static dyn Effect>,
    /// Finer forms of some of the effects.
    refinements: Vec<&'static dyn Effect>,
    range: &'a RecordRange<'a>,
}

impl<'a, 'r> Search<'a, 'r> {
    fn new(judge: &'a Judge<'a, 'r>, range: &'a RecordRange<'a>) -> Self {
        let Judge { record, base, options, .. } = *judge;
        let noise_floor = sensor_noise(&record.measured().trials).unwrap_or(0.0);
        let effects = eligible(record, &base.model, options);
        let refinements = steady_refinements(record, &base.model, options);
        Self { judge, noise_floor, effects, refinements, range }
    }

    /// The base with each effect by itself, ranked.
    fn singles(&self, scope: Scope, workers: &impl Workers) -> Vec<Candidate> {
        let with = |effect: &&'static dyn Effect| {
            let id = effect.spec().id;
            let models = self.judge.base.model.placements(&Component::neutral(*effect));
            models.into_iter().map(move |model| (id, model))
        };
        let models: Vec<_> = self.effects.iter().flat_map(with).collect();
        let mut extensions = self.finalists(&models, workers);
        if let Some(other) = self.as_first_order() {
            extensions.retain(|one| one.effects != other.effects || one.fit.cost < other.fit.cost);
            let is_known = extensions.iter().any(|one| one.effects == other.effects);
            extensions.extend(Some(other).filter(|_| !is_known));
        }
        if !self.is_explained(&extensions) {
            let refined = self.refined(&extensions, workers);
            extensions.extend(refined);
        }
        if scope == Scope::Everything && !self.is_explained(&extensions) {
            extensions.extend(self.with_measured_delays());
        }
        self.compared(extensions)
    }

    /// The best of `models`, fitted: as many as it takes until one of them can be added, and all where they
    /// are asked for.
    fn finalists(
        &self,
        models: &[(&'static str, JointModel)],
        workers: &impl Workers,
    ) -> Vec<Extension> {
        let are_asked_for = self.judge.options.tried == Tried::Always;
        let entrants = if are_asked_for { Entrants::All } else { Entrants::Promising };
        let mut surveys = surveyed(self.judge.record, models, self.range, entrants, workers);
        if !are_asked_for {
            let limit = surveys.first().map_or(0.0, |(_, best)| HOPELESS * best.cost);
            let hopeful = surveys.partition_point(|(_, survey)| survey.cost <= limit);
            surveys.truncate(hopeful.clamp(FITTED_AT_ONCE, FINALISTS));
            self.put_likely_first(&mut surveys);
        }
        let mut extensions = Vec::new();
        for some in surveys.chunks(FITTED_AT_ONCE) {
            if !are_asked_for && self.has_one_to_add(&extensions) {
                break;
            }
            let fits = fitted(self.judge.record, some, self.range, workers).into_iter();
            extensions.extend(fits.map(|(id, fit)| Extension { effects: vec![id], fit }));
        }
        extensions
    }

    /// Puts those of `surveys` first that are most likely on both parts of the record, as a ranking does.
    fn put_likely_first(&self, surveys: &mut [Surveyed<'_, &'static str>]) {
        let outline = |((id, _), survey): &Surveyed<'_, &'static str>| Extension {
            effects: vec![*id],
            fit: FitOutcome::of(self.judge.record, survey.on(self.judge.record, self.range)),
        };
        let outlines = surveys.iter().map(outline).collect();
        let ranked = compared(self.judge.record, self.judge.base, self.noise_floor, outlines);
        surveys.sort_by_key(|((id, _), _)| ranked.iter().position(|one| one.effects == [*id]));
    }

    /// Whether nothing speaks against one of `extensions`.
    fn has_one_to_add(&self, extensions: &[Extension]) -> bool {
        let candidates =
            compared(self.judge.record, self.judge.base, self.noise_floor, extensions.to_vec());
        candidates.iter().any(|one| self.judge.judge(one).is_added())
    }

    /// The candidates of `ranking` among the best pairs of effects.
    fn beside_pairs(&self, ranking: &[Candidate], workers: &impl Workers) -> Vec<Candidate> {
        let mut extensions =
            pairs(self.judge.record, self.judge.base, &self.effects, self.range, workers);
        extensions.extend(ranking.iter().map(Candidate::extension));
        self.compared(extensions)
    }

    /// The candidates of `ranking` beside effects of a free form.
    fn beside_free_forms(&self, ranking: &[Candidate], workers: &impl Workers) -> Vec<Candidate> {
        let free = free_forms(self.judge.record, &self.judge.base.model, self.judge.options);
        let mut extensions = self.with_each(&free, workers);
        extensions.extend(ranking.iter().map(Candidate::extension));
        self.compared(extensions)
    }

    /// The base as the first order that the output follows, where it does or is likely to follow the
    /// input itself: too far from an integrator for a descent to find it.
    fn as_first_order(&self) -> Option<Extension> {
        let (effects, model) = self.judge.record.follower()?.started_at(&self.judge.base.model)?;
        let is_allowed = |id: &&str| self.effects.iter().any(|effect| effect.spec().id == *id);
        if !effects.iter().all(is_allowed) {
            return None;
        }
        self.extended(effects, &model).filter(|one| one.fit.cost < self.judge.base.cost)
    }

    /// The base with each of `effects`, fitted.
    fn with_each(&self, effects: &[&'static dyn Effect], workers: &impl Workers) -> Vec<Extension> {
        let with = |effect: &&'static dyn Effect| {
            let model = self.judge.base.model.with(Component::neutral(*effect));
            self.extended(vec![effect.spec().id], &model)
        };
        workers.map(effects, with).into_iter().flatten().collect()
    }

    /// `model`, which is the base with these `effects` more, fitted.
    fn extended(&self, effects: Vec<&'static str>, model: &JointModel) -> Option<Extension> {
        let fit = FitOutcome::fitted(self.judge.record, model, self.range)?;
        Some(Extension { effects, fit })
    }

    /// Whether one of `extensions` comes near the noise.
    fn is_explained(&self, extensions: &[Extension]) -> bool {
        let limit = NEAR_NOISE * self.noise_floor;
        extensions.iter().any(|one| one.fit.errors.largest() <= limit)
    }

    /// The finer forms that leave much less than all of `extensions`: a limit that only one direction
    /// reaches is hardly seen as one of both.
    fn refined(&self, extensions: &[Extension], workers: &impl Workers) -> Vec<Extension> {
        let mut refined = self.with_each(&self.refinements, workers);
        refined.retain(|finer| {
            let leaves_less =
                |one: &Extension| finer.fit.errors.leave_less_than(MUCH_LESS, &one.fit.errors);
            extensions.iter().all(leaves_less)
        });
        refined
    }

    /// The base with each step's own delay as it was measured, where these differ: delays may follow any
    /// law, or none.
    fn with_measured_delays(&self) -> Option<Extension> {
        let Judge { record, base, .. } = *self.judge;
        let component = self.effects.iter().find_map(|effect| Component::measured(*effect))?;
        let id = component.effect().spec().id;
        let model = base.model.with(component);
        if record.measured_delays(&model) == 0 || !record.delays_differ() {
            return None;
        }
        self.extended(vec![id], &model)
    }

    fn compared(&self, extensions: Vec<Extension>) -> Vec<Candidate> {
        let mut candidates =
            compared(self.judge.record, self.judge.base, self.noise_floor, extensions);
        put_limiting_cases_first(self.judge.record, &mut candidates, self.judge.options);
        candidates
    }
}
