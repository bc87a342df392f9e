//! The content of the recording that stands before many.

use std::fmt::Write as _;

use rerun::log::LogMsg;
use rerun::{ApplicationId, EntityPath, TextDocument};

use super::doubtful;
use super::recorded::IndexRecording;
use super::views;
use crate::recording::about;
use crate::recording::chunk::Chunks;
use crate::recording::content::{Content, Growth, Tab, hashed, name_of};
use crate::recording::error::RecordError;
use crate::recording::layout::{JointLayout, TrialStarts};
use crate::recording::markdown::{link, plain};
use crate::recording::paths::{drawing, index};
use crate::report::{JointSummary, SUMMARY_HEADER, summary_cells};

impl IndexRecording<'_> {
    fn layouts(&self) -> Vec<JointLayout<'_>> {
        let starts = TrialStarts::of(self.all.joints.iter().map(|joint| joint.joint));
        let layout = |joint: &_| JointLayout::of(*joint, &starts, (self.all.detail, None), 0);
        self.all.joints.iter().map(layout).collect()
    }
}

impl Content for IndexRecording<'_> {
    fn name(&self) -> String {
        let (log, command) = (name_of(self.all.sources), self.all.command);
        format!("{log} · {command} · {} joints", self.all.joints.len())
    }

    fn id(&self) -> String {
        hashed(self.all.sources, self.all.joints.iter().map(|joint| joint.joint), |part| {
            part(&format!("index {} {:?}", self.all.command, self.all.settings));
            part(&format!("{:?}", self.volumes));
        })
    }

    fn add_about(&self, chunks: &mut Chunks) -> Result<(), RecordError> {
        let layouts = self.layouts();
        about::add(chunks, self.all, &layouts)?;
        let page = page(self, &layouts).unwrap_or_default();
        chunks.push_static(EntityPath::from(index::JOINTS), &TextDocument::from_markdown(page))?;
        doubtful::add(chunks, self, &layouts)
    }

    fn tabs(&self, _: Growth) -> Vec<Tab<'_>> {
        Vec::new()
    }

    fn views(
        &self,
        _: Growth,
        application: &ApplicationId,
        id: &str,
    ) -> Result<Vec<LogMsg>, RecordError> {
        let fine = self.layouts().iter().any(JointLayout::is_fine);
        views::messages(fine.then_some(drawing::INTERVAL), application, id)
    }

    fn views_in_words(&self, _: Growth) -> String {
        index::ROOT.to_owned()
    }
}

/// All joints with their files.
fn page(
    recording: &IndexRecording<'_>,
    layouts: &[JointLayout<'_>],
) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    let joints = recording.all.joints;
    let (count, files) = (joints.len(), recording.volumes.len());
    writeln!(page, "**{count} joints in {files} files.** {HOW}\n")?;
    let header = SUMMARY_HEADER.get(1..).unwrap_or_default().join(" | ");
    writeln!(page, "| joint | file | highest doubt | {header} |")?;
    writeln!(page, "|---|---|---|{}", "---|".repeat(SUMMARY_HEADER.len() - 1))?;
    for (number, (joint, layout)) in joints.iter().zip(layouts).enumerate() {
        let summary = summary_cells(&plain(&joint.joint.name), &JointSummary::of(*joint));
        let [name, cells @ ..] = summary;
        let doubts = layout.segments().map(|(_, segment)| segment.doubt.value());
        let doubt = doubts.max_by(f64::total_cmp);
        let doubt = doubt.map_or_else(|| "-".to_owned(), |doubt| format!("{:.0} %", 100.0 * doubt));
        let file = link(recording.file_of(number));
        writeln!(page, "| {name} | {file} | {doubt} | {} |", cells.join(" | "))?;
    }
    Ok(page)
}

const HOW: &str = "A click on one opens it, in a viewer that was started in their folder.";
