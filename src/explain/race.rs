//! Every effect added to a model in turn, and fitted.

use super::Workers;
use super::candidate::Candidate;
use super::evidence::Noise;
use super::pairs::pairs;
use crate::diagnosis::{ErrorFigures, NEAR_NOISE, floor_of};
use crate::effect::{Effect, REGISTRY, RecordRange, Spec};
use crate::fit::{Fit, FitRecord, Part, Survey, fit_to_compare, survey};
use crate::model::{Component, JointModel};

/// What a race is about.
#[derive(Clone, Debug)]
pub struct Options {
    /// The effects that take part.
    pub effects: Vec<&'static dyn Effect>,
    /// Effects that may be added one after the other.
    pub max_effects: usize,
}

/// Effects that are added one after the other where nothing else is said: a cylinder has so
/// many.
pub const MAX_EFFECTS: usize = 8;

/// The whole catalogue, up to [`MAX_EFFECTS`].
impl Default for Options {
    fn default() -> Self {
        Self { effects: REGISTRY.to_vec(), max_effects: MAX_EFFECTS }
    }
}

/// What takes part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Field {
    /// Each effect by itself.
    OneByOne,
    /// Measured delays, too, and pairs where no single effect shows: for a model that lacks
    /// something for sure.
    All,
}

/// A model that took part.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) effects: Vec<&'static str>,
    pub(super) fit: Fit,
}

/// What measured delays must leave, in parts of what a law of the delay leaves, to take its
/// place.
pub(super) const MUCH_LESS: f64 = 0.8;

/// Effects that are fitted to the end, of those that were surveyed: at most, and at least.
const FINALISTS: (usize, usize) = (6, 3);

/// What the error of a finalist may be after the survey, in parts of the least.
const HOPELESS: f64 = 3.0;

/// Surveys `base` with each effect of `options` that it has not, fits the best few to the
/// end and ranks them, best first.
///
/// A long record is surveyed in part first, and as a whole where that shows nothing.
pub(super) fn race(
    record: &FitRecord<'_>,
    base: &Fit,
    noise_floor: f64,
    options: &Options,
    field: Field,
    workers: &impl Workers,
) -> Vec<Candidate> {
    let [thinned, training] = [record.thinned(), record.for_training()];
    let of = |surveyed| race_on(record, surveyed, base, noise_floor, options, field, workers);
    let ranking = of(&thinned);
    let is_whole = thinned.windows().len() == training.windows().len();
    let shows = |ranking: &[Candidate]| ranking.iter().any(Candidate::is_significant);
    let ranking = if is_whole || shows(&ranking) { ranking } else { of(&training) };
    if field == Field::OneByOne || shows(&ranking) {
        return ranking;
    }
    let paired = beside_pairs(record, base, noise_floor, options, workers, &ranking);
    if shows(&paired) { paired } else { ranking }
}

/// The candidates of `ranking` among the best pairs of effects.
fn beside_pairs(
    record: &FitRecord<'_>,
    base: &Fit,
    noise_floor: f64,
    options: &Options,
    workers: &impl Workers,
    ranking: &[Candidate],
) -> Vec<Candidate> {
    let effects = able(record, base, options);
    let levels = record.input_levels();
    let range = range(record, &base.model, &levels);
    let single = |candidate: &Candidate| Entry {
        effects: candidate.effects.clone(),
        fit: candidate.fit.clone(),
    };
    let mut entries = pairs(record, base, &effects, &range, workers);
    entries.extend(ranking.iter().map(single));
    ranked(record, base, noise_floor, entries)
}

/// The effects of `options` that could be missing from the model of `base`.
fn able(record: &FitRecord<'_>, base: &Fit, options: &Options) -> Vec<&'static dyn Effect> {
    let able = |effect: &&&'static dyn Effect| {
        let spec = effect.spec();
        takes_part(record, &base.model, spec) && is_due(&base.model, spec, options)
    };
    options.effects.iter().filter(able).copied().collect()
}

fn race_on(
    record: &FitRecord<'_>,
    surveyed: &FitRecord<'_>,
    base: &Fit,
    noise_floor: f64,
    options: &Options,
    field: Field,
    workers: &impl Workers,
) -> Vec<Candidate> {
    let effects = able(record, base, options);
    let levels = record.input_levels();
    let range = range(record, &base.model, &levels);
    let glance = |effect: &&'static dyn Effect| {
        let model = base.model.with(Component::neutral(*effect));
        Some((effect.spec().id, survey(surveyed, &model, &range).ok()?))
    };
    let glances = workers.map(&effects, glance).into_iter().flatten();
    let mut glances: Vec<(&'static str, Survey)> = glances.collect();
    glances.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    let (most, least) = FINALISTS;
    let limit = glances.first().map_or(0.0, |best| HOPELESS * best.1.cost);
    let hopeful = glances.iter().filter(|entry| entry.1.cost <= limit).count();
    glances.truncate(hopeful.clamp(least, most));
    let to_the_end = |(id, survey): &(&'static str, Survey)| {
        let fit = fit_to_compare(record, &survey.model, &range).ok()?;
        Some(Entry { effects: vec![*id], fit })
    };
    let mut entries: Vec<Entry> = workers.map(&glances, to_the_end).into_iter().flatten().collect();
    if field == Field::All {
        entries.extend(with_measured_delays(record, base, noise_floor, &effects, &range, &entries));
    }
    ranked(record, base, noise_floor, entries)
}

/// `base` with each step's own delay as it was measured, where none of `entries` comes near
/// the noise: delays may follow any law, or none.
fn with_measured_delays(
    record: &FitRecord<'_>,
    base: &Fit,
    noise_floor: f64,
    effects: &[&'static dyn Effect],
    range: &RecordRange<'_>,
    entries: &[Entry],
) -> Option<Entry> {
    let error = |entry: &Entry| ErrorFigures::of(record, &entry.fit.evaluation, Part::Training);
    let errors = entries.iter().filter_map(error).map(|error| error.rmse);
    let least = errors.fold(f64::INFINITY, f64::min);
    if least <= NEAR_NOISE * noise_floor {
        return None;
    }
    let measured = |effect: &&'static dyn Effect| Component::measured(*effect);
    let component = effects.iter().find_map(measured)?;
    let id = component.effect().spec().id;
    let model = base.model.with(component);
    if record.measured_delays(&model) == 0 {
        return None;
    }
    let fit = fit_to_compare(record, &model, range).ok()?;
    Some(Entry { effects: vec![id], fit })
}

/// How large the signals of `record` are, for a model with about the gain of `model`.
pub(super) fn range<'l>(
    record: &FitRecord<'_>,
    model: &JointModel,
    levels: &'l [f64],
) -> RecordRange<'l> {
    record.range(levels, model.gain.value.abs() * levels.last().copied().unwrap_or(1.0))
}

/// Whether `effect` could be missing: it is not there already, nor contained in one that is,
/// and the record could show it.
pub(super) fn takes_part(record: &FitRecord<'_>, model: &JointModel, effect: &Spec) -> bool {
    let is_it = |spec: &Spec| spec.id == effect.id || spec.absorbs.contains(&effect.id);
    !has(model, is_it) && (effect.id != "supply_droop" || record.has_others())
}

/// Whether it is time to look for `effect`: what it refines is in the model, or is not to be
/// looked for.
pub(super) fn is_due(model: &JointModel, effect: &Spec, options: &Options) -> bool {
    let is_sought = |id| options.effects.iter().any(|effect| effect.spec().id == id);
    effect.refines.is_none_or(|id| has(model, |spec| spec.id == id) || !is_sought(id))
}

fn has(model: &JointModel, is_it: impl Fn(&Spec) -> bool) -> bool {
    model.components().iter().any(|component| is_it(component.effect().spec()))
}

fn ranked(
    record: &FitRecord<'_>,
    base: &Fit,
    noise_floor: f64,
    entries: Vec<Entry>,
) -> Vec<Candidate> {
    let error = |fit: &Fit, part| ErrorFigures::of(record, &fit.evaluation, part);
    let Some(best) = entries.iter().min_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost)) else {
        return Vec::new();
    };
    let noise = Noise::of(record, &best.fit);
    let evidence = |fit: &Fit| noise.evidence(record, fit);
    let of_base = evidence(base);
    let (trained, validated) = (error(base, Part::Training), error(base, Part::Validation));
    let square = |e: Option<ErrorFigures>| e.map_or(f64::NAN, |e| e.rmse * e.rmse);
    let candidate = |entry: Entry| {
        let evidence = evidence(&entry.fit);
        let training = error(&entry.fit, Part::Training);
        let validation = error(&entry.fit, Part::Validation);
        let (before, after) = match (validated, validation) {
            (Some(before), Some(after)) => (before.rmse, after.rmse),
            _ => (square(trained).sqrt(), square(training).sqrt()),
        };
        let (behind, deviance) = (evidence.criterion(), evidence.deviance());
        let tested = if nests(&entry) { evidence } else { evidence.apart() };
        let p_value = tested.p_value_against(&of_base);
        let misfit = (square(trained) - noise_floor * noise_floor).max(f64::MIN_POSITIVE);
        Candidate {
            effects: entry.effects,
            training,
            validation,
            error_reduction_percent: 100.0 * (1.0 - after / before),
            training_reduction_percent: 100.0 * (1.0 - (square(training) / square(trained)).sqrt()),
            p_value,
            share_of_misfit: (square(trained) - square(training)) / misfit,
            behind,
            deviance,
            indistinguishable_from: Vec::new(),
            separated_by: Vec::new(),
            noise_floor: floor_of(record, &entry.fit),
            fit: entry.fit,
        }
    };
    let mut candidates: Vec<Candidate> = entries.into_iter().map(candidate).collect();
    candidates.sort_by(|a, b| a.behind.total_cmp(&b.behind));
    keep_one_form(&mut candidates);
    let least = candidates.first().map_or(0.0, |best| best.behind);
    let alike = alike(&candidates);
    for (candidate, alike) in candidates.iter_mut().zip(alike) {
        candidate.behind -= least;
        candidate.indistinguishable_from = alike;
    }
    candidates
}

/// Of an effect that is there by its law and by measured delays keeps one: the law, which says
/// more, where measured delays do not leave much less.
fn keep_one_form(candidates: &mut Vec<Candidate>) {
    let is_measured = |candidate: &Candidate| candidate.fit.model.takes_measured_delays();
    let forms: Vec<_> =
        candidates.iter().map(|c| (c.effects.clone(), is_measured(c), c.rmse())).collect();
    candidates.retain(|candidate| {
        let measured = is_measured(candidate);
        let mut twins = forms
            .iter()
            .filter(|(effects, of_twin, _)| *effects == candidate.effects && *of_twin != measured);
        twins.all(|(_, _, of_twin)| {
            let (law, delays) =
                if measured { (*of_twin, candidate.rmse()) } else { (candidate.rmse(), *of_twin) };
            measured == (delays < MUCH_LESS * law)
        })
    });
}

/// Whether the base is a special case of an entry.
fn nests(entry: &Entry) -> bool {
    let added = entry.fit.model.components().iter().map(Component::effect);
    let mut added = added.filter(|effect| entry.effects.contains(&effect.spec().id));
    added.all(Effect::nests)
}

/// Twice the difference in log-likelihood below which two models are as likely: a likelihood
/// of one in 150.
pub(crate) const ALIKE: f64 = 10.0;

/// For each candidate the others under which the record is as likely, but for what noise
/// does.
fn alike(candidates: &[Candidate]) -> Vec<Vec<&'static str>> {
    let of = |one: &Candidate| {
        let others = candidates.iter().filter(|other| other.effects != one.effects);
        let others = others.filter(|other| (other.deviance - one.deviance).abs() < ALIKE);
        others.flat_map(|other| other.effects.iter().copied()).collect()
    };
    candidates.iter().map(of).collect()
}
