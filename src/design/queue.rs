//! Inputs that may be judged in full, with what the linear screen shows of them.

use super::family::{Family, families};

use super::problem::Problem;
use super::screen::Screen;
use crate::explain::Workers;
use crate::model::JointModel;

/// An input that may be judged.
pub(super) struct Entry {
    pub(super) family: Family,
    pub(super) screen: Screen,
    /// By how much it was worse than in the screen when it was judged last; 0 or less.
    offset: f64,
}

/// All inputs that may do, with the numbers `hard` of each suspect in their screens.
pub(super) fn queue(
    problem: &Problem<'_>,
    hard: &[Vec<JointModel>; 2],
    workers: &impl Workers,
) -> Vec<Entry> {
    let Problem { suspects, rig, limits } = problem;
    let families = families(suspects, rig, limits);
    let screens = workers.map(&families, |family| Screen::of(suspects, rig, &family.schedule));
    let entries = families.into_iter().zip(screens);
    let entries = entries.map(|(family, screen)| Entry { family, screen, offset: 0.0 });
    let mut queue: Vec<Entry> = entries.collect();
    for (truth, hard) in hard.iter().enumerate() {
        include(problem, &mut queue, truth, hard, workers);
    }
    queue
}

/// Includes the numbers `hard` of the suspect `truth` in all screens.
pub(super) fn include(
    problem: &Problem<'_>,
    queue: &mut [Entry],
    truth: usize,
    hard: &[JointModel],
    workers: &impl Workers,
) {
    let families: Vec<&Family> = queue.iter().map(|entry| &entry.family).collect();
    let outputs = workers.map(&families, |family| {
        let output = |model: &JointModel| problem.rig.output(model, &family.schedule);
        hard.iter().map(output).collect::<Vec<_>>()
    });
    for (entry, outputs) in queue.iter_mut().zip(outputs) {
        for output in outputs {
            entry.screen.add(truth, output);
        }
    }
}

impl Entry {
    /// The seconds that its beginning needs at least, in the screen, to separate the suspects
    /// of `targets` with `power`; `None` where the whole is too little.
    pub(super) fn least_s(&self, targets: [bool; 2], power: f64) -> Option<f64> {
        let count = self.screen.fewest(targets, power)?;
        Some(self.family.schedule.first(count).duration_s())
    }

    /// By how many standard deviations its first `count` holds separate the suspects of
    /// `targets`, as far as is known.
    pub(super) fn margin(&self, targets: [bool; 2], count: usize) -> f64 {
        self.screen.margin(targets, count) + self.offset
    }

    /// Takes `margin` for that of its first `count` holds, where it looked better.
    pub(super) fn correct(&mut self, margin: f64, targets: [bool; 2], count: usize) {
        let screened = self.screen.margin(targets, count);
        self.offset = (margin - screened).min(0.0);
    }
}
