//! The shortest input that tells two suspects apart.

use super::distance::expected;
use super::explore::{Open, exploring, open};
use super::family::{Family, Order, families};
use super::glances::Glances;
use super::power::Expected;
use super::predict::Stand;
use super::rehearsal::{Rehearsal, Rehearsed, rehearse};
use super::schedule::Schedule;
use super::suspects::Suspects;
use crate::explain::Workers;
use crate::model::JointModel;

/// What an input may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest magnitude of the input, input units.
    pub largest: f64,
    /// Shortest and longest hold in seconds; as the models suggest without.
    pub hold_s: Option<(f64, f64)>,
    /// Longest input that is tried, seconds.
    pub longest_s: f64,
    /// The power that is wanted, 0 to 1.
    pub power: f64,
    /// How often the experiment is rehearsed with either suspect, with noise.
    pub rehearsals: usize,
}

/// What an input tells of one suspect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// What a race is expected to show where the suspect is there.
    pub expected: Expected,
    /// Whether the input is to tell it from the other; not where the other can do the same.
    pub is_told: bool,
    /// Whether what is known speaks against it already, so that the input is not made for it.
    pub is_excluded: bool,
    /// How often the rehearsed experiment told it.
    pub rehearsal: Option<Rehearsal>,
}

/// An input that tells two suspects apart, and how surely.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// How its levels follow one another.
    pub order: Order,
    /// The input.
    pub schedule: Schedule,
    /// What it tells where the first suspect is there, and where the second.
    pub sides: [Side; 2],
    /// The levels that it is to find, where it explores: no input passed, and what is known
    /// leaves these open. The input that tells the two is designed from what it shows. Empty
    /// where it is itself to tell them.
    pub explores: Vec<Open>,
}

/// Why there is no such input.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
    /// No input stays in the range.
    #[error(
        "no input with levels up to {largest} keeps the joint in its range: give a wider range, \
         a smaller largest level or shorter holds"
    )]
    OutOfRange {
        /// Largest magnitude of the input.
        largest: f64,
    },
    /// One suspect can do what the other does, whatever the input.
    #[error(
        "no input of {longest_s} s or less tells them apart: as far as is known, one of them can \
         do all that the other does"
    )]
    Imitated {
        /// Longest input that was tried, seconds.
        longest_s: f64,
    },
    /// None of the inputs that were tried is good enough.
    #[error(
        "no input of {longest_s} s or less tells them apart with power {wanted}; the best that was \
         found has {best:.2}: give more time, larger levels or a wider range"
    )]
    NotApart {
        /// The power that was wanted.
        wanted: f64,
        /// The largest power that was found.
        best: f64,
        /// Longest input that was tried, seconds.
        longest_s: f64,
    },
}

/// The shortest input with the power that is wanted, of those that are tried.
///
/// A glance tells how long an input must be at least. From there on the best of each length
/// are judged with every model at its best fit, and the best of these is rehearsed, until one
/// passes. Whatever a glance took for better than it is comes later in the queue, and numbers
/// at which a rehearsal failed are looked at from then on. A suspect that the other can
/// imitate in whatever input, as one that it contains, is left out of it. Where none passes and
/// it is open at which levels the effects switch, the input is one that explores.
///
/// `tried` is told the length of the inputs that come next, in seconds.
///
/// # Errors
/// [`DesignError`] where no input will do.
pub fn shortest(
    suspects: &Suspects,
    stand: &Stand,
    limits: &Limits,
    workers: &impl Workers,
    tried: &(dyn Fn(f64) + Sync),
) -> Result<Design, DesignError> {
    let mut lessons = Lessons::default();
    let field = |part: f64| {
        let longest_s = part * limits.longest_s;
        Field { suspects, stand, limits: Limits { longest_s, ..*limits }, tried }
    };
    let aims = suspects.excluded.map(|excluded| !excluded);
    let mut queue = Vec::new();
    let mut from_s = 0.0;
    // Short inputs are soon looked through, and mostly there is one.
    for part in [0.125, 0.25, 0.5, 1.0] {
        let field = field(part);
        queue = field.queue(&lessons, workers);
        if queue.is_empty() && part >= 1.0 {
            return Err(DesignError::OutOfRange { largest: limits.largest });
        }
        let found = field.first_to_pass(&mut queue, aims, from_s, &mut lessons, workers);
        if let Some(design) = found {
            return Ok(design);
        }
        from_s = field.limits.longest_s;
    }
    // One of them alone is told only where all the time there is does not show the other.
    let alone = lessons.powers.map(|power| power >= limits.power);
    if lessons.second.is_none() && aims == [true; 2] && alone[0] != alone[1] {
        let found = field(1.0).first_to_pass(&mut queue, alone, 0.0, &mut lessons, workers);
        if let Some(design) = found {
            return Ok(design);
        }
    }
    if let Some(design) = field(1.0).exploring(aims, &lessons, workers) {
        return Ok(design);
    }
    let Lessons { second, power: judged, .. } = lessons;
    // Its power will do, and how its rehearsals went is told.
    second.ok_or_else(|| {
        let glanced = queue.iter().map(|entry| entry.best_power(aims));
        let best = glanced.fold(judged, f64::max);
        let longest_s = limits.longest_s;
        if best < IMITATED {
            return DesignError::Imitated { longest_s };
        }
        DesignError::NotApart { wanted: limits.power, best, longest_s }
    })
}

/// The best power of all inputs below which they show nothing of the difference.
const IMITATED: f64 = 0.01;

/// The design of which more rehearsals went well; of two as good, the first.
fn better(one: Option<Design>, other: Option<Design>) -> Option<Design> {
    match (one, other) {
        (Some(one), Some(other)) if one.share_told() >= other.share_told() => Some(one),
        (one, other) => other.or(one),
    }
}

/// What inputs that did not pass have taught.
#[derive(Default)]
struct Lessons {
    /// Numbers of each suspect at which a rehearsal failed.
    hard: [Vec<JointModel>; 2],
    /// Inputs that were rehearsed.
    attempts: usize,
    /// The one whose rehearsals went best.
    second: Option<Design>,
    /// The best power.
    power: f64,
    /// The best power of each suspect by itself.
    powers: [f64; 2],
}

/// An input that may be judged.
struct Entry {
    family: Family,
    glances: Glances,
    /// By how much it was worse than at a glance when it was tried last; 0 or less.
    offset: f64,
}

impl Entry {
    /// The power of the whole input for the suspects of `aims` at a glance.
    fn best_power(&self, aims: [bool; 2]) -> f64 {
        let all = self.family.schedule.holds().len();
        let told = aims.into_iter().enumerate().filter(|(_, aim)| *aim);
        told.map(|(truth, _)| self.glances.best_known(truth, &self.family, all)).fold(1.0, f64::min)
    }

    /// By how many standard deviations the suspects of `aims` are told, as far as is known.
    fn margin(&self, aims: [bool; 2], count: usize) -> f64 {
        self.glances.margin(&self.family, aims, count) + self.offset
    }
}

/// What is to be told apart, where, and with what.
struct Field<'a> {
    suspects: &'a Suspects,
    stand: &'a Stand,
    limits: Limits,
    tried: &'a (dyn Fn(f64) + Sync),
}

impl Field<'_> {
    /// All inputs that may do, at a glance.
    fn queue(&self, lessons: &Lessons, workers: &impl Workers) -> Vec<Entry> {
        let families = families(self.suspects, self.stand, &self.limits);
        let seen = workers.map(&families, |family| Glances::at(self.suspects, self.stand, family));
        let entry = |(family, glances): (Family, Option<Glances>)| {
            Some(Entry { family, glances: glances?, offset: 0.0 })
        };
        let mut queue: Vec<Entry> = families.into_iter().zip(seen).filter_map(entry).collect();
        for (truth, hard) in lessons.hard.iter().enumerate() {
            self.look_at(&mut queue, truth, hard, workers);
        }
        queue
    }

    /// Looks at the numbers `hard` of one suspect, too.
    fn look_at(
        &self,
        queue: &mut [Entry],
        truth: usize,
        hard: &[JointModel],
        workers: &impl Workers,
    ) {
        let families: Vec<&Family> = queue.iter().map(|entry| &entry.family).collect();
        let outputs = workers.map(&families, |family| {
            let output = |model: &JointModel| self.stand.output(model, &family.schedule);
            hard.iter().map(output).collect::<Vec<_>>()
        });
        for (entry, outputs) in queue.iter_mut().zip(outputs) {
            for output in outputs {
                entry.glances.add(truth, &output);
            }
        }
    }

    /// The shortest input of `queue` that passes, no shorter than `from_s`.
    ///
    /// From the shortest length that may do the inputs become longer by a small part at a
    /// time; of each length those are judged that are best as far as is known.
    fn first_to_pass(
        &self,
        queue: &mut [Entry],
        aims: [bool; 2],
        from_s: f64,
        lessons: &mut Lessons,
        workers: &impl Workers,
    ) -> Option<Design> {
        /// A length and the next.
        const LONGER: f64 = 1.15;
        /// Inputs of one length that are rehearsed.
        const TRIALS: usize = 2;
        let least = |Entry { family, glances, .. }: &Entry| {
            let count = glances.fewest(family, aims, self.limits.power)?;
            Some(family.schedule.first(count).duration_s())
        };
        let mut length_s = queue.iter().filter_map(least).min_by(f64::total_cmp)?.max(from_s);
        while length_s <= self.limits.longest_s * LONGER {
            (self.tried)(length_s.min(self.limits.longest_s));
            for _ in 0..TRIALS {
                let Some((place, design)) =
                    self.best_of_length(queue, aims, length_s, lessons, workers)
                else {
                    break;
                };
                lessons.power = lessons.power.max(design.power());
                if design.power() < self.limits.power {
                    break;
                }
                let design = self.rehearsed(design, queue, place, lessons, workers);
                if design.passes(&self.limits) {
                    return Some(design);
                }
                lessons.second = better(lessons.second.take(), Some(design));
            }
            length_s *= LONGER;
        }
        None
    }

    /// The best input that is not longer, and its place in `queue`.
    fn best_of_length(
        &self,
        queue: &mut [Entry],
        aims: [bool; 2],
        length_s: f64,
        lessons: &mut Lessons,
        workers: &impl Workers,
    ) -> Option<(usize, Design)> {
        /// Inputs of one length that are judged in full.
        const JUDGED: usize = 3;
        let mut glanced = Vec::new();
        for (place, entry) in queue.iter().enumerate() {
            let count = entry.family.schedule.fitting(length_s);
            if count > 1 {
                glanced.push((entry.margin(aims, count), place, count));
            }
        }
        glanced.sort_by(|a, b| b.0.total_cmp(&a.0));
        glanced.truncate(JUDGED);
        let mut best: Option<(f64, usize, Design)> = None;
        for (_, place, count) in glanced {
            let entry = queue.get_mut(place)?;
            let Family { order, schedule } = &entry.family;
            let found = self.judged(aims, *order, schedule.first(count), lessons, workers);
            let margin = found.as_ref().map_or(f64::NEG_INFINITY, |(margin, _)| *margin);
            entry.take_as(margin, aims, count);
            let Some((margin, design)) = found else { continue };
            for (most, side) in lessons.powers.iter_mut().zip(&design.sides) {
                *most = most.max(side.expected.power());
            }
            if best.as_ref().is_none_or(|(most, _, _)| margin > *most) {
                best = Some((margin, place, design));
            }
        }
        best.map(|(_, place, design)| (place, design))
    }

    /// What is expected of `schedule`, which is to tell the suspects `aims`, and the margin
    /// that it leaves at the numbers that are known best and at the last that were hard;
    /// `None` where it is too short for a fit.
    fn judged(
        &self,
        aims: [bool; 2],
        order: Order,
        schedule: Schedule,
        lessons: &Lessons,
        workers: &impl Workers,
    ) -> Option<(f64, Design)> {
        let known = self.suspects.models.iter().map(|known| &known.model);
        let known = known.enumerate();
        let hard = lessons.hard.iter().enumerate();
        let hard = hard.filter_map(|(truth, hard)| Some((truth, hard.last()?)));
        let hard = hard.filter(|(truth, _)| aims.get(*truth).copied().unwrap_or_default());
        let all: Vec<(usize, &JointModel)> = known.chain(hard).collect();
        let of = |(truth, model): &(usize, &JointModel)| {
            expected(self.suspects, *truth, model, (self.stand, &schedule))
        };
        let found: Option<Vec<Expected>> = workers.map(&all, of).into_iter().collect();
        let found = found?;
        let [one, other, hard @ ..] = found.as_slice() else { return None };
        let side = |expected: Expected, truth: usize| Side {
            expected,
            is_told: aims.get(truth).copied().unwrap_or_default(),
            is_excluded: self.suspects.excluded.get(truth).copied().unwrap_or_default(),
            rehearsal: None,
        };
        let sides = [side(*one, 0), side(*other, 1)];
        let design = Design { order, schedule, sides, explores: Vec::new() };
        let hard = hard.iter().map(Expected::margin).fold(f64::INFINITY, f64::min);
        Some((design.margin().min(hard), design))
    }

    /// `design`, which is that at `place`, with its rehearsals, as long as they go well: once to
    /// see whether it may do, and once more to be sure.
    fn rehearsed(
        &self,
        mut design: Design,
        queue: &mut [Entry],
        place: usize,
        lessons: &mut Lessons,
        workers: &impl Workers,
    ) -> Design {
        /// Numbers of a suspect that are looked at, at most.
        const HARD: usize = 6;
        let aims = [0, 1].map(|truth| design.sides.get(truth).is_some_and(|side| side.is_told));
        let mut found = self.rehearsal(&design, aims, lessons, workers);
        design.take(found.sides);
        if design.passes(&self.limits) {
            // Of many inputs that are rehearsed the first to pass may have been lucky: it is
            // judged by rehearsals that had no part in its choice.
            found = self.rehearsal(&design, aims, lessons, workers);
            design.take(found.sides);
        }
        if design.passes(&self.limits) {
            return design;
        }
        for (truth, (hard, failed)) in lessons.hard.iter_mut().zip(found.failed).enumerate() {
            let room = HARD.saturating_sub(hard.len());
            let new: Vec<JointModel> = failed.into_iter().take(room).collect();
            self.look_at(queue, truth, &new, workers);
            hard.extend(new);
        }
        if let Some(entry) = queue.get_mut(place) {
            // It comes again when it has become clearly better.
            let count = design.schedule.holds().len();
            entry.take_as(entry.margin(aims, count).min(0.0), aims, count);
        }
        design
    }

    /// An input that explores, where there is something to find.
    fn exploring(
        &self,
        aims: [bool; 2],
        lessons: &Lessons,
        workers: &impl Workers,
    ) -> Option<Design> {
        let explores = open(self.suspects, aims, self.limits.largest);
        let schedule = exploring(self.suspects, self.stand, &self.limits, &explores)?;
        let (_, design) = self.judged(aims, Order::Exploring, schedule, lessons, workers)?;
        Some(Design { explores, ..design })
    }

    /// Rehearsals of `design` that no other input had.
    fn rehearsal(
        &self,
        design: &Design,
        aims: [bool; 2],
        lessons: &mut Lessons,
        workers: &impl Workers,
    ) -> Rehearsed {
        let count = (self.limits.rehearsals, self.limits.failures(), lessons.attempts);
        lessons.attempts += 1;
        rehearse(self.suspects, aims, (self.stand, &design.schedule), count, workers)
    }
}

impl Entry {
    /// Takes `margin` for that of its first `count` holds, where it looked better.
    fn take_as(&mut self, margin: f64, aims: [bool; 2], count: usize) {
        let seen = self.glances.margin(&self.family, aims, count);
        self.offset = (margin - seen).min(0.0);
    }
}

impl Design {
    /// The least power of the suspects that it is to tell.
    pub fn power(&self) -> f64 {
        let told = self.sides.iter().filter(|side| side.is_told);
        told.map(|side| side.expected.power()).fold(1.0, f64::min)
    }

    /// Takes what became of its rehearsals.
    fn take(&mut self, found: [Option<Rehearsal>; 2]) {
        for (side, rehearsal) in self.sides.iter_mut().zip(found) {
            side.rehearsal = rehearsal;
        }
    }

    /// By how many standard deviations it is on the safe side with all of them.
    fn margin(&self) -> f64 {
        let told = self.sides.iter().filter(|side| side.is_told);
        told.map(|side| side.expected.margin()).fold(f64::INFINITY, f64::min)
    }

    /// The share of its rehearsals that went well, of the suspect with the least.
    pub fn share_told(&self) -> f64 {
        let rehearsals = self.sides.iter().filter_map(|side| side.rehearsal);
        let share = |found: Rehearsal| found.told as f64 / found.of.max(1) as f64;
        rehearsals.map(share).fold(1.0, f64::min)
    }

    /// Whether its rehearsals went well, where there are any.
    pub fn passes(&self, limits: &Limits) -> bool {
        let told = self.sides.iter().filter(|side| side.is_told);
        let went_well = |found: Rehearsal| {
            found.of == limits.rehearsals && found.of - found.told <= limits.failures()
        };
        told.map(|side| side.rehearsal).all(|found| found.is_some_and(went_well))
    }
}

impl Limits {
    /// Rehearsals that may fail.
    ///
    /// A model is not the joint: of the failures that the power allows, half are kept for that.
    fn failures(&self) -> usize {
        const KEPT: f64 = 0.5;
        let allowed = KEPT * (1.0 - self.power).max(0.0) * self.rehearsals as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
        let allowed = (allowed + 1e-9) as usize;
        allowed
    }
}
