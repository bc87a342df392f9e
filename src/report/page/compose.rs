//! The report as a document: its parts in their order.

use serde_json::{Value, json};

use super::document::{Block, Document, Entry, Report, slug};
use super::{delays, joint};
use crate::experiment::{Joint, Source, Trial};
use crate::report::difference::differences_json;
use crate::report::improve::conclusion_json;
use crate::report::json::{document, without_empty};
use crate::report::settings::settings_table;
use crate::report::{EstimatedJoint, ImprovedJoint, TextTable};
use crate::wording::counted;

impl Report<'_> {
    /// Puts the report together.
    pub(crate) fn document(&self) -> Document {
        let mut blocks = vec![Block::text(self.extent()), Block::Contents(self.contents())];
        // Of models the delays are what they are made from.
        let overview = delays::overview(self.joints).filter(|_| self.models.is_empty());
        blocks.extend(overview.map(|figure| Block::Figures(vec![figure])));
        if !self.failures.is_empty() {
            blocks.push(Block::Lead("Left out".to_owned()));
            blocks.push(Block::List(self.failures.to_vec()));
        }
        for (index, joint) in self.joints.iter().enumerate() {
            blocks.push(Block::section(&joint.joint.name, &anchor(index, joint.joint)));
            blocks.extend(joint::blocks(self, *joint));
        }
        blocks.extend(origin(self));
        Document { title: self.title(), blocks }
    }

    /// What is said of each joint in a sentence or two; also what `report` prints.
    pub(crate) fn sentences(&self) -> Vec<(&str, String)> {
        let joints = self.joints.iter();
        joints.map(|joint| (joint.joint.name.as_str(), joint::sentences(self, *joint))).collect()
    }

    fn title(&self) -> String {
        if let Some(title) = self.title {
            return title.to_owned();
        }
        let what = if self.models.is_empty() { "Delays" } else { "Models and delays" };
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

/// Where links to a joint lead.
fn anchor(index: usize, joint: &Joint) -> String {
    format!("joint-{}-{}", index + 1, slug(&joint.name))
}

/// What `report` prints: a line or two per joint, and the next command of a report on delays alone.
pub(crate) fn report_text(report: &Report<'_>) -> String {
    let lines = report.sentences().into_iter();
    let lines = lines.map(|(joint, sentence)| [joint, ": ", &sentence, "\n"].concat());
    let next =
        report.with_models.map(|command| format!("what next:\n  {command}  {WITH_MODELS}\n"));
    lines.chain(next).collect()
}

/// What a report has that was made with a model of each joint.
const WITH_MODELS: &str = "also a model of each joint, and the effects that it lacks";

pub(super) fn origin(report: &Report<'_>) -> Vec<Block> {
    let mut blocks = vec![Block::section("How this was made", "how-this-was-made")];
    blocks.push(Block::text(format!(
        "Made by tauscope {} with this command, which makes it again from the same files:",
        env!("CARGO_PKG_VERSION")
    )));
    blocks.push(Block::Code(report.command.to_owned()));
    if let Some(command) = report.with_models {
        blocks.push(Block::text(format!("This command reports {WITH_MODELS}:")));
        blocks.push(Block::Code(command.to_owned()));
    }
    blocks.push(Block::Table(files(&report.experiment.sources)));
    if !report.notes.is_empty() {
        blocks.push(Block::List(report.notes.to_vec()));
    }
    blocks.extend(report.recording.into_iter().flat_map(recording));
    blocks.push(Block::part("Settings"));
    blocks.push(Block::Table(settings_table(report.settings)));
    if let Some(text) = report.revised {
        let file = vec![Block::Code(text.to_owned())];
        blocks.push(Block::details("The models, as a model file", file));
    }
    blocks
}

/// The files that were read.
pub(crate) fn files(sources: &[Source]) -> TextTable {
    let row = |source: &Source| {
        let path = source.path.display().to_string();
        [path, source.bytes.to_string(), source.sha256.clone()]
    };
    TextTable::of(["file", "bytes", "SHA-256"], &[1], sources.iter().map(row))
}

/// How to look at the recording of this name.
fn recording(name: &str) -> [Block; 3] {
    [
        Block::part("Recording"),
        Block::text(format!(
            "{name} is beside this report: every decision, to be stepped through in the Rerun viewer \
             (package rerun-sdk of PyPI), with:"
        )),
        Block::Code(format!("rerun {name}")),
    ]
}

/// The document of `report --format json`: what was written where, and what is said of each joint; its
/// conclusion, where a model is asked for.
pub(crate) fn report_json(
    report: &Report<'_>,
    path: Option<&str>,
    recording: Option<&str>,
) -> Value {
    let joint = |(joint, sentence): (&str, String)| {
        let model = report.models.iter().find(|improved| improved.name() == joint);
        let conclusion = model.map(|ImprovedJoint { finding, .. }| {
            conclusion_json(&finding.conclusion().headline, &finding.consequence())
        });
        json!({ "joint": joint, "sentence": sentence, "conclusion": conclusion })
    };
    let facts = json!({
        "report": path,
        "recording": recording,
        "joints": report.sentences().into_iter().map(joint).collect::<Value>(),
        "against": differences_json(report.against),
        "failures": report.failures,
    });
    document("tauscope/report/1", without_empty(facts, &["against"]))
}
