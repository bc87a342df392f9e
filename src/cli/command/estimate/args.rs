//! The arguments of `tauscope estimate`.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use crate::cli::args::{AgainstArgs, AlgorithmArgs, DataArgs, ResultArgs, ReviewArgs, number};
use crate::cli::each_log::FolderArgs;
use crate::cli::output::Detail;
use crate::delay::{Method, Settings};

/// Estimate the delay of every input step of every joint
///
/// By default (`--method auto`) a response common to all steps of a joint is fitted: its onset
/// after each step gives the delay, with a confidence interval. `--method two-line` is Algorithm 1
/// of Albrecht and Taylor: the pair of regression lines that fits the output around the step best.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(super) data: DataArgs,
    #[command(flatten)]
    pub(crate) algorithm: AlgorithmArgs,
    #[command(flatten)]
    pub(crate) review: ReviewArgs,
    #[command(flatten)]
    pub(crate) against: AgainstArgs,
    #[command(flatten)]
    pub(crate) follow: FollowArgs,
    #[command(flatten)]
    pub(crate) output: OutputArgs,
    #[command(flatten)]
    pub(crate) folder: FolderArgs,
}

impl Args {
    /// The settings of each method that was asked for. A log that grows is decided by Algorithm 1, step by
    /// step.
    pub(super) fn runs(&self) -> Vec<Settings> {
        if self.follow.is_on {
            self.algorithm.runs_by(Method::TWO_LINE)
        } else {
            self.algorithm.runs()
        }
    }

    /// The files that are read.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        let further = self.review.review.iter().chain(&self.against.against);
        self.data.files().into_iter().chain(further.cloned()).collect()
    }
}

/// A log that still grows.
#[derive(ClapArgs, Debug)]
pub(crate) struct FollowArgs {
    /// Follow a log that is still written: each decision is reported as soon as its step is
    /// complete. Ctrl-C ends it; then all is done as for any log
    #[arg(long = "follow")]
    pub(crate) is_on: bool,

    /// Also end when the log has not grown for this long
    #[arg(long, value_name = "SECONDS", value_parser = number::threshold, requires = "is_on")]
    pub(crate) idle: Option<f64>,
}

/// What is written where.
#[derive(ClapArgs, Debug)]
pub(crate) struct OutputArgs {
    #[command(flatten)]
    pub(crate) to: ResultArgs,

    /// Candidates in the recording: all, or fewer of accepted segments that are not doubtful
    #[arg(long, value_enum, default_value_t = Detail::Auto)]
    pub(crate) detail: Detail,

    /// Write the table of decisions, as CSV or Parquet by the name's ending
    #[arg(long, value_name = "FILE.csv|FILE.parquet")]
    pub(crate) decisions: Option<PathBuf>,

    /// Write a review sheet: a table for `--review` to fill in, the most doubtful decision first
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) review_sheet: Option<PathBuf>,

    /// Write the delay of every sample, as CSV or Parquet
    #[arg(long, value_name = "FILE.csv|FILE.parquet")]
    pub(crate) delays: Option<PathBuf>,

    /// Write and show the delay table: the delays by kind of step (start, stop, change,
    /// reversal) and level, as CSV or Parquet
    #[arg(long, value_name = "FILE.csv|FILE.parquet")]
    pub(crate) table: Option<PathBuf>,

    /// Write the delay table as source code that a controller looks delays up in: C99, MATLAB
    /// or Octave, or Python, by the name's ending
    #[arg(long, value_name = "FILE.c|.m|.py")]
    pub(crate) export: Option<PathBuf>,

    /// Show every step: its delay with the interval, and how near the verdict was
    #[arg(long)]
    pub(crate) steps: bool,

    /// Show what the delays depend on: speed, step size, direction, dwell, angle, time and
    /// further signals
    #[arg(long)]
    pub(crate) against_state: bool,
}
