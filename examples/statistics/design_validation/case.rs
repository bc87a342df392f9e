//! One joint: logged, an input designed from the log, and the input played.

use std::fmt;
use std::time::Instant;

use anyhow::Context as _;
use rand::RngExt as _;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use tauscope::Joint;
use tauscope::batch::Threads;
use tauscope::delay::Settings;
use tauscope::design::{
    Logged, Plan, PlanRequest, RandomSteps, TestRig, Uncertain, plan, random_steps, reach,
};
use tauscope::fit::{Horizon, Split};
use tauscope::study::{Mode, Protocol, estimate_joints, know_joints};

use super::plants::{Drawn, Plant, drawn};

/// What became of a joint.
#[derive(Debug)]
pub(crate) struct Judged {
    pub(crate) seed: u64,
    pub(crate) kind: &'static str,
    pub(crate) hidden: Vec<&'static str>,
    /// Effects of the model that was designed with.
    pub(crate) model: Vec<&'static str>,
    pub(crate) range: (f64, f64),
    /// What was played, or why nothing was.
    pub(crate) outcome: Result<Played, String>,
    /// Seconds that the design took.
    pub(crate) design_s: f64,
    /// Whether a plain integrator, whose margin is that of its parameters, leaves the range with
    /// an input of the same length: `None` where nothing was designed.
    pub(crate) integrator_leaves: Option<bool>,
}

/// An input that was played.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Played {
    pub(crate) duration_s: f64,
    pub(crate) steps: usize,
    pub(crate) trials: usize,
    /// Part of the range through which the joint went.
    pub(crate) used: f64,
    /// How far it left the range, as a part of that; zero where it did not.
    pub(crate) beyond: f64,
    /// Part of the margin that was needed at most.
    pub(crate) needed: f64,
}

impl Played {
    pub(crate) fn is_kept(&self) -> bool {
        self.beyond <= 0.0
    }
}

impl fmt::Display for Judged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seed, kind, hidden, model, range, design_s, .. } = self;
        let (hidden, model) = (hidden.join("+"), model.join("+"));
        write!(
            f,
            "seed {seed}, {kind} {hidden}; model {model}; {:.1} to {:.1}; {design_s:.1} s: ",
            range.0, range.1
        )?;
        match &self.outcome {
            Ok(Played { duration_s, steps, trials, used, beyond, needed }) => write!(
                f,
                "{duration_s:.0} s, {steps} steps, {trials} trials, {:.0} % used, {:.2} of the margin needed, {}",
                100.0 * used,
                needed,
                if *beyond > 0.0 {
                    format!("LEFT by {:.1} %", 100.0 * beyond)
                } else {
                    "kept".into()
                }
            ),
            Err(why) => write!(f, "refused: {why}"),
        }
    }
}

/// How the program fits the model of a log.
const PROTOCOL: Protocol =
    Protocol { mode: Mode::FitOrIntegrator, split: Some(Split::Time(1.0)), horizon: Horizon::Auto };

/// What a plan is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Beside {
    /// The plan of a fitted integrator.
    Integrator,
    /// Nothing.
    Nothing,
}

/// What becomes of the joint number `seed`.
pub(crate) fn examine(seed: u64, beside: Beside) -> anyhow::Result<Judged> {
    let Drawn { plant, log, kind, hidden } = drawn(seed)?;
    let begun = Instant::now();
    let logged = Logged::of(&log);
    let (range, duration_s) = wanted(seed, &logged);
    let logged = logged.within(range);
    let log = logged.thinned(&log);
    let within = reach(range, Some(&logged))?;
    let start = logged.settled().unwrap_or(0.5 * (within.0 + within.1));
    let rig = rig(&log, range, start)?;
    let known = known(&log)?;
    let request = PlanRequest { duration_s, seed, ..PlanRequest::default() };
    let effects = known.model.components().iter().map(|c| c.effect().spec().id).collect();
    let planned = plan(&request, &rig, Some(&known), Some(&logged), 0);
    let design_s = begun.elapsed().as_secs_f64();
    let integrator_leaves = match &planned {
        Ok(plan) if beside == Beside::Integrator => {
            Some(integrator_leaves(&plant, &log, (&rig, &logged), plan, seed)?)
        }
        _ => None,
    };
    let outcome = match planned {
        Ok(plan) => Ok(played(&plant, &rig, &logged, &plan, seed)?),
        Err(why) => Err(why.to_string()),
    };
    Ok(Judged { seed, kind, hidden, model: effects, range, outcome, design_s, integrator_leaves })
}

/// The range that is to be kept, part of where the log has been or somewhat more, and the length
/// of the input where one is asked for.
fn wanted(seed: u64, logged: &Logged) -> ((f64, f64), Option<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(1);
    let (low, high) = logged.extent;
    let width = (high - low) * (0.4 + 0.7 * random.random::<f64>());
    let middle = 0.5 * (low + high) + 0.2 * (high - low) * (random.random::<f64>() - 0.5);
    let duration_s = match random.random_range(0..5) {
        0 => Some(30.0),
        1 => Some(60.0),
        2 => Some(120.0),
        _ => None,
    };
    ((middle - 0.5 * width, middle + 0.5 * width), duration_s)
}

fn rig(log: &Joint, range: (f64, f64), start: f64) -> anyhow::Result<TestRig> {
    Ok(TestRig {
        name: log.name.clone(),
        input_unit: log.input_unit.clone(),
        output_unit: log.output_unit.clone(),
        period: log.trials.first().context("a trial")?.period(),
        start,
        range: Some(range),
    })
}

/// The best model that the log supports.
fn known(log: &Joint) -> anyhow::Result<Uncertain> {
    /// As the program has it.
    const SHARE: f64 = 0.1;
    let joints = std::slice::from_ref(log);
    let estimates = estimate_joints(joints, &Settings::default(), || (), &Threads);
    let known = know_joints(joints, &estimates, |_| None, PROTOCOL, SHARE, &Threads);
    Ok(known.into_iter().next().flatten().context("no model")??)
}

/// What the joint does with `plan`: it starts each trial as far off as it may.
fn played(
    plant: &Plant,
    rig: &TestRig,
    logged: &Logged,
    plan: &Plan,
    seed: u64,
) -> anyhow::Result<Played> {
    let schedule = plan.schedule.about(logged.rest);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(2);
    let tolerance = plan.start_tolerance.unwrap_or(0.0);
    let (mut angles, mut number) = (Vec::new(), 0);
    for trial in schedule.trials() {
        let start = rig.start + tolerance * (2.0 * random.random::<f64>() - 1.0);
        angles.extend(plant.played(start, &trial, number)?);
        number += 1;
    }
    let range = rig.range.context("a range")?;
    let prediction = plan.prediction.as_ref().context("a prediction")?;
    let width = range.1 - range.0;
    let low = angles.iter().copied().fold(f64::INFINITY, f64::min);
    let high = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let off = angles.iter().zip(&prediction.output).map(|(angle, own)| (angle - own).abs());
    let needed =
        off.zip(&prediction.margin).map(|(off, margin)| off / (margin + tolerance).max(1e-9));
    Ok(Played {
        duration_s: schedule.duration_s(),
        steps: schedule.steps(),
        trials: schedule.trial_count(),
        used: (high - low) / width,
        beyond: (range.0 - low).max(high - range.1).max(0.0) / width,
        needed: needed.fold(0.0, f64::max),
    })
}

/// Whether an input as long leaves the range that was drawn with a fitted integrator, within the
/// margin of its parameters and no other.
fn integrator_leaves(
    plant: &Plant,
    log: &Joint,
    (rig, logged): (&TestRig, &Logged),
    plan: &Plan,
    seed: u64,
) -> anyhow::Result<bool> {
    let joints = std::slice::from_ref(log);
    let estimates = estimate_joints(joints, &Settings::default(), || (), &Threads);
    let gain = |joint: &Joint| {
        let trials = estimates.iter().flatten().flat_map(tauscope::study::JointEstimate::estimated);
        let trials: Vec<_> = trials.collect();
        tauscope::model::integrators(joint, &trials).into_iter().next()
    };
    let fitted = know_joints(joints, &estimates, gain, PROTOCOL, 0.1, &Threads);
    let known = fitted.into_iter().next().flatten().context("no model")??;
    let known = Uncertain { free_run: None, ..known };
    let steps = RandomSteps {
        levels: plan.schedule.levels(),
        hold_s: plan.hold_s,
        duration_s: plan.schedule.duration_s(),
        seed,
    };
    let schedule = random_steps(&steps, rig, Some(&known), 0).about(logged.rest);
    let angles = plant.played(rig.start, &schedule, 0)?;
    let (low, high) = rig.range.context("a range")?;
    Ok(angles.iter().any(|angle| *angle < low || *angle > high))
}
