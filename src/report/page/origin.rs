//! What a report was made from and with, so that it can be made again.

use super::document::{Attachment, Block};
use super::report::{RecordingFile, Report};
use crate::experiment::Source;
use crate::report::chosen_line;
use crate::report::settings::settings_table;
use crate::report::text_table::TextTable;

pub(super) fn blocks(report: &Report<'_>) -> Vec<Block> {
    let mut blocks = vec![Block::section("How this was made", "how-this-was-made")];
    blocks.push(Block::text(format!(
        "Made by tauscope {} with this command, which makes it again from the same files:",
        env!("CARGO_PKG_VERSION")
    )));
    blocks.push(Block::Code(report.command.to_owned()));
    blocks.push(Block::Table(files(&report.experiment.sources)));
    if !report.notes.is_empty() {
        blocks.push(Block::List(report.notes.to_vec()));
    }
    blocks.extend(report.recording.iter().flat_map(recording));
    blocks.push(Block::part("Settings"));
    blocks.push(Block::Table(settings_table(report.settings)));
    let chosen: Vec<String> = report.joints.iter().filter_map(chosen_line).collect();
    if !chosen.is_empty() {
        blocks.push(Block::text("Chosen from the record of"));
        blocks.push(Block::List(chosen));
    }
    if let Some(text) = report.revised {
        let file = vec![Block::Code(text.to_owned())];
        blocks.push(Block::details("The models, as a model file", file));
    }
    blocks
}

/// The files that were read.
pub(super) fn files(sources: &[Source]) -> TextTable {
    let row = |source: &Source| {
        let path = source.path.display().to_string();
        [path, source.bytes.to_string(), source.sha256.clone()]
    };
    TextTable::of(["file", "bytes", "SHA-256"], &[1], sources.iter().map(row))
}

/// How to look at the recording.
fn recording(recording: &RecordingFile<'_>) -> Vec<Block> {
    let RecordingFile { name, bytes } = recording;
    let location = if bytes.is_some() { "is in this page" } else { "is beside this report" };
    let mut blocks = vec![
        Block::part("Recording"),
        Block::text(format!(
            "{name} {location}: every decision, to be stepped through in the Rerun viewer \
             (package rerun-sdk of PyPI), with:"
        )),
        Block::Code(format!("rerun {name}")),
    ];
    let file = bytes.map(|bytes| Attachment { name: (*name).to_owned(), bytes: bytes.to_vec() });
    blocks.extend(file.map(Block::Attachment));
    blocks
}
