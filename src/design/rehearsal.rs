//! An experiment that is rehearsed: simulated with noise, and explained.

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use super::predict::TestRig;
use super::result::Rehearsal;
use super::schedule::Schedule;
use super::suspects::{Suspects, noisy};
use crate::delay::{Settings, estimate_joint};
use crate::experiment::Joint;
use crate::explain::{Options, Sequential, Workers, named};
use crate::fit::{Fit, FitRecord, Horizon, Split, fit};
use crate::model::{JointModel, integrators};

/// Rehearsals after which it is seen whether more are worth it. Chosen: a batch for a few
/// threads.
const FEW: usize = 4;

/// Rehearsals of both suspects, and what was there where one failed.
#[derive(Clone, Debug, Default)]
pub(super) struct Rehearsed {
    pub(super) sides: [Option<Rehearsal>; 2],
    pub(super) failed: [Vec<JointModel>; 2],
}

/// Rehearses `schedule` `count` times with each suspect of `targets`, a few of each in turn: each
/// time with numbers drawn from what is known of it, and other noise. Given up early when more
/// than `failures` fail of one. No two of the `attempts` share their noise.
pub(super) fn rehearse(
    suspects: &Suspects,
    targets: [bool; 2],
    at: (&TestRig, &Schedule),
    (count, failures, attempt): (usize, usize, usize),
    workers: &impl Workers,
) -> Rehearsed {
    let first = (attempt * count) as u64;
    let seeds: Vec<u64> = (first + 1..).take(count).collect();
    let sides = targets.map(|is_target| is_target.then(Rehearsal::default));
    let mut found = Rehearsed { sides, ..Rehearsed::default() };
    for some in seeds.chunks(FEW) {
        let sides = found.sides.iter_mut().zip(&mut found.failed).enumerate();
        for (truth, (side, failed)) in sides {
            let Some(side) = side else { continue };
            let runs = workers.map(some, |seed| rehearsed(suspects, truth, at, *seed));
            side.runs += some.len();
            side.successes += runs.iter().filter(|(_, succeeded)| *succeeded).count();
            failed.extend(runs.into_iter().filter(|run| !run.1).map(|(model, _)| model));
        }
        if found.sides.iter().flatten().any(|side| side.runs - side.successes > failures) {
            break;
        }
    }
    found
}

/// The model that is there in a rehearsal, and whether it is found.
fn rehearsed(
    suspects: &Suspects,
    truth: usize,
    at: (&TestRig, &Schedule),
    seed: u64,
) -> (JointModel, bool) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let model = suspects.models[truth].drawn(&mut random);
    let found = is_found(suspects, truth, at, (&model, &mut random));
    (model, found == Some(true))
}

/// Whether `explain` ranks the suspect that is there first, and excludes the other; `None`
/// where the record is too short, or nothing is missed.
fn is_found(
    suspects: &Suspects,
    truth: usize,
    (rig, schedule): (&TestRig, &Schedule),
    (model, random): (&JointModel, &mut ChaCha8Rng),
) -> Option<bool> {
    let output = noisy(rig.output(model, schedule), suspects.noise, random);
    let joint = rig.log(schedule, output)?;
    let record = FitRecord::new(&joint, Split::of(&joint), Horizon::Steps);
    let base = starting_model(&record, &joint, &suspects.base)?;
    let options = Options {
        effects: suspects.effects.to_vec(),
        tries_conditions: false,
        ..Options::default()
    };
    let ranking = named(&record, base, &options, &Sequential);
    let best = ranking.first()?;
    let id = suspects.effects[truth].spec().id;
    Some(best.effects == [id] && best.indistinguishable_from.is_empty())
}

/// The model that `explain` starts from: `base`, fitted. Where that is a plain integrator none
/// is given, and `explain` starts from the delays that it finds in the record; it does not
/// know what was known before.
fn starting_model(record: &FitRecord<'_>, joint: &Joint, base: &JointModel) -> Option<Fit> {
    let starts = if base.components().is_empty() {
        let estimates = estimate_joint(&joint.trials, &Settings::default());
        integrators(joint, &estimates.iter().flatten().collect::<Vec<_>>())
    } else {
        vec![base.clone()]
    };
    let range = record.range_for(starts.first()?);
    let fits = starts.iter().filter_map(|start| fit(record, start, &range).ok());
    fits.min_by(|a, b| a.cost.total_cmp(&b.cost))
}
