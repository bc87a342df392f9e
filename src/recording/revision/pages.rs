//! All pages on the revisions of a model, and what a program reads of them.

use rerun::{EntityPath, Scalars, TextDocument};

use super::figure::Held;
use super::{evidence, ladder, ranking, record, words};
use crate::diagnosis::Comparison;
use crate::explain::{Change, Revision};
use crate::recording::canvas::Labels;
use crate::recording::chunk::{Chunks, Index, Moment, lists};
use crate::recording::error::RecordError;
use crate::recording::error_share;
use crate::recording::layout::{JointLayout, TrialLayout};
use crate::recording::palette;
use crate::recording::paths::{at, revision as paths};
use crate::recording::rows::Rows;
use crate::report::{ComparedJoint, ImprovedJoint};

/// Width and height of the sheet with ladder, evidence and ranking.
pub(in crate::recording) const SIZE: (f32, f32) = (1900.0, 520.0);

/// Rows of the joint that is recorded.
struct Steps<'c> {
    chunks: &'c mut Chunks,
    root: EntityPath,
    numbers: Vec<i64>,
    index: Index,
    /// Whether the index begins with a tick that shows the last revision.
    opens_on_last: bool,
}

/// Adds everything on the revisions of `improved` below `root`/revision.
pub(in crate::recording) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    layout: &JointLayout<'_>,
    improved: &ImprovedJoint<'_>,
) -> Result<(), RecordError> {
    let start = layout.trials.first().map(|trial: &TrialLayout<'_>| trial.moment_of(1));
    let Some(start) = start else { return Ok(()) };
    // Before the first tick, where a viewer may open.
    let moment = Moment { decision: 0, ..start };
    let numbers: Vec<i64> = improved.numbered().map(|(number, _)| i64::from(number)).collect();
    let rank = layout.segments().next().map(|_| 1);
    let opening = layout.first.revision.filter(|tick| numbers.iter().all(|number| number > tick));
    let ticks = opening.into_iter().chain(numbers.iter().copied()).collect();
    let index = Index::of_revisions(ticks, moment, rank);
    let root = at(root, paths::ROOT);
    let opens_on_last = opening.is_some();
    let mut steps = Steps { chunks, root, numbers, index, opens_on_last };
    steps.figures(improved)?;
    steps.words(layout, improved)?;
    let models: Vec<_> = improved.revisions.iter().map(|revision| &revision.comparison).collect();
    let joint = improved.finding.compared.joint;
    record::add(&mut steps.rows(paths::record::ROOT), layout, joint, &models)?;
    let evidence = evidence::evidence(improved);
    steps.evidence(&evidence)?;
    let mut rows = steps.rows(paths::sheet::ROOT);
    ladder::add(&mut rows, improved)?;
    ranking::add(&mut rows, improved)?;
    evidence::add(&mut rows, &evidence)?;
    around(&mut rows, improved, &evidence)?;
    steps.shares(improved)
}

/// The grid, the noise and the texts of the sheet.
fn around(
    rows: &mut Rows<'_>,
    improved: &ImprovedJoint<'_>,
    evidence: &evidence::Evidence,
) -> Result<(), RecordError> {
    let (mut noise, mut names, mut texts) = (Vec::new(), Vec::new(), Vec::new());
    let mut grids = Vec::new();
    for at in 0..improved.revisions.len() {
        let (grid, mut labels) = evidence.sheet(at).into_parts();
        let mut floor = Labels::default();
        let mut lines = ladder::around(improved, at, &mut labels, &mut floor);
        lines.extend(ranking::around(improved, at, &mut labels, &mut floor));
        grids.push(grid);
        noise.push(lines);
        names.push(floor);
        texts.push(labels);
    }
    rows.strips(paths::sheet::GRID, palette::GRID, 0.7, grids.into_iter())?;
    rows.strips(paths::sheet::NOISE, palette::NOISE, 1.6, noise.into_iter())?;
    rows.texts(paths::sheet::NOISE_NAME, palette::NOISE, names.into_iter())?;
    rows.texts(paths::sheet::TEXTS, palette::BORDER, texts.into_iter())
}

impl Steps<'_> {
    fn rows(&mut self, path: &str) -> Rows<'_> {
        let root = at(&self.root, path);
        let rows = Rows::new(self.chunks, root, self.index.clone()).back_to_front();
        if self.opens_on_last { rows.opening_on_last() } else { rows }
    }

    /// Errors and what was added, for programs.
    fn figures(&mut self, improved: &ImprovedJoint<'_>) -> Result<(), RecordError> {
        type Effect = fn(&Revision) -> Option<&'static str>;
        type Figure = fn(&Comparison) -> Option<f64>;
        let figures: [(&str, Figure); 3] = [
            (paths::VALIDATION_RMSE, |c| c.validation.map(|error| error.rmse)),
            (paths::TRAINING_RMSE, |c| c.training.map(|error| error.rmse)),
            (paths::NOISE_FLOOR, |c| c.sensor_noise),
        ];
        for (path, figure) in figures {
            let all = improved.revisions.iter().map(|revision| figure(&revision.comparison));
            let lengths = all.clone().map(|value| usize::from(value.is_some()));
            let columns = Scalars::new(all.clone().flatten()).columns(lengths)?;
            let entity = at(&self.root, path);
            self.chunks.push_revisions(entity, self.numbers.clone(), columns)?;
        }
        let changes: [(&str, Effect); 2] = [(paths::ADDED, added), (paths::REMOVED, removed)];
        for (path, effect) in changes {
            let effects: Vec<_> = improved.revisions.iter().map(effect).collect();
            let lengths = effects.iter().map(|effect| usize::from(effect.is_some()));
            let texts =
                TextDocument::update_fields().with_many_text(effects.iter().flatten().copied());
            let entity = at(&self.root, path);
            self.chunks.push_revisions(entity, self.numbers.clone(), texts.columns(lengths)?)?;
        }
        Ok(())
    }

    /// Speeds and laws, for programs.
    fn evidence(&mut self, evidence: &evidence::Evidence) -> Result<(), RecordError> {
        type Column = fn(&Held) -> f64;
        let points = |value: Column| -> Vec<Vec<f64>> {
            evidence.held.iter().map(|held| held.iter().map(value).collect()).collect()
        };
        let law = |place: fn(&(f64, f64)) -> f64| -> Vec<Vec<f64>> {
            evidence.laws.iter().map(|law| law.iter().map(place).collect()).collect()
        };
        let columns = [
            lists("input", &points(|held| held.level)),
            lists("speed", &points(|held| held.speed)),
            lists("speed_std_error", &points(|held| held.std_error)),
            lists("simulated_speed", &points(|held| held.simulated.unwrap_or(f64::NAN))),
            lists("law_input", &law(|point| point.0)),
            lists("law_speed", &law(|point| point.1)),
        ];
        let entity = at(&self.root, paths::EVIDENCE);
        self.chunks.push_revisions(entity, self.numbers.clone(), columns)
    }

    fn words(
        &mut self,
        layout: &JointLayout<'_>,
        improved: &ImprovedJoint<'_>,
    ) -> Result<(), RecordError> {
        type Page = fn(&JointLayout<'_>, &ImprovedJoint<'_>, usize) -> String;
        let last = improved.revisions.len().checked_sub(1).filter(|_| self.opens_on_last);
        let shown: Vec<_> = last.into_iter().chain(0..improved.revisions.len()).collect();
        let pages: [(&str, Page); 2] =
            [(paths::WORDS, words::page), (paths::PARAMETERS, words::parameters)];
        for (path, page) in pages {
            let texts: Vec<_> = shown.iter().map(|at| page(layout, improved, *at)).collect();
            let columns = TextDocument::update_fields()
                .with_many_text(texts)
                .with_many_media_type(vec![rerun::MediaType::markdown(); shown.len()])
                .columns_of_unit_batches()?;
            self.chunks.push(at(&self.root, path), self.index.clone(), columns)?;
        }
        Ok(())
    }

    /// Where the error of each revision is.
    fn shares(&mut self, improved: &ImprovedJoint<'_>) -> Result<(), RecordError> {
        let compared = |revision: u32, comparison| ComparedJoint {
            revision,
            comparison,
            ..improved.finding.compared
        };
        let of_each = improved.numbered().zip(0..).map(|((number, revision), place)| {
            let shares = error_share::Drawing::of(&[&compared(number, &revision.comparison)]);
            (shares, palette::model(place))
        });
        let (mut grids, mut texts) = (Vec::new(), Vec::new());
        let (mut bars, mut marks) = (Vec::new(), Vec::new());
        for (drawing, rgb) in of_each {
            bars.push(drawing.filling(rgb));
            let (grid, labels) = drawing.sheet.into_parts();
            grids.push(grid);
            texts.push(labels);
            marks.push(drawing.marks);
        }
        let mut rows = self.rows(paths::share::ROOT);
        rows.strips(paths::share::GRID, palette::GRID, 0.7, grids.into_iter())?;
        rows.colored(paths::share::BARS, error_share::HATCH, bars.into_iter())?;
        rows.strips(paths::share::TIME, palette::BORDER, 1.6, marks.into_iter())?;
        rows.texts(paths::share::TEXTS, palette::BORDER, texts.into_iter())
    }
}

fn added(revision: &Revision) -> Option<&'static str> {
    match revision.change {
        Change::Added(id) | Change::Replaced { new: id, .. } => Some(id),
        Change::Start | Change::Removed(_) => None,
    }
}

fn removed(revision: &Revision) -> Option<&'static str> {
    match revision.change {
        Change::Removed(id) | Change::Replaced { old: id, .. } => Some(id),
        Change::Start | Change::Added(_) => None,
    }
}
