//! All joints and trials in parallel; the only file that names rayon.
//!
//! Each trial is computed by one thread alone and results come back in the order of the
//! input, so that they are the same bit for bit on any number of threads.

use rayon::prelude::*;

use crate::delay::sweep::{Grid, JointSweep, RunDelays};
use crate::delay::{
    Automatic, Chosen, Decision, EstimateError, Estimator, Settings, TrialEstimate, choose,
};
use crate::design::{
    Design, DesignError, Limits, Suspects, SuspectsError, TestRig, Uncertain, shortest,
};
use crate::diagnosis::{Comparison, compare, compare_unfitted, floor_of};
use crate::effect::{Effect, RecordRange};
use crate::experiment::{Joint, Trial, activity};
use crate::explain::{AddError, Addition, add};
use crate::explain::{Explanation, Improvement, Options, Revision, Workers, explain, improve};
use crate::fit::{Assessment, Fit, FitError, FitRecord, Horizon, Split, assess, fit};
use crate::model::{JointModel, integrators};
use crate::numerics::median;

/// The delays of one joint in all its trials.
#[derive(Clone, Debug, PartialEq)]
pub struct JointEstimate {
    /// One result per trial of the joint, in the same order.
    pub trials: Vec<Result<TrialEstimate, EstimateError>>,
    /// The settings that it was made with.
    pub settings: Settings,
    /// Which of them were chosen from the record, and from what.
    pub chosen: Option<Chosen>,
}

impl JointEstimate {
    /// The trials that have an estimate.
    pub fn estimated(&self) -> impl Iterator<Item = &TrialEstimate> + '_ {
        self.trials.iter().filter_map(|trial| trial.as_ref().ok())
    }

    /// Why the trials that have none do not.
    pub fn failed(&self) -> impl Iterator<Item = &EstimateError> + '_ {
        self.trials.iter().filter_map(|trial| trial.as_ref().err())
    }
}

/// Estimates every trial of every joint; `done` is called after each of them.
///
/// A joint fails when all its trials do, with the first trial's error, or when they are all
/// too short for two lines.
pub fn estimate_joints(
    joints: &[Joint],
    settings: &Settings,
    done: impl Fn() + Sync,
) -> Vec<Result<JointEstimate, EstimateError>> {
    estimate_joints_with(joints, settings, Automatic::default(), done)
}

/// The same with settings of which some are chosen for each joint from its own record: see
/// [`choose`].
pub fn estimate_joints_with(
    joints: &[Joint],
    settings: &Settings,
    automatic: Automatic,
    done: impl Fn() + Sync,
) -> Vec<Result<JointEstimate, EstimateError>> {
    let one_joint = |joint: &Joint| {
        if !automatic.any() {
            return estimate_one(joint, settings, &done);
        }
        settings.check()?;
        let (settings, chosen) = choose(&joint.trials, settings, automatic);
        let estimate = estimate_one(joint, &settings, &done)?;
        Ok(JointEstimate { chosen: Some(chosen), ..estimate })
    };
    joints.par_iter().map(one_joint).collect()
}

fn estimate_one(
    joint: &Joint,
    settings: &Settings,
    done: &(impl Fn() + Sync),
) -> Result<JointEstimate, EstimateError> {
    let needed = settings.beta.saturating_mul(2);
    let longest = joint.trials.iter().map(Trial::len).max();
    if let Some(samples) = longest.filter(|samples| *samples < needed) {
        return Err(EstimateError::TooFewSamples { samples, needed });
    }
    let estimator = Estimator::of(&joint.trials, settings)?;
    let one_trial = |trial| {
        let estimate = estimator.estimate(trial);
        done();
        estimate
    };
    let trials: Vec<_> = joint.trials.par_iter().map(one_trial).collect();
    match trials.first() {
        Some(Err(first)) if trials.iter().all(Result::is_err) => Err(first.clone()),
        _ => Ok(JointEstimate { trials, settings: settings.clone(), chosen: None }),
    }
}

/// The delays of a joint with all settings of a grid.
#[derive(Clone, Debug)]
pub struct SweptJoint {
    /// What came out.
    pub sweep: JointSweep,
    /// The runs that failed, by their index in the grid, and why.
    pub failed: Vec<(usize, EstimateError)>,
}

/// Estimates every joint with all settings of `grid` and tells how its delays move; delays
/// agree within `tolerance` samples. `done` is called after each run of a joint.
///
/// A joint fails when all runs do, with the first one's error.
pub fn sweep_joints(
    joints: &[Joint],
    grid: &Grid,
    tolerance: f64,
    done: impl Fn() + Sync,
) -> Vec<Result<SweptJoint, EstimateError>> {
    let one_run = |joint: &Joint, settings: &Settings| {
        let estimate = estimate_one(joint, settings, &|| ());
        done();
        let estimate = estimate?;
        let trials = estimate.trials.iter().map(|trial| trial.as_ref().ok());
        Ok(RunDelays::of(&joint.trials, trials, settings))
    };
    let one_joint = |joint: &Joint| {
        let runs: Vec<Result<RunDelays, EstimateError>> =
            grid.runs().par_iter().map(|settings| one_run(joint, settings)).collect();
        let (mut told, mut failed) = (Vec::with_capacity(runs.len()), Vec::new());
        for (index, run) in runs.into_iter().enumerate() {
            match run {
                Ok(run) => told.push(Some(run)),
                Err(error) => {
                    failed.push((index, error));
                    told.push(None);
                }
            }
        }
        match failed.first() {
            Some((_, first)) if failed.len() == told.len() => Err(first.clone()),
            _ => Ok(SweptJoint {
                sweep: JointSweep::of(grid, &joint.trials, &told, tolerance),
                failed,
            }),
        }
    };
    joints.par_iter().map(one_joint).collect()
}

/// What becomes of a model before it is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// A plain integrator that the estimated delays suggest, fitted.
    Integrator,
    /// The given model, fitted from its values.
    Fit,
    /// The same; a plain integrator where none is given.
    FitOrIntegrator,
    /// The given model as it is.
    AsItIs,
}

/// Who is told how much work there is, and each time that a piece of it is done.
pub trait Watch: Sync {
    /// So many pieces of work have come up.
    fn more(&self, pieces: usize);

    /// One of them is done.
    fn done(&self);
}

/// Nobody.
impl Watch for () {
    fn more(&self, _: usize) {}

    fn done(&self) {}
}

/// A protocol, and who watches the work: a [`Protocol`] alone is watched by nobody.
#[derive(Clone, Copy)]
pub struct Watched<'a> {
    protocol: Protocol,
    watch: &'a dyn Watch,
}

impl std::fmt::Debug for Watched<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watched").field("protocol", &self.protocol).finish_non_exhaustive()
    }
}

impl From<Protocol> for Watched<'_> {
    fn from(protocol: Protocol) -> Self {
        Self { protocol, watch: &() }
    }
}

impl Protocol {
    /// This protocol, the work being watched. A piece is a fit, or a pair of candidates that
    /// is told apart; more pieces come up as the work goes on.
    pub fn watched(self, watch: &dyn Watch) -> Watched<'_> {
        Watched { protocol: self, watch }
    }
}

/// By what rules models are judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Protocol {
    /// What becomes of a model first.
    pub mode: Mode,
    /// How training and validation are told apart; as [`Split::of`] says without it.
    pub split: Option<Split>,
    /// How long a simulation runs before it is set right.
    pub horizon: Horizon,
}

/// What came of each joint: `None` where it has no model.
pub type OfJoints<T> = Vec<Option<Result<T, FitError>>>;

/// Compares each joint with its model: `None` where it has none.
///
/// The other `joints` are the ones that share the supply with a joint: see [`activity`].
/// `models` gives the model of a joint; it is not asked for plain integrators.
pub fn compare_joints<'a>(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: impl Into<Watched<'a>>,
) -> OfJoints<Comparison> {
    let watched = protocol.into();
    if watched.protocol.mode == Mode::AsItIs {
        let compared = |_: usize, record: &FitRecord<'_>, model| compare_unfitted(record, model);
        return for_each_joint(joints, estimates, models, watched, (as_it_is, compared));
    }
    let compared = |_: usize, record: &FitRecord<'_>, fit| compare(record, fit);
    for_each_joint(joints, estimates, models, watched, (best_fit, compared))
}

/// Says what each joint's model lacks: see [`explain`].
pub fn explain_joints<'a>(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: impl Into<Watched<'a>>,
    options: &Options,
) -> OfJoints<Explanation> {
    let watched = protocol.into();
    let work = |_: usize, record: &FitRecord<'_>, fit| {
        explain(record, fit, options, &Threads(watched.watch))
    };
    for_each_joint(joints, estimates, models, watched, (best_fit, work))
}

/// Adds `effect` to each joint's model: see [`add`].
pub fn add_to_joints<'a>(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: impl Into<Watched<'a>>,
    effect: &'static dyn Effect,
) -> Vec<Option<Result<Addition, AddError>>> {
    let work = |_: usize, record: &FitRecord<'_>, fit: Fit| add(record, fit, effect);
    let added = for_each_joint(joints, estimates, models, protocol.into(), (best_fit, work));
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
) -> OfJoints<Improvement> {
    let watched = protocol.into();
    let work = |index, record: &FitRecord<'_>, fit| {
        improve(record, fit, options, &Threads(watched.watch), |revision| done(index, revision))
    };
    for_each_joint(joints, estimates, models, watched, (best_fit, work))
}

/// Fits each joint's model and says how well its log knows the numbers; what it does not
/// determine is off by `share` of its value.
pub fn know_joints(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: Protocol,
    share: f64,
) -> OfJoints<Uncertain> {
    let work = |_: usize, record: &FitRecord<'_>, fit: Fit| {
        let noise = floor_of(record, &fit).unwrap_or_default().max(f64::MIN_POSITIVE);
        Uncertain::of_fit(record, &fit, noise, share)
    };
    for_each_joint(joints, estimates, models, protocol.into(), (best_fit, work))
}

/// Fits two effects to each joint, each beside its model: see [`Suspects::of_record`].
pub fn suspect_joints(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    protocol: Protocol,
    effects: [&'static dyn Effect; 2],
    (noise, share): (Option<f64>, f64),
) -> Vec<Option<Result<Suspects, SuspectsError>>> {
    let work = |_: usize, record: &FitRecord<'_>, fit: Fit| {
        Suspects::of_record(record, &fit.model, effects, noise, share)
    };
    let suspects = for_each_joint(joints, estimates, models, protocol.into(), (best_fit, work));
    let flat = |of: Result<Result<_, _>, FitError>| of.map_err(SuspectsError::from).flatten();
    suspects.into_iter().map(|result| result.map(flat)).collect()
}

/// The shortest input that tells two suspects apart: see [`shortest`]. `tried` is told the
/// length of the inputs that come next, in seconds.
///
/// # Errors
/// [`DesignError`] where no input will do.
pub fn design_separation(
    suspects: &Suspects,
    rig: &TestRig,
    limits: &Limits,
    tried: impl Fn(f64) + Sync,
) -> Result<Design, DesignError> {
    shortest(suspects, rig, limits, &Threads(&()), &tried)
}

/// Prepares the model of each joint from its starts, and does `work` with what comes of it.
fn for_each_joint<P, T: Send>(
    joints: &[Joint],
    estimates: &[Result<JointEstimate, EstimateError>],
    models: impl Fn(&Joint) -> Option<JointModel> + Sync,
    Watched { protocol, watch }: Watched<'_>,
    (prepare, work): (
        impl Fn(&FitRecord<'_>, &[JointModel]) -> Option<Result<P, FitError>> + Sync,
        impl Fn(usize, &FitRecord<'_>, P) -> T + Sync,
    ),
) -> OfJoints<T> {
    let Protocol { mode, split, horizon } = protocol;
    watch.more(joints.len());
    let delays_s: Vec<f64> = joints.iter().zip(estimates).map(typical_delay_s).collect();
    let one_joint = |(index, estimate): (usize, &Result<JointEstimate, EstimateError>)| {
        let joint = joints.get(index)?;
        let estimated: Vec<_> = estimate.iter().flat_map(JointEstimate::estimated).collect();
        let split = split.unwrap_or_else(|| Split::of(joint));
        let others = activity(joints, index, &delays_s);
        let record = FitRecord::new(joint, split, horizon).with_others(others);
        let starts = match mode {
            Mode::Integrator => integrators(joint, &estimated),
            Mode::Fit | Mode::AsItIs => vec![models(joint)?],
            Mode::FitOrIntegrator => {
                let given = models(joint).map(|model| vec![model]);
                given.unwrap_or_else(|| integrators(joint, &estimated))
            }
        };
        let prepared = prepare(&record, &starts);
        watch.done();
        Some(prepared?.map(|prepared| work(index, &record, prepared)))
    };
    (0..joints.len()).into_par_iter().zip(estimates).map(one_joint).collect()
}

/// The median of the accepted delays of a joint in seconds; 0 without any.
fn typical_delay_s((joint, estimate): (&Joint, &Result<JointEstimate, EstimateError>)) -> f64 {
    let estimated = estimate.iter().flat_map(JointEstimate::estimated);
    let delays = estimated.flat_map(|trial| {
        let known = joint.trials.iter().find(|known| known.label() == trial.label);
        let period_s = known.map_or(0.0, |known| known.period().seconds());
        let accepted = trial.decisions.iter().filter_map(Decision::accepted_delay);
        accepted.map(move |samples| samples * period_s)
    });
    let delays: Vec<f64> = delays.collect();
    median(&delays).unwrap_or(0.0)
}

/// The best of the fits from several starts.
fn best_fit(record: &FitRecord<'_>, starts: &[JointModel]) -> Option<Result<Fit, FitError>> {
    let levels = record.input_levels();
    let range = range(record, &levels, starts.first()?);
    let fits = starts.iter().map(|start| fit(record, start, &range));
    let cost = |result: &Result<Fit, FitError>| result.as_ref().map_or(f64::MAX, |fit| fit.cost);
    fits.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// The first of the models as it is.
fn as_it_is(record: &FitRecord<'_>, models: &[JointModel]) -> Option<Result<Assessment, FitError>> {
    let (levels, model) = (record.input_levels(), models.first()?);
    Some(assess(record, model, &range(record, &levels, model)))
}

/// How large the signals of a record are, with the speeds that `model` reaches.
fn range<'l>(record: &FitRecord<'_>, levels: &'l [f64], model: &JointModel) -> RecordRange<'l> {
    let top = levels.last().copied().unwrap_or(1.0);
    record.range(levels, model.gain.value.abs() * top)
}

/// The threads of the pool that the caller runs in, and who is told of their work.
#[derive(Clone, Copy)]
struct Threads<'a>(&'a dyn Watch);

impl Workers for Threads<'_> {
    fn map<T: Sync, R: Send>(&self, pieces: &[T], work: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
        self.0.more(pieces.len());
        let told = |piece| {
            let result = work(piece);
            self.0.done();
            result
        };
        pieces.par_iter().map(told).collect()
    }
}

/// Runs `work` on `threads` threads; on as many as there are processors without a number.
///
/// # Errors
/// When the threads cannot be started.
pub fn with_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, rayon::ThreadPoolBuildError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build()?;
    Ok(pool.install(work))
}
