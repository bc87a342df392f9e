//! The linear screen of an input for both suspects.

use super::family::Family;
use super::linear_screen::LinearScreen;
use super::power::{Distance, Expected};
use super::predict::TestRig;
use super::suspects::Suspects;
use crate::model::JointModel;

/// The linear screen of an input for both suspects: beside the other, and beside the model with
/// neither.
pub(super) struct PairScreen {
    rivals: [LinearScreen; 2],
    plain: [LinearScreen; 2],
    noise: f64,
}

impl PairScreen {
    pub(super) fn of(suspects: &Suspects, rig: &TestRig, family: &Family) -> Option<Self> {
        let screen = |truth: usize, rival: &JointModel| {
            LinearScreen::of(suspects, truth, rival, (rig, &family.schedule))
        };
        let [one, other] = &suspects.models;
        let rivals = [screen(0, &other.model)?, screen(1, &one.model)?];
        let plain = [screen(0, &suspects.base)?, screen(1, &suspects.base)?];
        Some(Self { rivals, plain, noise: suspects.noise })
    }

    /// Includes one more output of the suspect number `truth`.
    pub(super) fn add(&mut self, truth: usize, output: &[f64]) {
        self.rivals[truth].add(output);
        self.plain[truth].add(output);
    }

    /// The power for one suspect of the first `count` holds, at the numbers that are known best.
    pub(super) fn best_known(&self, truth: usize, family: &Family, count: usize) -> f64 {
        self.expected(truth, family, count).first().map_or(0.0, Expected::power)
    }

    /// What is expected for one suspect of the first `count` holds: at the numbers that are
    /// known best, and at others.
    fn expected(&self, truth: usize, family: &Family, count: usize) -> Vec<Expected> {
        let noncentralities =
            |screen: &LinearScreen| screen.noncentralities(&family.schedule, count, self.noise);
        let samples = (family.schedule.first(count).samples(), 0);
        let distance = |training| Distance { training, ..Distance::default() };
        let neither = noncentralities(&self.plain[truth]);
        let pairs = noncentralities(&self.rivals[truth]).into_iter().zip(neither);
        let expected = pairs.map(|(rival, neither)| Expected {
            samples,
            rival: distance(rival),
            own: Distance::default(),
            neither: distance(neither),
        });
        expected.collect()
    }

    /// By how many standard deviations the suspects of `targets` are separated at least.
    pub(super) fn margin(&self, family: &Family, targets: [bool; 2], count: usize) -> f64 {
        let truths = (0..2).filter(|truth| targets[*truth]);
        let expected = truths.flat_map(|truth| self.expected(truth, family, count));
        let margins = expected.map(|expected| expected.margin());
        margins.fold(f64::INFINITY, f64::min)
    }

    /// The fewest holds that may separate the suspects of `targets`; `None` where all of them do
    /// not.
    pub(super) fn fewest(&self, family: &Family, targets: [bool; 2], power: f64) -> Option<usize> {
        let enough = |count: usize| {
            let mut truths = (0..2).filter(|truth| targets[*truth]);
            truths.all(|truth| self.best_known(truth, family, count) >= power)
        };
        let all = family.schedule.holds().len();
        if targets == [false; 2] || !enough(all) {
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
