//! Delays over all settings: which of them move, with what, and which settings agree.
//!
//! A page per joint shows all its steps at all settings and stays as it is; a cursor on the
//! timeline `setting` (a tick per run) and one on `segment` (a tick per step) go through it.
//! A second page has the output around one step with what each setting makes of it.

mod about;
mod data;
mod map;
mod sheet;
mod step;
mod words;

use rerun::ApplicationId;
use rerun::log::LogMsg;

use super::blueprint::{self, Ladder};
use super::chunk::{Chunks, Index};
use super::content::{Content, Part, Take, hashed, name_of};
use super::entity::joint_root;
use super::error::RecordError;
use super::layout::TrialStarts;
use super::palette::{self, Rgb};
use crate::delay::sweep::{Agreement, Grid, SweptStep, Told};
use crate::experiment::{ReadOptions, Source, Trial};
use crate::report::{ReportedSweep, run_text};

pub(super) use sheet::PARTS;
pub(super) use sheet::SIZE;
pub(super) use step::PARTS as STEP_PARTS;
pub(super) use step::SIZE as STEP_SIZE;

/// Everything that a recording of a sweep holds.
#[derive(Clone, Copy, Debug)]
pub struct SweepRecording<'a> {
    /// The joints, in the order of their tabs.
    pub joints: &'a [ReportedSweep<'a>],
    /// The settings that were tried.
    pub grid: &'a Grid,
    /// Delays that differ by so many samples more than each allows still agree.
    pub tolerance: f64,
    /// The files that were read.
    pub sources: &'a [Source],
    /// How they were read.
    pub reading: &'a ReadOptions,
}

impl Content for SweepRecording<'_> {
    fn name(&self) -> String {
        format!("{}, sweep", name_of(self.sources))
    }

    fn id(&self) -> String {
        hashed(self.sources, self.joints.iter().map(|joint| joint.joint), |part| {
            part(&format!("sweep {:?} {}", self.grid, self.tolerance));
        })
    }

    fn namespaces(&self) -> u64 {
        self.joints.len() as u64 + 1
    }

    fn for_each_chunk(&self, part: Part<'_>, take: Take<'_>) -> Result<(), RecordError> {
        let starts = TrialStarts::of(self.joints.iter().map(|joint| joint.joint));
        let mut chunks = Chunks::new(part.used + 2);
        if part.joint.is_none() {
            about::add(&mut chunks, self)?;
        }
        let numbered = (part.used + 3..).zip(self.joints);
        for (namespace, joint) in numbered.filter(|(_, joint)| part.has(joint.joint)) {
            chunks.into_chunks().iter().try_for_each(&mut *take)?;
            chunks = Chunks::new(namespace);
            Swept::of(self, *joint, &starts).add(&mut chunks)?;
        }
        chunks.into_chunks().iter().try_for_each(take)
    }

    fn views(
        &self,
        _: Ladder,
        application: &ApplicationId,
        id: &str,
    ) -> Result<Vec<LogMsg>, RecordError> {
        blueprint::sweep_messages(self, application, id)
    }

    fn views_in_words(&self, _: Ladder) -> String {
        let joints: Vec<_> = self.joints.iter().map(|joint| &joint.joint.name).collect();
        format!("sweep {joints:?}")
    }
}

/// A joint over all settings, as it is recorded.
struct Swept<'a> {
    grid: &'a Grid,
    reported: ReportedSweep<'a>,
    /// Each run in words.
    names: Vec<String>,
    /// For each run how many combinations it stands for.
    votes: Vec<usize>,
    /// Each step, with the trial that it lies in.
    steps: Vec<(&'a SweptStep, &'a Trial)>,
    /// Where the steps lie.
    index: Index,
}

impl<'a> Swept<'a> {
    fn of(
        recording: &SweepRecording<'a>,
        reported: ReportedSweep<'a>,
        starts: &TrialStarts,
    ) -> Self {
        let grid = recording.grid;
        let trials = &reported.joint.trials;
        let trial_of = |step: &SweptStep| trials.iter().find(|trial| trial.label() == step.trial);
        let steps = reported.sweep.steps.iter();
        let steps: Vec<_> = steps.filter_map(|step| Some((step, trial_of(step)?))).collect();
        let mut index = Index::default();
        for ((step, trial), number) in steps.iter().zip(1..) {
            let start = starts.of_trial(trial);
            index.segment.push(number);
            index.sample.push(start.sample(step.sample));
            index.time_ns.push(start.time_ns(trial, step.sample));
        }
        let mut votes = vec![0; grid.runs().len()];
        for one in grid.combinations() {
            votes.get_mut(one.run).into_iter().for_each(|votes| *votes += 1);
        }
        let names = grid.runs().iter().map(run_text).collect();
        Self { grid, reported, names, votes, steps, index }
    }

    fn add(&self, chunks: &mut Chunks) -> Result<(), RecordError> {
        let root = joint_root(&self.reported.joint.name);
        data::add(chunks, &root, self)?;
        sheet::add(chunks, &root, self)?;
        step::add(chunks, &root, self)?;
        words::add(chunks, &root, self)
    }

    /// A tick per run.
    fn settings(&self) -> Index {
        Index::of_settings(self.names.len())
    }

    /// What a run tells of a step.
    fn cell(step: &SweptStep, run: usize) -> Cell {
        let Some(told) = step.told.get(run).copied().flatten() else { return Cell::Silent };
        step.agreement.map_or(Cell::Same, |agreed| Cell::of(&told, &agreed))
    }

    /// The delay that a run tells of a step; samples.
    fn delay(step: &SweptStep, run: usize) -> Option<f64> {
        Some(step.told.get(run).copied().flatten()?.delay)
    }
}

/// What a setting tells of a step, beside what most say.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cell {
    /// Nothing: it did not accept it.
    Silent,
    /// What most say.
    Same,
    /// A longer delay, by so many samples more than it allows.
    Longer(f64),
    /// A shorter one.
    Shorter(f64),
}

impl Cell {
    fn of(told: &Told, agreed: &Agreement) -> Self {
        let (longer, shorter) = (told.low - agreed.low, agreed.high - told.high);
        if longer.max(shorter) <= 0.0 {
            Self::Same
        } else if longer >= shorter {
            Self::Longer(longer)
        } else {
            Self::Shorter(shorter)
        }
    }

    /// How far it is from what most say; what is not accepted is next to what agrees.
    fn weight(self) -> f64 {
        match self {
            Self::Same => -2.0,
            Self::Silent => -1.0,
            Self::Longer(by) | Self::Shorter(by) => by,
        }
    }

    /// What it is drawn in.
    fn rgb(self) -> Rgb {
        match self {
            Self::Silent => palette::SILENT,
            Self::Same => palette::SAME,
            Self::Longer(_) => palette::LONGER,
            Self::Shorter(_) => palette::SHORTER,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_is_longer_or_shorter_than_what_most_allow() {
        let agreed = Agreement { delay: 10.0, low: 9.5, high: 11.0, combinations: 3 };
        let cell =
            |low, high| Cell::of(&Told { delay: f64::midpoint(low, high), low, high }, &agreed);
        assert_eq!(cell(9.0, 11.0), Cell::Same);
        assert_eq!(cell(12.0, 14.0), Cell::Longer(2.5));
        assert_eq!(cell(4.0, 6.0), Cell::Shorter(5.0));
        assert!(cell(4.0, 6.0).weight() > Cell::Silent.weight());
        assert!(Cell::Silent.weight() > Cell::Same.weight());
    }
}
