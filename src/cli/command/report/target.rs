//! The files of a report: page, recording, review page.

use std::path::{Path, PathBuf};

use anyhow::bail;

use super::args::OutputArgs;
use crate::cli::output::{OutputKind, Outputs};

/// Where the report and its recording go.
pub(super) struct Target {
    pub(super) path: PathBuf,
    pub(super) recording: Option<PathBuf>,
    /// The page to review the decisions on.
    pub(super) review: Option<PathBuf>,
    /// The model that was found.
    pub(super) model: Option<PathBuf>,
}

impl Target {
    /// The files that were asked for; none where the report has no name.
    pub(super) fn of(args: &OutputArgs) -> anyhow::Result<Option<Self>> {
        let Some(path) = args.report.clone() else { return Ok(None) };
        if path.extension().is_none_or(|ending| ending != "html" && ending != "htm") {
            bail!("{}: a report is called FILE.html", path.display());
        }
        let has_recording = cfg!(feature = "rrd") && !args.no_recording;
        let recording = has_recording.then(|| path.with_extension("rrd"));
        let review = args.interactive.then(|| beside(&path, "_review.html"));
        Ok(Some(Self { path, recording, review, model: None }))
    }

    /// With the model beside the page.
    pub(super) fn with_model(self) -> Self {
        Self { model: Some(self.path.with_extension("toml")), ..self }
    }

    /// Refuses what cannot be written.
    pub(super) fn check(&self, inputs: &[PathBuf]) -> anyhow::Result<()> {
        let pages = [Some(&self.path), self.review.as_ref()].into_iter().flatten();
        Outputs::default()
            .with(OutputKind::Other, pages)
            .with(OutputKind::Recording, &self.recording)
            .check(inputs)
    }
}

/// The name of `path` with another ending.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}{ending}"))
}

pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
