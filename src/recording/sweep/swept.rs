//! A joint over all settings, as it is recorded.

use crate::delay::sweep::{Agreement, Grid, ReportedDelay, SweptStep};
use crate::experiment::Trial;
use crate::recording::chunk::Index;
use crate::recording::layout::TrialStarts;
use crate::recording::palette::{self, Rgb};
use crate::report::ReportedSweep;
use crate::report::sweep::run_text;

/// A joint over all settings, as it is recorded.
pub(super) struct Swept<'a> {
    pub(super) grid: &'a Grid,
    pub(super) reported: ReportedSweep<'a>,
    /// Each run in words.
    pub(super) names: Vec<String>,
    /// For each run how many combinations it represents.
    pub(super) votes: Vec<usize>,
    /// Each step, with the trial that it lies in.
    pub(super) steps: Vec<(&'a SweptStep, &'a Trial)>,
    /// Where the steps lie.
    pub(super) index: Index,
}

impl<'a> Swept<'a> {
    pub(super) fn of(grid: &'a Grid, reported: ReportedSweep<'a>, starts: &TrialStarts) -> Self {
        let trials = &reported.joint.trials;
        let trial_of = |step: &SweptStep| trials.iter().find(|trial| trial.label() == step.trial);
        let steps = reported.sweep.steps.iter();
        let steps: Vec<_> = steps.filter_map(|step| Some((step, trial_of(step)?))).collect();
        let start = |trial: &Trial| starts.of_trial(trial);
        let samples = steps.iter().map(|(step, trial)| start(trial).sample(step.sample));
        let times = steps.iter().map(|(step, trial)| start(trial).time_ns(trial, step.sample));
        let index = Index::on("segment", (1..).take(steps.len()));
        let index = index.with("sample", samples).with("time", times);
        let mut votes = vec![0; grid.runs().len()];
        for one in grid.combinations() {
            votes.get_mut(one.run).into_iter().for_each(|votes| *votes += 1);
        }
        let names = grid.runs().iter().map(run_text).collect();
        Self { grid, reported, names, votes, steps, index }
    }

    /// A tick per run.
    pub(super) fn settings(&self) -> Index {
        Index::on("setting", (1..).take(self.names.len()))
    }

    /// What a run reports of a step.
    pub(super) fn cell(step: &SweptStep, run: usize) -> Cell {
        let found = step.delays.get(run).copied().flatten();
        match (found, step.agreement) {
            (None, _) => Cell { opinion: Opinion::Silent, by: 0.0 },
            (Some(_), None) => Cell { opinion: Opinion::Same, by: 0.0 },
            (Some(found), Some(agreed)) => Cell::of(&found, &agreed),
        }
    }

    /// The delay that a run reports of a step; samples.
    pub(super) fn delay(step: &SweptStep, run: usize) -> Option<f64> {
        Some(step.delays.get(run).copied().flatten()?.delay)
    }
}

/// What a setting reports of a step, beside what most report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub(super) opinion: Opinion,
    /// By how many samples more than it allows its delay differs.
    pub(super) by: f64,
}

impl Cell {
    fn of(found: &ReportedDelay, agreed: &Agreement) -> Self {
        let (longer, shorter) = (found.low - agreed.low, agreed.high - found.high);
        let by = longer.max(shorter);
        let opinion = match by {
            ..=0.0 => Opinion::Same,
            _ if longer >= shorter => Opinion::Longer,
            _ => Opinion::Shorter,
        };
        Self { opinion, by }
    }

    /// How far it is from what most say; what is not accepted is next to what agrees.
    pub(super) fn weight(self) -> f64 {
        match self.opinion {
            Opinion::Same => -2.0,
            Opinion::Silent => -1.0,
            Opinion::Longer | Opinion::Shorter => self.by,
        }
    }
}

/// Which way it differs, if at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Opinion {
    /// It did not accept the step.
    Silent,
    Same,
    Longer,
    Shorter,
}

impl Opinion {
    /// What it is drawn in.
    pub(super) fn rgb(self) -> Rgb {
        match self {
            Self::Silent => palette::SILENT,
            Self::Same => palette::SAME,
            Self::Longer => palette::LONGER,
            Self::Shorter => palette::SHORTER,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_is_longer_or_shorter_than_what_most_allow() {
        let agreed = Agreement { delay: 10.0, low: 9.5, high: 11.0, combinations: 3 };
        let cell = |low, high| {
            Cell::of(&ReportedDelay { delay: f64::midpoint(low, high), low, high }, &agreed)
        };
        assert_eq!(cell(9.0, 11.0).opinion, Opinion::Same);
        assert_eq!(cell(12.0, 14.0), Cell { opinion: Opinion::Longer, by: 2.5 });
        assert_eq!(cell(4.0, 6.0), Cell { opinion: Opinion::Shorter, by: 5.0 });
        let silent = Cell { opinion: Opinion::Silent, by: 0.0 };
        assert!(cell(4.0, 6.0).weight() > silent.weight());
        assert!(silent.weight() > cell(9.0, 11.0).weight());
    }
}
