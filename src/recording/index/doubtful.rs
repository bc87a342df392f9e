//! The most doubtful decisions of all joints, drawn as on the pages of the joints.

use rerun::{EntityPath, TextDocument, TextLog};

use super::recorded::IndexRecording;
use crate::recording::chunk::{Chunks, Index};
use crate::recording::error::RecordError;
use crate::recording::layout::{JointLayout, SegmentLayout, TrialLayout};
use crate::recording::markdown::link;
use crate::recording::paths::{at, drawing, index};
use crate::recording::rows::Rows;
use crate::recording::segment_view::{self, Drawing};
use crate::recording::verdict;
use crate::report::EstimatedJoint;
use crate::wording::doubt_percent;

/// Decisions that are shown: more of them nobody looks through at a sitting.
const MOST: usize = 200;

/// A decision with its joint.
struct Doubted<'l, 'a> {
    joint: EstimatedJoint<'a>,
    file: &'l str,
    trial: &'l TrialLayout<'a>,
    segment: &'l SegmentLayout<'a>,
}

/// Adds drawings, verdicts and a list, on the timeline of doubt.
pub(super) fn add(
    chunks: &mut Chunks,
    recording: &IndexRecording<'_>,
    layouts: &[JointLayout<'_>],
) -> Result<(), RecordError> {
    let joints = recording.all.joints.iter().zip(layouts).enumerate();
    let mut all: Vec<Doubted<'_, '_>> = Vec::new();
    for (number, (joint, layout)) in joints {
        let file = recording.file_of(number);
        let of_joint = |(trial, segment)| Doubted { joint: *joint, file, trial, segment };
        all.extend(layout.segments().map(of_joint));
    }
    all.sort_by(|a, b| b.segment.doubt.value().total_cmp(&a.segment.doubt.value()));
    all.truncate(MOST);
    if all.is_empty() {
        return Ok(());
    }
    let root = EntityPath::from(index::ROOT);
    let ranks = || Index::of_doubts(all.len());
    let pages: Vec<_> = all.iter().map(Doubted::page).collect();
    let markdown = std::iter::repeat_n("text/markdown", pages.len());
    let pages = TextDocument::update_fields().with_many_text(pages).with_many_media_type(markdown);
    chunks.push(at(&root, index::VERDICT), ranks(), pages.columns_of_unit_batches()?)?;
    let lines = all.iter().map(Doubted::line);
    let log = TextLog::update_fields().with_many_text(lines);
    let log = log.with_many_level(std::iter::repeat_n("INFO", all.len()));
    chunks.push(at(&root, index::LOG), ranks(), log.columns_of_unit_batches()?)?;
    let drawings: Vec<_> = all
        .iter()
        .map(|found| Drawing::new(found.joint.joint, found.trial, found.segment))
        .collect();
    let mut sheet = Rows::new(chunks, at(&root, drawing::ROOT), ranks());
    segment_view::add_drawings(&mut sheet, &drawings)
}

impl Doubted<'_, '_> {
    /// The verdict as it is beside the drawing in the joint's file.
    fn page(&self) -> String {
        let place = format!("**{}** · segment {}", link(self.file), self.segment.number);
        let page = verdict::page(self.joint, self.trial, self.segment);
        format!("{place}\n\n{page}")
    }

    fn line(&self) -> String {
        let step = verdict::in_short(self.joint.joint, self.trial, self.segment);
        let (doubt, reason) = (doubt_percent(&self.segment.doubt), self.trial.reason(self.segment));
        format!("{doubt:>5}  {} ({}), {step}: {reason}", self.joint.joint.name, self.file)
    }
}
