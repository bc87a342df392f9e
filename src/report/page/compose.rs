//! The report as a document: its parts in their order.

use super::document::{Block, Document, Entry, slug};
use super::report::Report;
use super::{delays, joint, origin};
use crate::experiment::{Joint, Trial};
use crate::report::EstimatedJoint;
use crate::wording::counted;

impl Report<'_> {
    /// Puts the report together.
    pub(crate) fn document(&self) -> Document {
        let by = [self.heading.author, self.heading.date].into_iter().flatten();
        let by = by.collect::<Vec<_>>().join(", ");
        let by = Some(by).filter(|by| !by.is_empty()).map(Block::text);
        let start = [Block::text(self.extent()), Block::Contents(self.contents())];
        let mut blocks: Vec<_> = by.into_iter().chain(start).collect();
        blocks.extend(delays::overview(self.joints).map(|figure| Block::Figures(vec![figure])));
        if !self.failures.is_empty() {
            blocks.push(Block::Lead("Left out".to_owned()));
            blocks.push(Block::List(self.failures.to_vec()));
        }
        for (index, joint) in self.joints.iter().enumerate() {
            blocks.push(Block::section(&joint.joint.name, &anchor(index, joint.joint)));
            blocks.extend(joint::blocks(self, *joint, &anchor(index, joint.joint)));
        }
        blocks.extend(origin::blocks(self));
        Document { title: self.title(), blocks }
    }

    /// What is said of each joint in a sentence or two; also what `report` prints.
    pub(crate) fn sentences(&self) -> Vec<(&str, String)> {
        let joints = self.joints.iter();
        joints.map(|joint| (joint.joint.name.as_str(), joint::sentences(self, *joint))).collect()
    }

    fn title(&self) -> String {
        if let Some(title) = self.heading.title {
            return title.to_owned();
        }
        let what = if self.models.is_empty() { "Delays" } else { "Delays and models" };
        let files = self.experiment.sources.as_slice();
        let name = |path: &std::path::Path| {
            path.file_name().unwrap_or_default().to_string_lossy().into_owned()
        };
        match files {
            [one] => format!("{what} in {}", name(&one.path)),
            _ => format!("{what} in {} files", files.len()),
        }
    }

    /// How much was measured.
    fn extent(&self) -> String {
        let (joints, files) = (self.joints.len(), self.experiment.sources.len());
        let trials = || self.joints.iter().flat_map(|joint| &joint.joint.trials);
        let samples: usize = trials().map(Trial::len).sum();
        let mut periods: Vec<String> = trials().map(|trial| trial.period().to_string()).collect();
        periods.dedup();
        periods.truncate(3);
        let (joints, files) = (counted(joints, "joint"), counted(files, "file"));
        format!("{joints} in {files}, {samples} samples, one every {}.", periods.join(" or "))
    }

    fn contents(&self) -> Vec<Entry> {
        let entry = |(index, joint): (usize, &EstimatedJoint<'_>)| Entry {
            name: joint.joint.name.clone(),
            anchor: anchor(index, joint.joint),
            text: joint::sentences(self, *joint),
        };
        self.joints.iter().enumerate().map(entry).collect()
    }
}

/// Where links to a joint lead, and what its drawings' names begin with.
fn anchor(index: usize, joint: &Joint) -> String {
    format!("joint-{}-{}", index + 1, slug(&joint.name))
}

/// What `report` prints: a line or two per joint.
pub(crate) fn report_text(report: &Report<'_>) -> String {
    let lines = report.sentences().into_iter();
    lines.map(|(joint, sentence)| [joint, ": ", &sentence, "\n"].concat()).collect()
}
