//! All pages on the revisions of a model, and what a program reads of them.

use rerun::TextDocument;

use super::ladder::{Ladders, judged, noise};
use crate::diagnosis::Comparison;
use crate::explain::{Change, Revision};
use crate::figure::curves::Curves;
use crate::figure::{Panel, Role};
use crate::fit::Termination;
use crate::recording::canvas::Layers;
use crate::recording::chunk::{Chunks, Index, Moment};
use crate::recording::error::RecordError;
use crate::recording::layout::JointLayout;
use crate::recording::markdown::{plain, prose};
use crate::recording::model::add_record;
use crate::recording::panels::Placed;
use crate::recording::{panels, paths, residual};
use crate::report::ladder::change_in_words;
use crate::report::parameters::parameter_table;
use crate::report::{ComparedJoint, Finding, ImprovedJoint};
use crate::wording::{rounded, times_noise, unit_suffix};

/// Rows of the joint that is recorded.
struct Steps<'c> {
    chunks: &'c mut Chunks,
    /// The timeline of revisions alone.
    numbers: Index,
    index: Index,
    /// Whether the index begins with a tick that shows the last revision.
    opens_on_last: bool,
}

/// Adds everything on the revisions of `improved` below `root`/revision.
pub(in crate::recording) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    improved: &ImprovedJoint<'_>,
) -> Result<(), RecordError> {
    let Some(start) = layout.start() else { return Ok(()) };
    let numbers: Vec<i64> = improved.numbered().map(|(number, _)| i64::from(number)).collect();
    let opening = layout.first.revision.filter(|tick| numbers.iter().all(|number| number > tick));
    let ticks: Vec<i64> = opening.into_iter().chain(numbers.iter().copied()).collect();
    // All of them at one moment, before the first tick, where a viewer may open: on the other timelines
    // the last one is seen.
    let moment = Moment { decision: 0, ..start };
    let index = std::iter::repeat_n(moment, ticks.len()).collect::<Index>();
    let index = index.with("revision", ticks);
    let index = index.all_at("doubt", layout.segments().next().map(|_| 1));
    let numbers = Index::on("revision", numbers);
    let opens_on_last = opening.is_some();
    let mut steps = Steps { chunks, numbers, index, opens_on_last };
    steps.figures(improved)?;
    steps.words(layout, improved)?;
    let models: Vec<ComparedJoint<'_>> = improved.compared().collect();
    add_record(&mut steps.layers(paths::REVISION_RECORD), layout, &models)?;
    let ladders = Ladders::new(improved);
    let rows = models.iter().enumerate().map(|(at, compared)| {
        let what_misses = what_misses(compared, Role::of_revision(at));
        let placed = what_misses.map(|panel| Placed::new(panel, ladders.between(), 44.0..=420.0));
        ladders.placed(at).into_iter().chain(placed).collect()
    });
    panels::add(&mut steps.layers(paths::REVISION_SHEET), rows)?;
    steps.shares(&models)
}

impl Steps<'_> {
    fn layers(&mut self, path: &str) -> Layers<'_> {
        let layers = Layers::rows(self.chunks, path, self.index.clone());
        if self.opens_on_last { layers.opening_on_last() } else { layers }
    }

    /// Errors and what was added, for programs.
    fn figures(&mut self, improved: &ImprovedJoint<'_>) -> Result<(), RecordError> {
        type Effect = fn(&Revision) -> Option<&'static str>;
        type Figure = fn(&Comparison) -> Option<f64>;
        let figures: [(&str, Figure); 3] = [
            ("validation_rmse", |c| c.validation.map(|error| error.rmse)),
            ("training_rmse", |c| c.training.map(|error| error.rmse)),
            ("noise_floor", |c| c.sensor_noise),
        ];
        for (path, figure) in figures {
            let all = improved.revisions.iter().map(|revision| figure(&revision.comparison));
            let entity = format!("revision/{path}");
            self.chunks.scalars(entity, self.numbers.clone(), &all.collect::<Vec<_>>())?;
        }
        let changes: [(&str, Effect); 2] = [("added", added), ("removed", removed)];
        for (path, effect) in changes {
            let effects: Vec<_> = improved.revisions.iter().map(effect).collect();
            let lengths = effects.iter().map(|effect| usize::from(effect.is_some()));
            let texts =
                TextDocument::update_fields().with_many_text(effects.iter().flatten().copied());
            let entity = format!("revision/{path}");
            self.chunks.push(entity, self.numbers.clone(), texts.columns(lengths)?)?;
        }
        Ok(())
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
            [(paths::REVISION_WORDS, page), (paths::REVISION_PARAMETERS, parameters)];
        for (path, page) in pages {
            let texts = shown.iter().map(|at| page(layout, improved, *at));
            self.chunks.pages(path, self.index.clone(), texts)?;
        }
        Ok(())
    }

    /// Where the error of each revision is.
    fn shares(&mut self, models: &[ComparedJoint<'_>]) -> Result<(), RecordError> {
        let of_each = models.iter().enumerate().map(|(place, compared)| {
            let model = (Role::of_revision(place), compared.comparison);
            residual::placed_shares(compared.joint, &[model])
        });
        panels::add(&mut self.layers(paths::REVISION_SHARE), of_each)
    }
}

/// The measured curve that the model is farthest from; where it leaves none, its residual against what
/// it follows most.
fn what_misses(compared: &ComparedJoint<'_>, model: Role) -> Option<Panel> {
    let curves = Curves::all(&compared.comparison.curves).filter(|one| one.departure() > 0.0);
    match curves.max_by(|a, b| a.departure().total_cmp(&b.departure())) {
        Some(curves) => Some(curves.panel(compared.joint, model)),
        None => residual::clearest(compared, model),
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

/// The page of the revision at `place`: what is concluded of the last; then what changed at this one,
/// how large its error is and where it arises.
fn page(layout: &JointLayout<'_>, improved: &ImprovedJoint<'_>, place: usize) -> String {
    let Some((revision, step)) = improved.numbered().nth(place) else { return String::new() };
    let last = improved.finding.compared.revision;
    let conclusion = improved.conclusion();
    let line = |question: &str, answer: &str| format!("**{question}:** {}\n", prose(answer));
    let mut lines = vec![
        format!("**{}**\n", prose(&conclusion.headline)),
        format!("## Revision {revision} of {last}: {}\n", plain(&change_in_words(step))),
        format!("**{}**\n", plain(&fall(improved, place))),
    ];
    if let Some(next) = improved.revisions.get(place + 1) {
        let compared = improved.compared().nth(place).unwrap_or(improved.finding.compared);
        let fails = Finding { compared, ..improved.finding }.fails();
        lines.extend(fails.iter().map(|one| line(one.topic.0, &one.text())));
        lines.push(line("Next", &change_in_words(next)));
    } else {
        lines.extend(conclusion.passages.iter().map(|one| line(one.topic.0, &one.text())));
        lines.extend(conclusion.commands.iter().map(|command| format!("    {command}\n")));
    }
    let several = if improved.revisions.len() > 1 { SEVERAL } else { "" };
    let decision = if layout.segments().next().is_some() { "`decision`, " } else { "" };
    lines.push(format!("*{several}The pages after this one follow {decision}{HOW}*"));
    lines.join("\n") + "\n"
}

/// The parameters of the revision at `place`: on a page of their own, since below the words they
/// are off a small window.
fn parameters(_layout: &JointLayout<'_>, improved: &ImprovedJoint<'_>, place: usize) -> String {
    let Some((revision, step)) = improved.numbered().nth(place) else { return String::new() };
    let joint = improved.finding.compared.joint;
    let fit = match step.comparison.termination {
        Termination::Converged | Termination::NothingToFit => String::new(),
        stopped => format!("; its fit {stopped}"),
    };
    format!(
        "**Revision {revision}**{fit}\n\n{}",
        parameter_table(joint, &step.comparison.fit).markdown(plain)
    )
}

const SEVERAL: &str = "This opens on the last revision; the right arrow begins with the first one, on \
the timeline `revision`. ";

const HOW: &str = "`sample` or `time`: choose it at the bottom.";

/// What the error is, and what it was before.
fn fall(improved: &ImprovedJoint<'_>, place: usize) -> String {
    let unit = unit_suffix(improved.finding.compared.joint.output_unit.as_deref());
    let error = |place: usize| Some(judged(&improved.revisions.get(place)?.comparison));
    let Some(now) = error(place) else { return String::new() };
    let times = noise(improved).map(|noise| format!(", {}", times_noise(now / noise)));
    let times = times.unwrap_or_default();
    match place.checked_sub(1).and_then(error) {
        Some(before) => {
            format!("Error: {} → {}{unit}{times}", rounded(before), rounded(now))
        }
        None => format!("Error: {}{unit}{times}", rounded(now)),
    }
}
