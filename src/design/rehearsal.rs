//! An experiment that is rehearsed: simulated with noise, and explained.

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use super::predict::Stand;
use super::schedule::Schedule;
use super::suspects::{Suspects, noisy};
use crate::explain::{Options, Sequential, Workers, suspected};
use crate::fit::{Horizon, Record, Split, fit};
use crate::model::JointModel;

/// How often a rehearsed experiment told two suspects apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rehearsal {
    /// Rehearsals that ranked the suspect first that was there, and excluded the other.
    pub told: usize,
    /// All of them.
    pub of: usize,
}

/// Rehearsals after which it is seen whether more are worth it.
const FEW: usize = 4;

/// Rehearses `schedule` so many times with suspect number `truth`: each time with numbers
/// drawn from what is known of them, and other noise. Given up early when more than `failures`
/// fail.
pub(super) fn rehearse(
    suspects: &Suspects,
    truth: usize,
    (stand, schedule): (&Stand, &Schedule),
    (count, failures): (usize, usize),
    workers: &impl Workers,
) -> Rehearsal {
    let seeds: Vec<u64> = (1..).take(count).collect();
    let mut found = Rehearsal::default();
    for some in seeds.chunks(FEW) {
        let one = |seed: &u64| is_told(suspects, truth, (stand, schedule), *seed);
        let told = workers.map(some, one).into_iter().filter(|told| *told == Some(true)).count();
        found = Rehearsal { told: found.told + told, of: found.of + some.len() };
        if found.of - found.told > failures {
            break;
        }
    }
    found
}

/// Whether the race of `explain` ranks the suspect that is there first, and excludes the other;
/// `None` where the record is too short, or nothing is missed.
fn is_told(
    suspects: &Suspects,
    truth: usize,
    (stand, schedule): (&Stand, &Schedule),
    seed: u64,
) -> Option<bool> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let model: JointModel = suspects.models.get(truth)?.drawn(&mut random);
    let output = noisy(stand.output(&model, schedule), suspects.noise, &mut random);
    let joint = stand.log(schedule, output)?;
    let record = Record::new(&joint, Split::of(&joint), Horizon::Steps);
    let levels = record.input_levels();
    let top = levels.last().copied().unwrap_or(1.0);
    let range = record.range(&levels, suspects.base.gain.value.abs() * top);
    let base = fit(&record, &suspects.base, &range).ok()?;
    let options = Options { effects: suspects.effects.to_vec(), ..Options::default() };
    let ranking = suspected(&record, base, &options, &Sequential);
    let best = ranking.first()?;
    let id = suspects.effects.get(truth)?.spec().id;
    Some(best.effects == [id] && best.indistinguishable_from.is_empty())
}
