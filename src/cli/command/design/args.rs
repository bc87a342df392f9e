//! The arguments of `tauscope design`.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use super::values::{self, BandChoice, Levels};
use crate::cli::args::number::at_least_one;
use crate::cli::args::{ReadingArgs, RunArgs};
use crate::experiment::format_names;

/// Design the next experiment: an input to play
///
/// Random steps, as Albrecht and Taylor advise: a finite set of levels, repeated, held for
/// random times, from each level to each other about as often. With a model the joint stays in
/// the range that it may have. `--separate A,B` makes the shortest input that separates two
/// effects, and says how surely.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[arg(help = data_help(), value_name = "DATA")]
    pub(super) data: Vec<PathBuf>,

    #[command(flatten)]
    pub(super) reading: ReadingArgs,

    /// The model file (TOML, schema `tauscope/model/1`)
    #[arg(short, long, value_name = "MODEL.toml")]
    pub(super) model: Option<PathBuf>,

    /// How far the numbers of a model may be off that no log confirms, in parts
    #[arg(
        long, value_name = "SHARE", value_parser = values::share, default_value_t = 0.1,
        allow_negative_numbers = true
    )]
    pub(super) uncertainty: f64,

    /// The levels: a list, or a range with its step, as in -2,-1,0,1,2 or -2..2:0.5
    #[arg(
        long, value_name = "LIST", value_parser = values::levels, allow_hyphen_values = true
    )]
    pub(super) levels: Option<Levels>,

    /// Largest magnitude of the input, or of its difference to where the joint rests, where levels
    /// are not given [default: that of the logs, else what suits the model, else 2]
    #[arg(
        long, value_name = "X", value_parser = values::above_zero, allow_negative_numbers = true
    )]
    pub(super) largest: Option<f64>,

    /// Shortest and longest hold in seconds [default: longer than the model takes to respond,
    /// else 1,2.5]
    #[arg(
        long, value_name = "MIN,MAX", value_parser = values::ascending,
        allow_hyphen_values = true
    )]
    pub(super) hold: Option<(f64, f64)>,

    /// Length in seconds; with `--separate` the longest that is tried [default: 120, or less where
    /// the range cannot be kept as long; with `--separate` 60]
    #[arg(
        long, value_name = "SECONDS", value_parser = values::above_zero,
        allow_negative_numbers = true
    )]
    pub(super) duration: Option<f64>,

    /// Most trials, before each of which the joint is brought back to its start: 1 for an input
    /// without a break [default: as many as the range needs]
    #[arg(
        long, value_name = "N", value_parser = at_least_one, conflicts_with = "separate",
        allow_negative_numbers = true
    )]
    pub(super) trials: Option<usize>,

    /// Samples per second [default: as the logs, but no more than 100 without `--separate`]
    #[arg(
        long, value_name = "HZ", value_parser = values::above_zero,
        allow_negative_numbers = true
    )]
    pub(super) rate: Option<f64>,

    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) seed: u64,

    /// Lowest and highest output that the joint may come to; needs a model or a log. It is kept, by
    /// as much as predictions of the joint were off on parts of the log, or refused [default with
    /// `--separate` and a log: where the log has been]
    #[arg(
        long, value_name = "LO,HI", value_parser = values::ascending,
        allow_hyphen_values = true
    )]
    pub(super) output_range: Option<(f64, f64)>,

    /// The output at which it starts [default: the middle of the range; without one, of the log, or 0]
    #[arg(
        long, value_name = "X", value_parser = values::number, allow_negative_numbers = true
    )]
    pub(super) start: Option<f64>,

    /// `cross`: a level lies in the model's dead band; `avoid`: none does; or the ends of a
    /// band in which none is to lie
    #[arg(
        long, value_name = "cross|avoid|LO,HI", value_parser = values::band,
        allow_hyphen_values = true
    )]
    pub(super) dead_band: Option<BandChoice>,

    /// Two effects to separate. The model has one of them, or a log is given
    #[arg(
        long, value_name = "EFFECT,EFFECT", value_delimiter = ',',
        conflicts_with_all = ["levels", "dead_band"]
    )]
    pub(super) separate: Vec<String>,

    /// The probability of success that is wanted
    #[arg(
        long, value_name = "SHARE", value_parser = values::power, default_value_t = 0.95,
        allow_negative_numbers = true
    )]
    pub(super) power: f64,

    /// Standard deviation of the measurement noise [default: that of the log, else the error
    /// in the model file's history]
    #[arg(
        long, value_name = "X", value_parser = values::above_zero, allow_negative_numbers = true
    )]
    pub(super) noise: Option<f64>,

    /// How often the experiment is rehearsed with either effect, in simulation
    #[arg(
        long, value_name = "N", value_parser = values::rehearsals, default_value_t = 40
    )]
    pub(super) rehearsals: usize,

    /// Where the input goes: `time_s`, and `<joint>.input` of each joint
    #[arg(short, long, value_name = "INPUT.csv")]
    pub(super) output: Option<PathBuf>,

    /// Where the input goes with what is expected of it: a table (.csv), or a recording for the
    /// Rerun viewer (.rrd)
    #[arg(long, value_name = "FILE.csv|FILE.rrd")]
    pub(super) preview: Option<PathBuf>,

    #[command(flatten)]
    pub(super) run: RunArgs,
}

fn data_help() -> String {
    format!(
        "Logs of earlier experiments ({}), or folders of logs: what they show of the joints is used",
        format_names()
    )
}
