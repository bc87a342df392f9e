//! What a glance shows of both suspects.

use super::family::Family;
use super::glance::Glance;
use super::power::{Distance, Expected};
use super::predict::Stand;
use super::suspects::Suspects;
use crate::model::JointModel;

/// What a glance shows of both suspects: the other, and the model with neither.
pub(super) struct Glances {
    rivals: [Glance; 2],
    plain: [Glance; 2],
    noise: f64,
}

impl Glances {
    pub(super) fn at(suspects: &Suspects, stand: &Stand, family: &Family) -> Option<Self> {
        let glance = |truth: usize, rival: &JointModel| {
            Glance::at(suspects, truth, rival, (stand, &family.schedule))
        };
        let [one, other] = &suspects.models;
        let rivals = [glance(0, &other.model)?, glance(1, &one.model)?];
        let plain = [glance(0, &suspects.base)?, glance(1, &suspects.base)?];
        Some(Self { rivals, plain, noise: suspects.noise })
    }

    /// Looks at one more output of the suspect number `truth`, too.
    pub(super) fn add(&mut self, truth: usize, output: &[f64]) {
        for glances in [&mut self.rivals, &mut self.plain] {
            if let Some(glance) = glances.get_mut(truth) {
                glance.add(output);
            }
        }
    }

    /// The power for one suspect of the first `count` holds, at the numbers that are known best.
    pub(super) fn best_known(&self, truth: usize, family: &Family, count: usize) -> f64 {
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
    pub(super) fn margin(&self, family: &Family, aims: [bool; 2], count: usize) -> f64 {
        let told = aims.iter().enumerate().filter(|(_, aim)| **aim);
        let expected = told.flat_map(|(truth, _)| self.expected(truth, family, count));
        let margins = expected.map(|expected| expected.margin());
        margins.fold(f64::INFINITY, f64::min)
    }

    /// The fewest holds that may tell the suspects of `aims`; `None` where all of them do not.
    pub(super) fn fewest(&self, family: &Family, aims: [bool; 2], power: f64) -> Option<usize> {
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
