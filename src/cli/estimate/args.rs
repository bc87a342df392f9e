//! The arguments of `tauscope estimate`.

use std::path::PathBuf;

use clap::{Args as ClapArgs, ValueEnum};
use tauscope::delay::{self, Interpolation, Settings};
use tauscope::filter::LowPass;

use crate::cli::data::{DataArgs, threads};
use crate::cli::progress::Verbosity;
use crate::cli::record::Detail;

/// Estimate the delay of every input step of every joint
///
/// Each step of the input is decided by the pair of regression lines that fits the
/// output around it best (Albrecht and Taylor's Algorithm 1).
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    pub(super) data: DataArgs,
    #[command(flatten)]
    pub(super) algorithm: AlgorithmArgs,
    #[command(flatten)]
    pub(super) output: OutputArgs,
}

/// The settings of the algorithm.
#[derive(ClapArgs, Debug)]
#[command(next_help_heading = "Algorithm")]
pub(crate) struct AlgorithmArgs {
    /// How a breakpoint is found. May be repeated: the first one is the answer, the others
    /// are told beside it
    #[arg(long, value_enum, default_values_t = [Method::TwoLine])]
    method: Vec<Method>,

    /// Reject a step as `nothing_happened` unless its change of slope is this unlikely to
    /// be noise, or `none` [default: 0.99; `none` for two-line]
    #[arg(long, value_name = "X|none", value_parser = confidence, allow_negative_numbers = true)]
    confidence: Option<Confidence>,

    /// How often the interval of a delay is to hold the true one
    #[arg(long, value_name = "X", default_value_t = 0.95, value_parser = probability, allow_negative_numbers = true)]
    interval: f64,

    /// Samples that a segment reaches beyond its input steps
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = at_least_one, allow_negative_numbers = true)]
    alpha: usize,

    /// Samples between two candidate breakpoints
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = at_least_one, allow_negative_numbers = true)]
    beta: usize,

    /// Zero-phase low-pass on the output: its cutoff, or `none` [default: 5 for two-line,
    /// else none]
    #[arg(long, value_name = "HZ|none", value_parser = passband, allow_negative_numbers = true)]
    passband: Option<Passband>,

    /// Order of the low-pass
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = at_least_one, allow_negative_numbers = true)]
    filter_order: usize,

    /// Reject a step that is held for fewer samples (`τ_min`)
    #[arg(long, value_name = "SAMPLES", default_value_t = 0, allow_negative_numbers = true)]
    min_delay: usize,

    /// Look for delays up to this many samples only: for holds so long that the output
    /// meets an end stop on its way
    #[arg(long, value_name = "SAMPLES", value_parser = at_least_one, allow_negative_numbers = true)]
    max_delay: Option<usize>,

    /// Reject a step when the output touches a limit
    #[arg(long, value_name = "LO,HI", value_parser = limits, allow_hyphen_values = true)]
    output_limits: Option<(f64, f64)>,

    /// Reject a step when the slope changes by less, in output units per sample
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = threshold, allow_negative_numbers = true)]
    min_slope_change: f64,

    /// Reject a step unless the squared error of its lines is below this
    #[arg(long, value_name = "X", value_parser = threshold, allow_negative_numbers = true)]
    max_sse: Option<f64>,

    /// Judge the first and the last step like the others
    #[arg(long)]
    keep_first_last: bool,

    /// Count a change of the input as a step when it is more than this: for an input
    /// that was measured
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = threshold, allow_negative_numbers = true)]
    min_step: f64,

    /// The delay between two steps
    #[arg(long, value_enum, default_value_t = Between::Hold)]
    interpolate: Between,
}

/// What is written where.
#[derive(ClapArgs, Debug)]
#[command(next_help_heading = "Output")]
pub(super) struct OutputArgs {
    /// Record every decision for the Rerun viewer
    #[arg(short = 'o', long = "output", value_name = "FILE.rrd")]
    pub(super) recording: Option<PathBuf>,

    /// Candidates in the recording: all, or fewer of accepted segments
    #[arg(long, value_enum, default_value_t = Detail::Full)]
    pub(super) detail: Detail,

    /// Write the table of decisions
    #[arg(long, value_name = "FILE.csv")]
    pub(super) decisions: Option<PathBuf>,

    /// Write the delay of every sample
    #[arg(long, value_name = "FILE.csv")]
    pub(super) delays: Option<PathBuf>,

    /// Show every step: its delay with the interval, and how near the verdict was
    #[arg(long)]
    pub(super) steps: bool,

    /// Show what the delays depend on: speed, step size, direction, dwell, angle, time and
    /// further signals
    #[arg(long)]
    pub(super) against_state: bool,

    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(super) format: Format,

    /// Threads to use [default: all processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub(super) threads: Option<usize>,

    /// No progress, no notices
    #[arg(short, long)]
    pub(super) quiet: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Method {
    /// Two regression lines (Albrecht and Taylor)
    TwoLine,
    /// A continuous broken line, with intervals
    Hinge,
    /// A broken line behind a lag: dead time apart from lag, with intervals
    LagAware,
}

impl From<Method> for delay::Method {
    fn from(method: Method) -> Self {
        match method {
            Method::TwoLine => Self::TwoLine,
            Method::Hinge => Self::Hinge,
            Method::LagAware => Self::LagAware,
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Confidence {
    Of(f64),
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Between {
    /// Keep the delay until the next step
    Hold,
    /// Go in a line to the next accepted delay
    Linear,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Format {
    /// A table
    Text,
    /// JSON, schema `tauscope/estimate/1`
    Json,
}

#[derive(Clone, Copy, Debug)]
enum Passband {
    Hz(f64),
    None,
}

fn at_least_one(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|number: &usize| *number > 0);
    number.ok_or_else(|| "expected a whole number from 1 up".to_owned())
}

fn threshold(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0);
    number.ok_or_else(|| "expected a number from 0 up".to_owned())
}

fn passband(text: &str) -> Result<Passband, String> {
    if text == "none" {
        return Ok(Passband::None);
    }
    let hz = text.parse().ok().filter(|hz: &f64| hz.is_finite() && *hz > 0.0);
    hz.map(Passband::Hz).ok_or_else(|| "expected a frequency in Hz, or `none`".to_owned())
}

fn probability(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| *x > 0.0 && *x < 1.0);
    number.ok_or_else(|| "expected a number between 0 and 1, as in 0.99".to_owned())
}

fn confidence(text: &str) -> Result<Confidence, String> {
    if text == "none" {
        return Ok(Confidence::None);
    }
    let found = probability(text).map(Confidence::Of);
    found.map_err(|expected| format!("{expected}, or `none`"))
}

fn limits(text: &str) -> Result<(f64, f64), String> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| !x.is_nan());
    let pair = text.split_once(',').and_then(|(low, high)| Some((number(low)?, number(high)?)));
    match pair {
        Some((low, high)) if low < high => Ok((low, high)),
        Some(_) => Err("the lower limit comes first".to_owned()),
        None => Err("expected two numbers, as in -40,40".to_owned()),
    }
}

impl AlgorithmArgs {
    /// The settings of each method that was asked for, each once.
    pub(super) fn runs(&self) -> Vec<Settings> {
        let mut runs: Vec<Settings> = Vec::new();
        for method in self.method.iter().copied().map(delay::Method::from) {
            if runs.iter().all(|run| run.method != method) {
                runs.push(self.settings(method));
            }
        }
        runs
    }

    /// The settings of the only method.
    ///
    /// # Errors
    /// When several were asked for.
    pub(crate) fn only(&self) -> anyhow::Result<Settings> {
        let mut runs = self.runs();
        match (runs.pop(), runs.is_empty()) {
            (Some(settings), true) => Ok(settings),
            _ => anyhow::bail!("--method: only one method at a time can be used here"),
        }
    }

    fn settings(&self, method: delay::Method) -> Settings {
        let usual = Settings::of(method);
        let order = self.filter_order;
        let low_pass = match self.passband {
            Some(Passband::Hz(cutoff_hz)) => Some(LowPass { cutoff_hz, order }),
            Some(Passband::None) => None,
            None => usual.low_pass.map(|usual| LowPass { order, ..usual }),
        };
        let confidence = match self.confidence {
            Some(Confidence::Of(confidence)) => Some(confidence),
            Some(Confidence::None) => None,
            None => usual.confidence,
        };
        Settings {
            alpha: self.alpha,
            beta: self.beta,
            low_pass,
            min_delay: self.min_delay,
            max_delay: self.max_delay,
            output_limits: self.output_limits,
            min_slope_change: self.min_slope_change,
            max_sse: self.max_sse,
            keep_first_last: self.keep_first_last,
            min_step: self.min_step,
            method,
            confidence,
            interval: self.interval,
            interpolation: match self.interpolate {
                Between::Hold => Interpolation::Hold,
                Between::Linear => Interpolation::Linear,
            },
        }
    }
}

impl OutputArgs {
    pub(super) fn verbosity(&self) -> Verbosity {
        if self.quiet { Verbosity::Quiet } else { Verbosity::Normal }
    }
}
