//! A joint, what is known of it, and what the next experiment shows.

use std::fmt;

use anyhow::{Context as _, anyhow, bail};
use tauscope::batch::Threads;
use tauscope::delay::Settings;
use tauscope::design::shortest;
use tauscope::design::{Design, Limits, RandomSteps, Schedule, Suspects, TestRig, random_steps};
use tauscope::effect::{Effect, by_id};
use tauscope::experiment::Joint;
use tauscope::explain::{Explanation, Options, Verdict};
use tauscope::fit::{Horizon, Split};
use tauscope::study::{Mode, Protocol, estimate_joints, explain_joints, suspect_joints};
use tauscope::synthetic::scenario::{Noise, Scenario, Strength};
use tauscope::synthetic::{InputSpec, PlantSpec, simulate};

/// One of two effects in a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) pair: [&'static str; 2],
    pub(crate) truth: usize,
    pub(crate) seed: u64,
    pub(crate) rehearsals: usize,
}

/// How much longer than the designed input random ones are.
pub(crate) const TIMES: [u32; 4] = [1, 2, 4, 8];

/// No random input is longer, seconds.
const LONGEST_S: f64 = 100.0;

/// Length of the log from which the suspects are known, in samples of 10 ms.
const KNOWN: usize = 1500;

/// Angles within which the joint is kept, in degrees.
const RANGE: (f64, f64) = (-60.0, 60.0);

/// Standard deviation of the measurement noise, in degrees.
const NOISE: f64 = 0.05;

/// The log shows no lack of fit, so that there is nothing to tell apart.
#[derive(Debug, thiserror::Error)]
#[error("nothing is suspected")]
pub(crate) struct Unsuspected;

/// What became of a joint.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    /// Whether the log told the two apart already.
    pub(crate) known: bool,
    /// Whether the input is to tell what is hidden; not where the other effect can do the same.
    pub(crate) aimed: bool,
    /// Length of the designed input, and of those before that explore.
    pub(crate) duration_s: f64,
    /// Lengths of the inputs that explore.
    pub(crate) explored_s: Vec<f64>,
    /// The power that was expected.
    pub(crate) power: f64,
    /// Whether the designed input told them apart.
    pub(crate) designed: bool,
    /// Whether random inputs did, as much longer as [`TIMES`] says; `None` for one too long.
    pub(crate) random: [Option<bool>; TIMES.len()],
    /// What the race said of the designed input.
    pub(crate) said: String,
}

/// A case, and what became of it.
#[derive(Debug)]
pub(crate) struct Judged {
    pub(crate) case: Case,
    pub(crate) outcome: anyhow::Result<Outcome>,
}

impl Case {
    /// The effect that is there.
    pub(crate) fn hidden(&self) -> &'static str {
        self.pair.get(self.truth).copied().unwrap_or_default()
    }
}

impl fmt::Display for Judged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Case { pair: [one, other], seed, .. } = self.case;
        write!(f, "{} of {one} and {other}, seed {seed}: ", self.case.hidden())?;
        match &self.outcome {
            Err(error) => write!(f, "{error:#}"),
            Ok(outcome) => {
                let Outcome { duration_s, explored_s, power, designed, .. } = outcome;
                let Outcome { random, said, aimed, .. } = outcome;
                let random = random.map(|told| told.map_or("-", |t| if t { "yes" } else { "no" }));
                write!(
                    f,
                    "{duration_s:.1} s ({explored_s:.1?} of it exploring), power {power:.3} (aimed \
                     {aimed}): told {designed}, random {}; {said}",
                    random.join(" ")
                )
            }
        }
    }
}

/// Inputs that explore before one that is to tell, at most.
const EXPLORATIONS: usize = 2;

/// What becomes of `case`.
pub(crate) fn examine(case: &Case) -> anyhow::Result<Outcome> {
    let hidden = [case.hidden()];
    let mut plant = Scenario::new(&hidden, Strength::Clear, Noise::white(NOISE), case.seed)?.plant;
    plant.joints.truncate(1);
    let levels = shorten(&mut plant)?;
    let mut log = simulate(&plant)?.joints.remove(0);
    let first = explained(&log, case)?;
    if first.verdict == Verdict::Adequate {
        return Err(Unsuspected.into());
    }
    let rig = rig(&log)?;
    let suspects = suspects(&log, case)?;
    let largest = levels.iter().fold(0.0, |most: f64, level| most.max(level.abs()));
    let rehearsals = case.rehearsals;
    let limits = Limits { largest, hold_s: None, longest_s: 60.0, power: 0.95, rehearsals };
    let mut design = shortest(&suspects, &rig, &limits, &Threads, &|_| ())?;
    let mut explored_s = Vec::new();
    while !design.explores.is_empty() && explored_s.len() < EXPLORATIONS {
        explored_s.push(design.schedule.duration_s());
        // What is found out is known of the next one.
        let seed = 3000 + explored_s.len() as u64;
        let further = played(&plant, &design.schedule, seed)?.trials;
        log.trials = log.trials.iter().cloned().chain(further).collect();
        design = shortest(&self::suspects(&log, case)?, &rig, &limits, &Threads, &|_| ())?;
    }
    let after = explained(&played(&plant, &design.schedule, 1000)?, case)?;
    let duration_s = design.schedule.duration_s() + explored_s.iter().sum::<f64>();
    let random = TIMES.map(|times| {
        let duration_s = f64::from(times) * duration_s;
        let steps =
            RandomSteps { levels: levels.clone(), hold_s: (0.5, 3.0), duration_s, seed: case.seed };
        (duration_s <= LONGEST_S).then(|| by_chance(case, &plant, &steps, (&rig, &suspects)))
    });
    let mut told = [None; TIMES.len()];
    for (told, random) in told.iter_mut().zip(random) {
        *told = random.transpose()?;
    }
    Ok(Outcome { random: told, duration_s, explored_s, ..outcome(case, &first, &design, &after) })
}

fn outcome(case: &Case, first: &Explanation, design: &Design, after: &Explanation) -> Outcome {
    // What the log excludes wrongly counts: it will not be told.
    let aimed = design.sides.get(case.truth).is_some_and(|side| side.is_target || side.is_excluded);
    let ranking = after
        .ranking
        .iter()
        .map(|c| format!("{} {:.1} {:?}", c.name(), c.behind, c.indistinguishable_from));
    Outcome {
        known: is_told(first, case),
        aimed,
        duration_s: design.schedule.duration_s(),
        power: design.power(),
        designed: is_told(after, case),
        explored_s: Vec::new(),
        random: [None; TIMES.len()],
        said: format!(
            "{:?} rehearsed, {:?} {:?} {:?}, {:?} {}",
            design.sides.map(|side| side.rehearsal.map(|found| (found.successes, found.runs))),
            design.order,
            design.schedule.levels(),
            design.schedule.hold_range_s(),
            after.verdict,
            ranking.collect::<Vec<_>>().join(", ")
        ),
    }
}

/// Makes the log of `plant` as short as it is to be; the levels of its input.
fn shorten(plant: &mut PlantSpec) -> anyhow::Result<Vec<f64>> {
    let period_s = plant.sample_period_s;
    let joint = plant.joints.first_mut().context("a joint")?;
    let InputSpec::Steps { steps, initial } = joint.input.clone() else {
        bail!("a scenario lists its steps");
    };
    let mut levels: Vec<f64> = steps.iter().map(|(_, level)| *level).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    let steps = steps.into_iter().filter(|(sample, _)| *sample < KNOWN).collect();
    joint.input = InputSpec::Steps { steps, initial };
    plant.duration_s = KNOWN as f64 * period_s;
    Ok(levels)
}

fn rig(log: &Joint) -> anyhow::Result<TestRig> {
    Ok(TestRig {
        name: log.name.clone(),
        input_unit: log.input_unit.clone(),
        output_unit: log.output_unit.clone(),
        period: log.trials.first().context("a trial")?.period(),
        start: 0.0,
        range: Some(RANGE),
    })
}

fn effects(case: &Case) -> anyhow::Result<[&'static dyn Effect; 2]> {
    let [one, other] = case.pair.map(by_id);
    Ok([one.context("an effect")?, other.context("an effect")?])
}

const PROTOCOL: Protocol =
    Protocol { mode: Mode::FitOrIntegrator, split: None, horizon: Horizon::Steps };

/// Both effects as the log has them.
fn suspects(log: &Joint, case: &Case) -> anyhow::Result<Suspects> {
    let joints = std::slice::from_ref(log);
    let estimates = estimate_joints(joints, &Settings::default(), || (), &Threads);
    let known = (None, 0.1);
    let all = Protocol { split: Some(Split::Time(1.0)), ..PROTOCOL };
    let suspects =
        suspect_joints(joints, &estimates, |_| None, all, effects(case)?, known, &Threads);
    let first = suspects.into_iter().next().flatten();
    Ok(first.context("no suspects")??)
}

/// What `plant` does with `schedule`, with other noise.
fn played(plant: &PlantSpec, schedule: &Schedule, seed: u64) -> anyhow::Result<Joint> {
    let mut plant = plant.clone();
    let joint = plant.joints.first_mut().context("a joint")?;
    joint.input =
        InputSpec::Steps { steps: schedule.starts().into_iter().skip(1).collect(), initial: 0.0 };
    plant.duration_s = schedule.duration_s();
    plant.seed += seed;
    Ok(simulate(&plant)?.joints.remove(0))
}

/// Whether a random input tells the two apart.
fn by_chance(
    case: &Case,
    plant: &PlantSpec,
    steps: &RandomSteps,
    (rig, suspects): (&TestRig, &Suspects),
) -> anyhow::Result<bool> {
    let model = suspects.models.get(case.truth).ok_or_else(|| anyhow!("two suspects"))?;
    let schedule = random_steps(steps, rig, Some(model), 0);
    Ok(is_told(&explained(&played(plant, &schedule, 2000)?, case)?, case))
}

/// What the race between the two says.
fn explained(log: &Joint, case: &Case) -> anyhow::Result<Explanation> {
    let joints = std::slice::from_ref(log);
    let estimates = estimate_joints(joints, &Settings::default(), || (), &Threads);
    let options = Options { effects: effects(case)?.to_vec(), ..Options::default() };
    let explained = explain_joints(joints, &estimates, |_| None, PROTOCOL, &options, &Threads);
    Ok(explained.into_iter().next().flatten().context("no model")??)
}

/// Whether what is hidden is named, and the other excluded.
fn is_told(explained: &Explanation, case: &Case) -> bool {
    let is_named = explained.verdict == Verdict::MissingEffect;
    let best = explained.ranking.first().filter(|_| is_named);
    best.is_some_and(|best| {
        best.effects == [case.hidden()] && best.indistinguishable_from.is_empty()
    })
}
