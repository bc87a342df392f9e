//! An input judged in full: what the best fits are expected to show, and its rehearsals.

use super::distance::expected;
use super::explore::{exploring, open};
use super::power::Expected;
use super::problem::{Findings, Problem};
use super::queue::{Entry, include};
use super::rehearsal::{Rehearsed, rehearse};
use super::result::{Design, Order, Side};
use super::schedule::Schedule;
use crate::explain::Workers;
use crate::model::JointModel;

/// Numbers of a suspect at which a rehearsal failed that are kept. Chosen: each more is
/// simulated with every input of the queue.
const HARD: usize = 6;

impl Problem<'_> {
    /// What is expected of `schedule`, which is to separate the suspects `targets`, and the
    /// margin that it leaves at the numbers that are known best and at the last that were hard;
    /// `None` where it is too short for a fit.
    pub(super) fn judged(
        &self,
        targets: [bool; 2],
        order: Order,
        schedule: Schedule,
        findings: &Findings,
        workers: &impl Workers,
    ) -> Option<(f64, Design)> {
        let known = self.suspects.models.iter().map(|known| &known.model);
        let hard = findings.hard.iter().enumerate();
        let hard = hard.filter_map(|(truth, hard)| Some((truth, hard.last()?)));
        let hard = hard.filter(|(truth, _)| targets[*truth]);
        let all: Vec<(usize, &JointModel)> = known.enumerate().chain(hard).collect();
        let of = |(truth, model): &(usize, &JointModel)| {
            expected(self.suspects, *truth, model, (self.rig, &schedule))
        };
        let found: Option<Vec<Expected>> = workers.map(&all, of).into_iter().collect();
        let found = found?;
        let [one, other, hard @ ..] = found.as_slice() else { return None };
        let side = |expected: Expected, truth: usize| Side {
            expected,
            is_target: targets[truth],
            is_excluded: self.suspects.excluded[truth],
            rehearsal: None,
        };
        let sides = [side(*one, 0), side(*other, 1)];
        let design = Design { order, schedule, sides, explores: Vec::new() };
        let hard = hard.iter().map(Expected::margin).fold(f64::INFINITY, f64::min);
        Some((design.margin().min(hard), design))
    }

    /// `design`, which is that of `queue[index]`, with its rehearsals, as long as they go well:
    /// once to see whether it may do, and once more to be sure.
    pub(super) fn rehearsed(
        &self,
        mut design: Design,
        queue: &mut [Entry],
        index: usize,
        findings: &mut Findings,
        workers: &impl Workers,
    ) -> Design {
        let targets = [0, 1].map(|truth| design.sides[truth].is_target);
        let mut found = self.rehearsal(&mut design, targets, findings, workers);
        if design.passes(&self.limits) {
            // Of many inputs that are rehearsed the first to pass may have been lucky: it is
            // judged by rehearsals that had no part in its choice.
            found = self.rehearsal(&mut design, targets, findings, workers);
        }
        if design.passes(&self.limits) {
            return design;
        }
        for (truth, (hard, failed)) in findings.hard.iter_mut().zip(found.failed).enumerate() {
            let room = HARD.saturating_sub(hard.len());
            let new: Vec<JointModel> = failed.into_iter().take(room).collect();
            include(self, queue, truth, &new, workers);
            hard.extend(new);
        }
        // It comes again when it has become clearly better.
        let (entry, count) = (&mut queue[index], design.schedule.holds().len());
        entry.correct(entry.margin(targets, count).min(0.0), targets, count);
        design
    }

    /// Rehearsals of `design` that no other input had.
    fn rehearsal(
        &self,
        design: &mut Design,
        targets: [bool; 2],
        findings: &mut Findings,
        workers: &impl Workers,
    ) -> Rehearsed {
        let count = (self.limits.rehearsals, self.limits.failures(), findings.attempts);
        findings.attempts += 1;
        let found = rehearse(self.suspects, targets, (self.rig, &design.schedule), count, workers);
        for (side, rehearsal) in design.sides.iter_mut().zip(found.sides) {
            side.rehearsal = rehearsal;
        }
        found
    }

    /// An input that explores, where there is something to find.
    pub(super) fn exploring(
        &self,
        targets: [bool; 2],
        findings: &Findings,
        workers: &impl Workers,
    ) -> Option<Design> {
        let explores = open(self.suspects, targets, self.limits.largest);
        let schedule = exploring(self.suspects, self.rig, &self.limits, &explores)?;
        let (_, design) = self.judged(targets, Order::Exploring, schedule, findings, workers)?;
        Some(Design { explores, ..design })
    }
}
