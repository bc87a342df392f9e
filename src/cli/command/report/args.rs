//! The arguments of `tauscope report`, and its files: page, recording, review page.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args as ClapArgs;

use crate::cli::args::number::whole;
use crate::cli::args::{
    AgainstArgs, AlgorithmArgs, DataArgs, EffectArgs, ProtocolArgs, ReviewArgs, RunArgs,
};
use crate::cli::output::{OutputKind, Outputs};
use crate::cli::viewer::StreamArgs;
use crate::explain::MAX_EFFECTS;

/// Write a report: one page with figures and numbers to attach to an experiment
///
/// Per joint: the record, single decisions, delays, the table of decisions; with a model
/// also what it simulates, where it fails, and what it lacks. The page needs no network.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(super) data: DataArgs,

    #[command(flatten)]
    pub(super) algorithm: AlgorithmArgs,

    #[command(flatten)]
    pub(super) review: ReviewArgs,

    #[command(flatten)]
    pub(super) against: AgainstArgs,

    #[command(flatten)]
    pub(super) model: ModelArgs,

    #[command(flatten)]
    pub(super) output: OutputArgs,
}

/// Which model is reported.
#[derive(ClapArgs, Debug)]
pub(super) struct ModelArgs {
    /// Report this model, too (TOML, schema `tauscope/model/1`). One that `improve` made from
    /// these logs is shown as it is, with the errors of its history; any other is fitted,
    /// starting at its values. Joints that are not in it start as plain integrators
    #[arg(short, long, value_name = "MODEL.toml")]
    pub(super) model: Option<PathBuf>,

    /// Add to the model what it lacks, and report the error of each revision. Without a model
    /// each joint starts as a plain integrator; no model file is written
    #[arg(long)]
    pub(super) improve: bool,

    #[command(flatten)]
    pub(super) effects: EffectArgs,

    /// How many effects `--improve` adds at most
    #[arg(long, value_name = "N", default_value_t = MAX_EFFECTS, value_parser = whole::<usize>)]
    pub(super) max_effects: usize,

    #[command(flatten)]
    pub(super) protocol: ProtocolArgs,
}

/// What is written where.
#[derive(ClapArgs, Debug)]
pub(super) struct OutputArgs {
    /// The report. The recording goes beside it as `FILE.rrd`
    #[arg(short = 'o', long = "output", value_name = "FILE.html", required = true)]
    pub(super) report: Option<PathBuf>,

    /// Write no recording
    #[arg(long)]
    pub(super) no_recording: bool,

    /// Write a page beside the report, `FILE_review.html`, on which a person goes through the
    /// decisions, the most doubtful first, and saves a review
    #[arg(long)]
    pub(super) interactive: bool,

    /// The title of the report, instead of the log's name
    #[arg(long, value_name = "TEXT")]
    pub(super) title: Option<String>,

    #[command(flatten)]
    pub(super) stream: StreamArgs,

    #[command(flatten)]
    pub(super) run: RunArgs,
}

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
