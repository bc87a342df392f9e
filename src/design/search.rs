//! The shortest input that tells two suspects apart.

use super::distance::expected;
use super::family::{Family, Order, families};
use super::glance::Glance;
use super::power::{Distance, Expected};
use super::predict::Stand;
use super::rehearsal::{Rehearsal, rehearse};
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
/// passes. A suspect that the other can imitate in whatever input, as one that it contains, is
/// left out of it.
///
/// # Errors
/// [`DesignError`] where no input will do.
pub fn shortest(
    suspects: &Suspects,
    stand: &Stand,
    limits: &Limits,
    workers: &impl Workers,
) -> Result<Design, DesignError> {
    let (mut best, mut second) = (0.0, None);
    // Short inputs are soon looked through, and mostly there is one.
    for part in [0.125, 0.25, 0.5, 1.0] {
        let longest_s = part * limits.longest_s;
        let field = Field { suspects, stand, limits: Limits { longest_s, ..*limits } };
        let families = families(suspects, stand, &field.limits);
        if families.is_empty() && part >= 1.0 {
            return Err(DesignError::OutOfRange { largest: limits.largest });
        }
        let seen = workers.map(&families, |family| Glances::at(suspects, stand, family));
        let seen = families.iter().zip(seen).filter_map(|(family, seen)| Some((family, seen?)));
        let seen: Vec<(&Family, Glances)> = seen.collect();
        let can = |truth: usize| {
            let is_enough = |(family, seen): &(&Family, Glances)| {
                let whole = family.schedule.holds().len();
                seen.best_known(truth, family, whole) >= limits.power
            };
            seen.iter().any(is_enough)
        };
        // One of them alone is told only where all the time there is does not show the other.
        let aims = if part < 1.0 { [true; 2] } else { [can(0), can(1)] };
        let found = field.first_to_pass(&seen, aims, workers);
        if let Some(design) = found.passed {
            return Ok(design);
        }
        best = f64::max(best, found.power);
        second = better(second, found.second);
    }
    // Its power will do, and how its rehearsals went is told.
    second.ok_or(DesignError::NotApart { wanted: limits.power, best, longest_s: limits.longest_s })
}

/// The design of which more rehearsals went well; of two as good, the first.
fn better(one: Option<Design>, other: Option<Design>) -> Option<Design> {
    match (one, other) {
        (Some(one), Some(other)) if one.share_told() >= other.share_told() => Some(one),
        (one, other) => other.or(one),
    }
}

/// What came of inputs up to some length.
#[derive(Default)]
struct Found {
    /// The shortest that passes.
    passed: Option<Design>,
    /// Where none does, the one whose rehearsals went best.
    second: Option<Design>,
    /// The best power.
    power: f64,
}

/// What is to be told apart, where, and with what.
struct Field<'a> {
    suspects: &'a Suspects,
    stand: &'a Stand,
    limits: Limits,
}

impl Field<'_> {
    /// The shortest input of `seen` that passes; where none does, the best power, and the input
    /// whose rehearsals went best.
    ///
    /// From the shortest length that may do the inputs become longer by a small part at a
    /// time; of each length those are judged that a glance finds best.
    fn first_to_pass(
        &self,
        seen: &[(&Family, Glances)],
        aims: [bool; 2],
        workers: &impl Workers,
    ) -> Found {
        /// A length and the next.
        const LONGER: f64 = 1.1;
        let least = |(family, seen): &(&Family, Glances)| {
            let count = seen.fewest(family, aims, self.limits.power)?;
            Some(family.schedule.first(count).duration_s())
        };
        let mut found = Found::default();
        let Some(mut length_s) = seen.iter().filter_map(least).min_by(f64::total_cmp) else {
            return found;
        };
        while length_s <= self.limits.longest_s * LONGER {
            let design = self.best_of_length(seen, aims, length_s, workers);
            let power = design.as_ref().map_or(0.0, Design::power);
            found.power = found.power.max(power);
            if let Some(design) = design.filter(|design| design.power() >= self.limits.power) {
                let design = self.rehearsed(design, workers);
                if design.passes(&self.limits) {
                    return Found { passed: Some(design), ..found };
                }
                found.second = better(found.second, Some(design));
            }
            length_s *= LONGER;
        }
        found
    }

    /// The best input that is not longer.
    fn best_of_length(
        &self,
        seen: &[(&Family, Glances)],
        aims: [bool; 2],
        length_s: f64,
        workers: &impl Workers,
    ) -> Option<Design> {
        /// Inputs of one length that are judged in full.
        const JUDGED: usize = 3;
        let glanced = seen.iter().filter_map(|(family, seen)| {
            let count = family.schedule.fitting(length_s);
            (count > 1).then(|| (seen.margin(family, aims, count), *family, count))
        });
        let mut glanced: Vec<(f64, &Family, usize)> = glanced.collect();
        glanced.sort_by(|a, b| b.0.total_cmp(&a.0));
        glanced.truncate(JUDGED);
        let judged = glanced.into_iter().filter_map(|(_, family, count)| {
            self.judged(aims, family.order, family.schedule.first(count), workers)
        });
        judged.max_by(|a, b| a.margin().total_cmp(&b.margin()))
    }

    /// What is expected of `schedule`, which is to tell the suspects `aims`; `None` where it is
    /// too short for a fit.
    fn judged(
        &self,
        aims: [bool; 2],
        order: Order,
        schedule: Schedule,
        workers: &impl Workers,
    ) -> Option<Design> {
        let of = |truth: &usize| {
            let model = &self.suspects.models.get(*truth)?.model;
            expected(self.suspects, *truth, model, (self.stand, &schedule))
        };
        let found = workers.map(&[0, 1], of);
        let [Some(one), Some(other)] = found.as_slice() else { return None };
        let side = |expected: Expected, is_told| Side { expected, is_told, rehearsal: None };
        let sides = [side(*one, aims[0]), side(*other, aims[1])];
        Some(Design { order, schedule, sides })
    }

    /// `design` with its rehearsals, as long as they go well.
    fn rehearsed(&self, mut design: Design, workers: &impl Workers) -> Design {
        let failures = self.limits.failures();
        let count = (self.limits.rehearsals, failures);
        let at = (self.stand, &design.schedule);
        for (truth, side) in design.sides.iter_mut().enumerate().filter(|(_, s)| s.is_told) {
            let found = rehearse(self.suspects, truth, at, count, workers);
            side.rehearsal = Some(found);
            if found.of - found.told > failures {
                break;
            }
        }
        design
    }
}

impl Design {
    /// The least power of the suspects that it is to tell.
    pub fn power(&self) -> f64 {
        let told = self.sides.iter().filter(|side| side.is_told);
        told.map(|side| side.expected.power()).fold(1.0, f64::min)
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

/// What a glance shows of both suspects: the other, and the model with neither.
struct Glances {
    rivals: [Glance; 2],
    plain: [Glance; 2],
    noise: f64,
}

impl Glances {
    fn at(suspects: &Suspects, stand: &Stand, family: &Family) -> Option<Self> {
        let glance = |truth: usize, rival: &JointModel| {
            Glance::at(suspects, truth, rival, (stand, &family.schedule))
        };
        let [one, other] = &suspects.models;
        let rivals = [glance(0, &other.model)?, glance(1, &one.model)?];
        let plain = [glance(0, &suspects.base)?, glance(1, &suspects.base)?];
        Some(Self { rivals, plain, noise: suspects.noise })
    }

    /// The power for one suspect of the first `count` holds, at the numbers that are known best.
    fn best_known(&self, truth: usize, family: &Family, count: usize) -> f64 {
        self.expected(truth, family, count).first().map_or(0.0, Expected::power)
    }

    /// What is expected for one suspect of the first `count` holds: at the numbers that are
    /// known best, and at others.
    fn expected(&self, truth: usize, family: &Family, count: usize) -> Vec<Expected> {
        let far = |glances: &[Glance; 2]| {
            let glance = glances.get(truth);
            glance.map(|glance| glance.noncentralities(&family.schedule, count, self.noise))
        };
        let samples = (family.schedule.first(count).samples(), 0);
        let distance = |training| Distance { training, ..Distance::default() };
        let pairs =
            far(&self.rivals).into_iter().flatten().zip(far(&self.plain).into_iter().flatten());
        let expected = pairs.map(|(rival, neither)| Expected {
            samples,
            rival: distance(rival),
            own: Distance::default(),
            neither: distance(neither),
        });
        expected.collect()
    }

    /// By how many standard deviations the suspects of `aims` are told at least.
    fn margin(&self, family: &Family, aims: [bool; 2], count: usize) -> f64 {
        let told = aims.iter().enumerate().filter(|(_, aim)| **aim);
        let expected = told.flat_map(|(truth, _)| self.expected(truth, family, count));
        let margins = expected.map(|expected| expected.margin());
        margins.fold(f64::INFINITY, f64::min)
    }

    /// The fewest holds that may tell the suspects of `aims`; `None` where all of them do not.
    fn fewest(&self, family: &Family, aims: [bool; 2], power: f64) -> Option<usize> {
        let enough = |count: usize| {
            let mut told = aims.iter().enumerate().filter(|(_, aim)| **aim);
            told.all(|(truth, _)| self.best_known(truth, family, count) >= power)
        };
        let all = family.schedule.holds().len();
        if aims == [false; 2] || !enough(all) {
            return None;
        }
        let (mut below, mut above) = (1, all);
        while above - below > 1 {
            let middle = usize::midpoint(below, above);
            if enough(middle) { above = middle } else { below = middle }
        }
        Some(above)
    }
}
