//! The files that `tauscope estimate` writes.

use std::path::{Path, PathBuf};

use anyhow::bail;

use crate::report::decisions::decision_table;
use crate::report::delays::{delay_table, level_table};
use crate::report::lookup::{Language, Lookup};
use crate::report::review::review_sheet;
use crate::report::{EstimatedJoint, Recording, write_delays};

use super::args::OutputArgs;
use crate::cli::console::Verbosity;
use crate::cli::output::{
    FileKind, OutputKind, Outputs, of_delays, write_bytes, write_file, write_parquet, write_table,
};
use crate::cli::viewer::Stream;
use crate::delay::Settings;
use crate::experiment::Experiment;
use crate::report::difference::Against;
use crate::study::{FileError, OtherResult, Review};

/// The joints that have an estimate with some settings.
pub(super) type Run<'a> = (&'a Settings, &'a [EstimatedJoint<'a>]);

/// What was read and what came out.
#[derive(Clone, Copy)]
pub(super) struct Estimated<'a> {
    pub(super) experiment: &'a Experiment,
    /// The answer: what came out by the first method.
    pub(super) joints: &'a [EstimatedJoint<'a>],
    pub(super) settings: &'a Settings,
    /// What came out by each method.
    pub(super) runs: &'a [Run<'a>],
    /// What is shown beside the answer.
    pub(super) others: &'a [OtherResult],
    /// How it differs from the answer.
    pub(super) against: &'a [Against<'a>],
}

impl OutputArgs {
    /// Refuses what cannot be written, or would replace an input or another output.
    pub(super) fn check(&self, inputs: &[PathBuf]) -> anyhow::Result<()> {
        let outputs = Outputs::default()
            .with(OutputKind::Recording, &self.to.recording)
            .with(OutputKind::Table, self.decisions.iter().chain(&self.delays).chain(&self.table))
            .with(OutputKind::Csv, &self.review_sheet)
            .with(OutputKind::Other, &self.export);
        outputs.check(inputs)?;
        if let Some(sheet) = &self.review_sheet {
            check_sheet(sheet)?;
        }
        self.export.as_deref().map(named_lookup).transpose()?;
        Ok(())
    }

    /// Why a file that was asked for is not written, where nothing would be in it.
    pub(super) fn left_out(&self, result: &Estimated<'_>) -> Vec<String> {
        let path = self.export.as_ref().filter(|_| lookup(result).is_empty());
        let why = |path: &PathBuf| {
            format!("{}: not written: no joint has an accepted delay to look up", path.display())
        };
        path.map(why).into_iter().collect()
    }

    /// Writes each file whole and gives it its name; shows the recording to who looks on.
    pub(super) fn write(
        &self,
        result: &Estimated<'_>,
        stream: &Stream,
        verbosity: Verbosity,
    ) -> anyhow::Result<()> {
        if let Some(path) = &self.decisions {
            write_table(&decision_table(result.runs), path)?;
        }
        if let Some(path) = &self.review_sheet {
            write_table(&review_sheet(result.joints), path)?;
        }
        if let Some(path) = &self.delays {
            write_file(path, |file| match FileKind::of(path) {
                FileKind::Csv => Ok(write_delays(result.joints, file)?),
                FileKind::Parquet => write_parquet(&delay_table(result.joints), file),
            })?;
        }
        if let Some(path) = &self.table {
            write_table(&level_table(result.joints), path)?;
        }
        if let Some(path) = self.export.as_ref().filter(|_| !lookup(result).is_empty()) {
            let (language, name) = named_lookup(path)?;
            let source = language.source(&lookup(result), name)?;
            write_bytes(path, source)?;
        }
        let delays = (result.joints, result.settings);
        let recording = of_delays("estimate", result.experiment, delays);
        let detail = self.detail.of(result.joints);
        let recording = Recording { also: result.others, detail, ..recording };
        if let Some(path) = &self.to.recording {
            recording.record(path, verbosity)?;
        }
        stream.send(&recording, None)
    }
}

/// The delays that a controller looks up.
fn lookup<'a>(result: &Estimated<'a>) -> Lookup<'a> {
    Lookup::new(&result.experiment.sources, result.joints, result.settings)
}

/// The language of a lookup, and what its file is called without the ending.
fn named_lookup(path: &Path) -> anyhow::Result<(Language, &str)> {
    let shown = path.display();
    let Some(language) = Language::of(path) else {
        bail!(
            "{shown}: a lookup is written as C, MATLAB or Python; give the file a name that ends in \
             .c, .m or .py"
        );
    };
    let name = path.file_stem().and_then(|name| name.to_str()).unwrap_or_default();
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let is_function = name.starts_with(|c: char| c.is_ascii_alphabetic());
    if language == Language::Matlab && !(is_function && name.chars().all(is_letter)) {
        bail!(
            "{shown}: MATLAB calls a function by the name of its file, and `{name}` is not a \
               valid name; use letters, digits and underscores, a letter first"
        );
    }
    Ok((language, name))
}

/// Refuses to replace a review sheet in which a person has written something.
fn check_sheet(sheet: &Path) -> anyhow::Result<()> {
    let is_filled_in = sheet.is_file()
        && match Review::read(sheet) {
            Ok(review) => !review.is_empty(),
            // One that was misspelt was written by a person, too; another table is no sheet.
            Err(error) => matches!(error, FileError::Wrong { place, .. } if !place.is_empty()),
        };
    if is_filled_in {
        let sheet = sheet.display();
        bail!(
            "--review-sheet {sheet}: contains reviews already, which would be lost; write another \
             file, and give `--review {sheet}` to copy them"
        );
    }
    Ok(())
}
