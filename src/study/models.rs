//! The model of every joint: compared, explained, improved, or known for a design.

use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

use super::estimate::JointEstimate;
use super::protocol::{Mode, Protocol, Watched};
use super::start::{as_it_is, best_fit, starts, typical_delay_s};
use crate::delay::{EstimateError, level_tolerance};
use crate::design::{FreeRunError, Suspects, SuspectsError, Uncertain};
use crate::diagnosis::{Comparison, compare, compare_unfitted, sensor_noise};
use crate::effect::Effect;
use crate::experiment::{Joint, Other, Supply, Trial};
use crate::explain::{
    AddError, Addition, Attribution, Explanation, Improvement, Options, Revision, Verdict, Workers,
};
use crate::explain::{add, explain, improve};
use crate::fit::{Fit, FitError, FitRecord, Horizon, Split};
use crate::model::JointModel;

/// What came of each joint: `None` where it has no model.
pub(crate) type OfJoints<T> = Vec<Option<Result<T, FitError>>>;

/// Compares each joint with its model: `None` where it has none.
///
/// The other `joints`, and those [beside](Watched::beside) them, are the ones that share the
/// supply with a joint: see [`Supply`].
/// `models` gives the model of a joint; it is not asked for plain integrators.
pub fn compare_joints<'a>(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: impl Into<Watched<'a>>,
    workers: &impl Workers,
) -> OfJoints<Comparison> {
    let watched = protocol.into();
    if watched.protocol.mode == Mode::AsItIs {
        let compared = |_: usize, record: &FitRecord<'_>, model| compare_unfitted(record, model);
        return for_each_joint((joints, estimates), models, watched, workers, (as_it_is, compared));
    }
    let compared = |_: usize, record: &FitRecord<'_>, fit| compare(record, fit);
    for_each_joint((joints, estimates), models, watched, workers, (best_fit, compared))
}

/// Says what each joint's model lacks: see [`explain`].
pub fn explain_joints<'a>(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: impl Into<Watched<'a>>,
    options: &Options,
    workers: &impl Workers,
) -> OfJoints<Explanation> {
    let watched = protocol.into();
    let work = |_: usize, record: &FitRecord<'_>, fit| {
        explain(record, fit, options, &watched.workers(workers))
    };
    for_each_joint((joints, estimates), models, watched, workers, (best_fit, work))
}

/// What is known of a model since it was made from the very logs that are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Known {
    /// The root mean square error by which it was judged, in output units.
    pub(crate) rmse: f64,
    /// The verdict on it.
    pub(crate) verdict: Verdict,
}

/// As [`explain_joints`], but for joints whose model is `known` and has the error that it had: it
/// is compared as it is, and nothing is fitted.
pub(crate) fn explain_unknown_joints(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    known: impl Fn(&Joint) -> Option<Known> + Sync,
    watched: Watched<'_>,
    options: &Options,
    workers: &impl Workers,
) -> OfJoints<Explanation> {
    /// By how much of itself the error may differ: what the order of a sum makes of it.
    const SAME: f64 = 1e-6;
    let as_known = |record: &FitRecord<'_>, starts: &[JointModel]| {
        let known = known(record.joint())?;
        let base = compare_unfitted(record, as_it_is(record, starts)?.ok()?);
        let is_same = (base.judged()?.rmse - known.rmse).abs() <= SAME * known.rmse;
        let (verdict, attribution) = (known.verdict, Attribution::default());
        is_same.then(|| Explanation { base, verdict, ranking: Vec::new(), attribution })
    };
    let prepare = |record: &FitRecord<'_>, starts: &[JointModel]| match as_known(record, starts) {
        Some(explanation) => Some(Ok(Err(explanation))),
        None => Some(best_fit(record, starts)?.map(Ok)),
    };
    let work = |_: usize, record: &FitRecord<'_>, prepared: Result<Fit, Explanation>| match prepared
    {
        Ok(fit) => explain(record, fit, options, &watched.workers(workers)),
        Err(explanation) => explanation,
    };
    for_each_joint((joints, estimates), models, watched, workers, (prepare, work))
}

/// Adds `effect` to each joint's model: see [`add`].
pub fn add_to_joints<'a>(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: impl Into<Watched<'a>>,
    effect: &'static dyn Effect,
    workers: &impl Workers,
) -> Vec<Option<Result<Addition, AddError>>> {
    let watched = protocol.into();
    let work = |_: usize, record: &FitRecord<'_>, fit: Fit| {
        add(record, fit, effect, &watched.workers(workers))
    };
    let added = for_each_joint((joints, estimates), models, watched, workers, (best_fit, work));
    added.into_iter().map(|result| Some(result?.map_err(AddError::from).flatten())).collect()
}

/// Adds to each joint's model what it lacks: see [`improve`]. `done` is called with the
/// index of the joint and each revision; where it says no, the joint is left as it is.
pub fn improve_joints<'a>(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: impl Into<Watched<'a>>,
    options: &Options,
    done: impl Fn(usize, &Revision) -> bool + Sync,
    workers: &impl Workers,
) -> OfJoints<Improvement> {
    let watched = protocol.into();
    let work = |index, record: &FitRecord<'_>, fit| {
        improve(record, fit, options, &watched.workers(workers), |revision| done(index, revision))
    };
    for_each_joint((joints, estimates), models, watched, workers, (best_fit, work))
}

/// Says what each joint's model is, how well its log knows the numbers, and how far its
/// predictions are off where it was not fitted; what the log does not determine is off by `share`
/// of its value.
///
/// A model that is given is fitted. Where none is, it is the one with which [`improve`] ends, or
/// the plain integrator if that is no farther off on parts of the log that are left out: a model
/// may follow a record better and predict it worse. Other joints are taken to be at rest, as it
/// is not known what they will do.
pub fn know_joints(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: Protocol,
    share: f64,
    workers: &impl Workers,
) -> OfJoints<Uncertain> {
    // The condition in which a plan is played is not known.
    let models = |joint: &Joint| models(joint).map(|model| model.in_trial("").into_owned());
    let work = |_: usize, record: &FitRecord<'_>, given: Fit| {
        let joint = record.joint();
        let record = FitRecord::new(joint, Split::Time(1.0), protocol.horizon);
        let improved = match models(joint) {
            Some(_) => None,
            None => improved(&record, &given.model, protocol.horizon, workers),
        };
        let given = (FreeRunError::of(joint, &given.model), given);
        let (free_run, fit) = surer(given, improved);
        let noise = sensor_noise(&joint.trials).unwrap_or(0.0).max(f64::MIN_POSITIVE);
        Uncertain { free_run, ..Uncertain::of_fit(&record, &fit, noise, share) }
    };
    for_each_joint((joints, estimates), models, protocol.into(), workers, (best_fit, work))
}

/// A model with what its predictions were off.
type Judged = (Option<FreeRunError>, Fit);

/// The one whose predictions were nearer.
fn surer(plain: Judged, improved: Option<Judged>) -> Judged {
    let largest = |judged: &Judged| judged.0.as_ref().map_or(f64::MAX, FreeRunError::largest);
    match improved {
        Some(improved) if largest(&improved) < largest(&plain) => improved,
        _ => plain,
    }
}

/// The model with which [`improve`] ends, fitted to the whole of `record`.
fn improved(
    record: &FitRecord<'_>,
    plain: &JointModel,
    horizon: Horizon,
    workers: &impl Workers,
) -> Option<Judged> {
    /// Effects that are added at most: of later ones a prediction gains little.
    const MOST_EFFECTS: usize = 5;
    // The condition in which a plan is played is not known.
    let options =
        Options { max_effects: MOST_EFFECTS, tries_conditions: false, ..Options::default() };
    let joint = record.joint();
    let part = part_of(joint);
    let judged = FitRecord::new(&part, Split::of(&part), horizon);
    let start = best_fit(&judged, std::slice::from_ref(plain))?.ok()?;
    let improvement = improve(&judged, start, &options, workers, |_| true);
    let last = improvement.revisions.into_iter().last()?.comparison.fit.assessed.model;
    let fit = best_fit(record, &[last])?.ok()?;
    Some((FreeRunError::of(joint, &fit.model), fit))
}

/// The part of a long record from which the structure of a model is found: blocks of its trials,
/// drawn at random as what is played may repeat itself. All of a record whose input is held for
/// long, of which blocks would show a few steps alone.
fn part_of(joint: &Joint) -> Joint {
    /// Samples that show the effects of a joint.
    const ENOUGH: usize = 4000;
    /// Samples of a block, and steps of the input that are to be in it.
    const BLOCK: usize = 500;
    const STEPS: usize = 4;
    let samples: usize = joint.trials.iter().map(Trial::len).sum();
    if samples <= ENOUGH + BLOCK || steps(joint) * BLOCK < STEPS * samples {
        return joint.clone();
    }
    let blocks = joint.trials.iter().enumerate().flat_map(|(trial, own)| {
        let count = (own.len() / BLOCK).max(1);
        (0..count).map(move |k| (trial, own.len() * k / count, own.len() * (k + 1) / count))
    });
    let mut blocks: Vec<_> = blocks.collect();
    blocks.shuffle(&mut ChaCha8Rng::seed_from_u64(0));
    let mut kept = 0;
    blocks.retain(|(_, from, to)| {
        kept += to - from;
        kept <= ENOUGH
    });
    blocks.sort_unstable();
    let piece =
        |(trial, from, to): &(usize, usize, usize)| joint.trials.get(*trial)?.part(*from, *to);
    let trials: Vec<Trial> = blocks.iter().filter_map(piece).collect();
    joint.of_trials(trials)
}

/// How often the input of `joint` changes from one sample to the next.
fn steps(joint: &Joint) -> usize {
    let tolerance = level_tolerance(&joint.trials);
    let changes = |pair: &&[f64]| matches!(pair, [a, b] if (b - a).abs() > tolerance);
    let steps = joint.trials.iter().map(|trial| trial.input().windows(2).filter(changes).count());
    steps.sum()
}

/// Fits two effects to each joint, each beside its model: see [`Suspects::of_record`].
pub fn suspect_joints(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: Protocol,
    effects: [&'static dyn Effect; 2],
    (noise, share): (Option<f64>, f64),
    workers: &impl Workers,
) -> Vec<Option<Result<Suspects, SuspectsError>>> {
    let work = |_: usize, record: &FitRecord<'_>, fit: Fit| {
        Suspects::of_record(record, &fit.model, effects, noise, share)
    };
    let suspects =
        for_each_joint((joints, estimates), models, protocol.into(), workers, (best_fit, work));
    let flat = |of: Result<Result<_, _>, FitError>| of.map_err(SuspectsError::from).flatten();
    suspects.into_iter().map(|result| result.map(flat)).collect()
}

/// These joints as others see them, with their typical delays.
pub(crate) fn others_of<'a>(
    joints: &'a [Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
) -> Vec<Other<'a>> {
    let other = |(joint, estimate)| Other { joint, delay_s: typical_delay_s((joint, estimate)) };
    joints.iter().zip(estimates).map(other).collect()
}

/// Prepares the model of each joint from its starts, and does `work` with the result.
fn for_each_joint<P, T: Send>(
    (joints, estimates): (&[Joint], &[Result<JointEstimate, EstimateError>]),
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    Watched { protocol, watch, others }: Watched<'_>,
    workers: &impl Workers,
    (prepare, work): (
        impl Fn(&FitRecord<'_>, &[JointModel]) -> Option<Result<P, FitError>> + Sync,
        impl Fn(usize, &FitRecord<'_>, P) -> T + Sync,
    ),
) -> OfJoints<T> {
    let Protocol { mode, split, horizon } = protocol;
    watch.more(joints.len());
    let supply = Supply::of(others_of(joints, estimates).into_iter().chain(others.iter().copied()));
    let pairs: Vec<_> = joints.iter().zip(estimates).enumerate().collect();
    let one_joint = |(index, (joint, estimate)): &(usize, (&Joint, &Result<JointEstimate, _>))| {
        let estimated: Vec<_> = estimate.iter().flat_map(JointEstimate::estimated).collect();
        let split = split.unwrap_or_else(|| Split::of(joint));
        let record = FitRecord::new(joint, split, horizon).with_others(supply.beside(*index));
        let starts = starts(mode, joint, &estimated, &models)?;
        let prepared = prepare(&record, &starts);
        watch.done();
        Some(prepared?.map(|prepared| work(*index, &record, prepared)))
    };
    workers.map(&pairs, one_joint)
}
