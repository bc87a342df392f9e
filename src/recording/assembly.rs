//! A recording of decisions and models, joint by joint.

use std::iter::once;

use super::blueprint::Blueprint;
use super::chunk::{Chunks, Index, Moment, Opening};
use super::content::{Content, Tab, hashed};
use super::difference::{Other, weight};
use super::error::RecordError;
use super::layout::{JointLayout, TrialStarts};
use super::{
    about, decisions, delay_state, difference, headline, model, overview, paths, revision,
    segment_view, verdict, views,
};
use crate::report::recorded::names_of;
use crate::report::settings::settings_in_short;
use crate::report::{ImprovedJoint, Recording};
use crate::units::signed;

impl<'a> Recording<'a> {
    /// Each joint and where it lies on the timelines.
    fn layouts(&self) -> impl Iterator<Item = JointLayout<'a>> {
        let starts = TrialStarts::of(self.joints.iter().map(|joint| joint.joint));
        let numbers = || self.revisions.iter().flat_map(ImprovedJoint::numbered);
        let numbers = || numbers().map(|(number, _)| i64::from(number));
        // Of several a tick before the first one shows the last: it is opened on, and the right
        // arrow begins with the first.
        let before = |first, last| if last > first { first - 1 } else { first };
        let revisions = numbers().min().zip(numbers().max());
        let revisions = revisions.map(|(first, last)| (before(first, last), last));
        let decisions = self.joints.iter().flat_map(|joint| joint.estimate.estimated());
        let decisions = decisions.flat_map(|trial| &trial.decisions);
        let most = decisions.map(|decision| signed(decision.candidates.len())).max().unwrap_or(0);
        // With a tick for the segment alone, and one for its verdict.
        let first_tick = -1 - most;
        let layout =
            move |joint| JointLayout::of(joint, &starts, (self.detail, revisions), first_tick);
        self.joints.iter().copied().map(layout)
    }
}

impl<'a> Content for Recording<'a> {
    fn name(&self) -> String {
        let others = self.also.iter().map(|other| other.name.clone());
        let settings: Vec<_> = once(settings_in_short(self.settings)).chain(others).collect();
        let (log, command) = (names_of(self.sources), self.command);
        format!("{log} · {command} · {}", settings.join(" | "))
    }

    fn id(&self) -> String {
        recording_id(self)
    }

    fn about(&self) -> String {
        let layouts: Vec<_> = self.layouts().collect();
        about::page(self, &layouts)
    }

    fn tabs(&self) -> Vec<Tab<'_>> {
        let tab = |mut layout: JointLayout<'a>| {
            let (joint, others) = (layout.joint, self.others(layout.estimated));
            if !others.is_empty() {
                layout.rank_by_difference(|label, p| weight(&others, label, p));
            }
            let add = move |chunks: &mut Chunks| add_joint(chunks, self, &layout, &others);
            Tab { joint: &joint.name, add: Box::new(add) }
        };
        self.layouts().map(tab).collect()
    }

    fn blueprint(&self) -> Blueprint {
        views::blueprint(self)
    }

    fn views_in_words(&self) -> String {
        views::in_words(self)
    }
}

fn add_joint(
    chunks: &mut Chunks,
    recording: &Recording<'_>,
    layout: &JointLayout<'_>,
    others: &[Other<'_>],
) -> Result<(), RecordError> {
    let joint = layout.joint;
    headline::add_place(chunks, layout)?;
    headline::add(chunks, layout, recording.sources, recording.revisions_of(joint))?;
    overview::add_signals(chunks, layout)?;
    decisions::add(chunks, layout)?;
    verdict::add(chunks, layout, others)?;
    segment_view::add(chunks, layout, (recording.settings.method, others))?;
    overview::add(chunks, layout)?;
    delay_state::add(chunks, layout)?;
    difference::add(chunks, layout, others)?;
    let models = recording.models.iter().filter(|model| model.joint.name == joint.name);
    let models: Vec<_> = models.collect();
    let first_sample = first_sample(layout).filter(|_| !models.is_empty());
    open_on_the_first(chunks, layout, first_sample)?;
    let revisions = recording.revisions_of(joint);
    // Of several revisions the last one is what there is to judge.
    let judged = if revisions.is_some() { models.last() } else { models.first() };
    if let Some(judged) = judged {
        model::add(chunks, layout, &models, judged)?;
    }
    match (revisions, judged) {
        (Some(improved), _) => revision::add(chunks, layout, improved),
        (None, Some(judged)) => model::add_map(chunks, layout, judged),
        (None, None) => Ok(()),
    }
}

/// The first sample of all, where no step begins at it.
fn first_sample(layout: &JointLayout<'_>) -> Option<Moment> {
    let first = layout.start()?;
    let mut steps = layout.segments().map(|(trial, segment)| trial.opening(segment).sample);
    steps.all(|step| step > first.sample).then_some(first)
}

/// Shows the most different or most doubtful decision where the viewer opens: on the timeline of
/// decisions before the first step, with its candidates after it; on that of revisions; and at the
/// `first_sample` where it opens on `time`.
fn open_on_the_first(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    first_sample: Option<Moment>,
) -> Result<(), RecordError> {
    let Some(segment) = layout.shown_first() else { return Ok(()) };
    let shown = [
        (paths::DRAWING, ""),
        ("map/here", ""),
        ("map_of_record/here", ""),
        ("against/here", ""),
        ("against/step", ""),
        (paths::VERDICT, "TextDocument"),
    ];
    // On the timeline of differences the first tick is this decision's own.
    let index = Index::before_all(Opening { is_compared: false, ..layout.first });
    let index = match first_sample {
        Some(Moment { sample, time_ns, .. }) => {
            index.all_at("sample", Some(sample)).all_at("time", Some(time_ns))
        }
        None => index,
    };
    for (path, component) in shown {
        chunks.repeat((path, component), segment.opening, &index)?;
    }
    let candidates = segment.opening + 1..=segment.verdict();
    chunks.replay("drawing/candidate", candidates, layout.first.tick + 1)
}

/// Equal for equal logs, read in the same way, equal settings and version, so that two
/// recordings of one experiment lie side by side when any of it differs.
fn recording_id(recording: &Recording<'_>) -> String {
    hashed(recording.sources, recording.joints.iter().map(|joint| joint.joint), |part| {
        part(recording.command);
        for model in recording.models {
            let values: Vec<_> = model.comparison.fit.model.values();
            part(&format!("{} {:?} {values:?}", model.model, model.comparison.fit.model.names()));
            part(&model.comparison.fit.evaluation.horizon.to_string());
        }
        for improved in recording.revisions {
            let changes: Vec<_> =
                improved.revisions.iter().map(|revision| revision.change).collect();
            part(&format!("{} {changes:?}", improved.first_revision));
        }
        part(&format!("{:?} {:?}", recording.settings, recording.detail));
        for beside in recording.also {
            part(&format!("{beside:?}"));
        }
    })
}
