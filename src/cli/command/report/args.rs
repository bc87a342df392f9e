//! The arguments of `tauscope report`.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use crate::cli::args::number::whole;
use crate::cli::args::{
    AgainstArgs, AlgorithmArgs, DataArgs, EffectArgs, ProtocolArgs, ReviewArgs, RunArgs,
};
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
