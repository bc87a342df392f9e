//! The shortest input that separates two suspects.

use super::family::Family;
use super::limits::Limits;
use super::predict::TestRig;
use super::problem::{Findings, Problem};
use super::queue::{Entry, queue};
use super::result::{Design, DesignError};
use super::schedule::samples_in;
use super::suspects::Suspects;
use crate::explain::Workers;

/// Parts of the longest input that are searched in turn: short inputs are soon searched, and
/// mostly there is one.
const PARTS: [f64; 4] = [0.125, 0.25, 0.5, 1.0];

/// A length and the next, as a ratio. Chosen: the answer is at most so much too long.
const LONGER: f64 = 1.15;

/// Inputs of one length that are rehearsed. Chosen: each costs all its rehearsals.
const REHEARSED: usize = 2;

/// Inputs of one length that are judged in full. Chosen: each costs several fits.
const JUDGED: usize = 3;

/// The best power of all inputs below which they show nothing of the difference: that of a test
/// that is wrong once in a hundred times.
const IMITATED: f64 = 0.01;

/// The shortest input with the power that is wanted, of those that are tried.
///
/// A linear screen shows how long an input must be at least. From there on the best of each
/// length are judged with every model at its best fit, and the best of these is rehearsed, until
/// one passes. Whatever the screen took for better than it is comes later in the queue, and
/// numbers at which a rehearsal failed are in the screens from then on. A suspect that the other
/// can imitate in whatever input, as one that it contains, is left out of it. Where none passes
/// and it is open at which levels the effects switch, the input is one that explores.
///
/// `tried` gets the length of the inputs that come next, in seconds.
///
/// # Errors
/// [`DesignError`] where no input will do.
pub fn shortest(
    suspects: &Suspects,
    rig: &TestRig,
    limits: &Limits,
    workers: &impl Workers,
    tried: &(dyn Fn(f64) + Sync),
) -> Result<Design, DesignError> {
    let mut findings = Findings::default();
    let problem = |part: f64| {
        let longest_s = part * limits.longest_s;
        Problem { suspects, rig, limits: Limits { longest_s, ..*limits } }
    };
    let targets = suspects.excluded.map(|excluded| !excluded);
    let mut entries = Vec::new();
    let mut from_s = 0.0;
    for part in PARTS {
        let problem = problem(part);
        entries = queue(&problem, &findings.hard, workers);
        if entries.is_empty() && part >= 1.0 {
            return Err(DesignError::OutOfRange { largest: limits.largest });
        }
        let mut search = Search { problem, entries: &mut entries, findings: &mut findings, tried };
        if let Some(design) = search.first_to_pass(targets, from_s, workers) {
            return Ok(design);
        }
        // Shorter inputs have been searched.
        from_s = problem.limits.longest_s;
    }
    let problem = problem(1.0);
    // One of them alone is the target only where all the time there is does not show the other.
    let alone = findings.powers.map(|power| power >= limits.power);
    if findings.runner_up.is_none() && targets == [true; 2] && alone[0] != alone[1] {
        let mut search = Search { problem, entries: &mut entries, findings: &mut findings, tried };
        if let Some(design) = search.first_to_pass(alone, 0.0, workers) {
            return Ok(design);
        }
    }
    if let Some(design) = problem.exploring(targets, &findings, workers) {
        return Ok(design);
    }
    let Findings { runner_up, power: judged, .. } = findings;
    // Its power will do, and how its rehearsals went is reported.
    runner_up.ok_or_else(|| {
        let screened = entries.iter().map(|entry| entry.screen.best_power(targets));
        let best = screened.fold(judged, f64::max);
        let longest_s = limits.longest_s;
        if best < IMITATED {
            return DesignError::Imitated { longest_s };
        }
        DesignError::NotApart { wanted: limits.power, best, longest_s }
    })
}

/// The design of which more rehearsals succeeded; of two as good, the first.
fn better(one: Option<Design>, other: Option<Design>) -> Option<Design> {
    match (one, other) {
        (Some(one), Some(other)) if one.share_of_successes() >= other.share_of_successes() => {
            Some(one)
        }
        (one, other) => other.or(one),
    }
}

/// A search among inputs of growing length.
struct Search<'a, 's> {
    problem: Problem<'a>,
    entries: &'s mut [Entry],
    findings: &'s mut Findings,
    tried: &'a (dyn Fn(f64) + Sync),
}

impl Search<'_, '_> {
    /// The shortest input that passes, no shorter than `from_s`.
    ///
    /// From the shortest length that may do the inputs become longer by a small part at a
    /// time; of each length those are judged that are best as far as is known.
    fn first_to_pass(
        &mut self,
        targets: [bool; 2],
        from_s: f64,
        workers: &impl Workers,
    ) -> Option<Design> {
        let Limits { power, longest_s, .. } = self.problem.limits;
        let least = self.entries.iter().filter_map(|entry| entry.least_s(targets, power));
        let mut length_s = least.min_by(f64::total_cmp)?.max(from_s);
        while length_s <= longest_s * LONGER {
            (self.tried)(length_s.min(longest_s));
            for _ in 0..REHEARSED {
                let Some((index, design)) = self.best_of_length(targets, length_s, workers) else {
                    break;
                };
                self.findings.power = self.findings.power.max(design.power());
                if design.power() < power {
                    break;
                }
                let Self { problem, entries, findings, .. } = self;
                let design = problem.rehearsed(design, entries, index, findings, workers);
                if design.passes(&self.problem.limits) {
                    return Some(design);
                }
                let runner_up = self.findings.runner_up.take();
                self.findings.runner_up = better(runner_up, Some(design));
            }
            length_s *= LONGER;
        }
        None
    }

    /// The best input that is not longer, and its index among the entries.
    fn best_of_length(
        &mut self,
        targets: [bool; 2],
        length_s: f64,
        workers: &impl Workers,
    ) -> Option<(usize, Design)> {
        let mut screened = Vec::new();
        for (index, entry) in self.entries.iter().enumerate() {
            let schedule = &entry.family.schedule;
            let count = schedule.over_after(samples_in(length_s, schedule.period()));
            if count > 1 {
                screened.push((entry.margin(targets, count), index, count));
            }
        }
        screened.sort_by(|a, b| b.0.total_cmp(&a.0));
        screened.truncate(JUDGED);
        let mut best: Option<(f64, usize, Design)> = None;
        for (_, index, count) in screened {
            let entry = &mut self.entries[index];
            let Family { order, schedule } = &entry.family;
            let beginning = schedule.first(count);
            let found = self.problem.judged(targets, *order, beginning, self.findings, workers);
            let margin = found.as_ref().map_or(f64::NEG_INFINITY, |(margin, _)| *margin);
            entry.correct(margin, targets, count);
            let Some((margin, design)) = found else { continue };
            for (most, side) in self.findings.powers.iter_mut().zip(&design.sides) {
                *most = most.max(side.expected.power());
            }
            if best.as_ref().is_none_or(|(most, _, _)| margin > *most) {
                best = Some((margin, index, design));
            }
        }
        best.map(|(_, index, design)| (index, design))
    }
}
