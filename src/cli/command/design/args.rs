//! The arguments of `tauscope design`.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use crate::cli::args::number::{self, at_least_one};
use crate::cli::args::{ReadingArgs, RunArgs};
use crate::experiment::format_names;
use crate::numerics::to_decimals;

/// Design the next experiment: an input to play
///
/// Random steps, as Albrecht and Taylor advise: a finite set of levels, repeated, held for
/// random times, with all transitions about equally often. With a model the output stays in the
/// allowed range. `--separate A,B` makes the shortest input that distinguishes two effects, and
/// gives the probability that it does.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[arg(help = data_help(), value_name = "DATA")]
    pub(super) data: Vec<PathBuf>,

    #[command(flatten)]
    pub(super) reading: ReadingArgs,

    /// The model file (TOML, schema `tauscope/model/1`)
    #[arg(short, long, value_name = "MODEL.toml")]
    pub(super) model: Option<PathBuf>,

    /// Relative standard deviation of the parameters of a model given without a log
    #[arg(long, value_name = "SHARE", value_parser = share, default_value_t = 0.1)]
    pub(super) uncertainty: f64,

    /// The levels: a list, or a range with its step, as in -2,-1,0,1,2 or -2..2:0.5
    #[arg(long, value_name = "LIST", value_parser = levels, allow_hyphen_values = true)]
    pub(super) levels: Option<Levels>,

    /// Largest magnitude of the input, or of its difference to where the joint rests, where levels
    /// are not given [default: that of the logs, else what suits the model, else 2]
    #[arg(long, value_name = "X", value_parser = above_zero)]
    pub(super) largest: Option<f64>,

    /// Shortest and longest hold in seconds [default: longer than the model takes to respond,
    /// else 1,2.5]
    #[arg(long, value_name = "MIN,MAX", value_parser = ascending, allow_hyphen_values = true)]
    pub(super) hold: Option<(f64, f64)>,

    /// Length in seconds; with `--separate` the longest that is tried [default: 120, or less where
    /// the range cannot be kept as long; with `--separate` 60]
    #[arg(long, value_name = "SECONDS", value_parser = above_zero)]
    pub(super) duration: Option<f64>,

    /// Largest number of trials; before each the joint is brought back to its start. 1: an
    /// uninterrupted input [default: as many as the range needs]
    #[arg(long, value_name = "N", value_parser = at_least_one, conflicts_with = "separate")]
    pub(super) trials: Option<usize>,

    /// Samples per second [default: as the logs, but no more than 100 without `--separate`]
    #[arg(long, value_name = "HZ", value_parser = above_zero)]
    pub(super) rate: Option<f64>,

    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = number::whole::<u64>)]
    pub(super) seed: u64,

    /// Lowest and highest output allowed; needs a model or a log. The design keeps this range with
    /// a margin for the error of its predictions, measured on the log, or is refused [default with
    /// `--separate` and a log: where the log has been]
    #[arg(long, value_name = "LO,HI", value_parser = ascending, allow_hyphen_values = true)]
    pub(super) output_range: Option<(f64, f64)>,

    /// The output at which it starts [default: the middle of the range; without one, of the log, or 0]
    #[arg(long, value_name = "X", value_parser = number)]
    pub(super) start: Option<f64>,

    /// Two effects to distinguish. The model has one of them, or a log is given
    #[arg(long, value_name = "EFFECT,EFFECT", value_delimiter = ',', conflicts_with = "levels")]
    pub(super) separate: Vec<String>,

    /// The probability of success that is wanted
    #[arg(long, value_name = "SHARE", value_parser = power, default_value_t = 0.95)]
    pub(super) power: f64,

    /// Standard deviation of the measurement noise [default: that of the log, else the error
    /// in the model file's history]
    #[arg(long, value_name = "X", value_parser = above_zero)]
    pub(super) noise: Option<f64>,

    /// Number of simulated experiments (rehearsals) with each of the two effects
    #[arg(long, value_name = "N", value_parser = rehearsals, default_value_t = 40)]
    pub(super) rehearsals: usize,

    /// The file of the input: `time_s`, and `<joint>.input` of each joint
    #[arg(short, long, value_name = "INPUT.csv")]
    pub(super) output: Option<PathBuf>,

    /// Also write the input with the expected output: a table (.csv), or a page with figures
    /// (.html)
    #[arg(long, value_name = "FILE.csv|FILE.html")]
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

/// Levels of an input, each once, ascending.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Levels(pub(crate) Vec<f64>);

pub(crate) fn levels(text: &str) -> Result<Levels, String> {
    /// More than anybody plays.
    const MOST: usize = 100;
    let expected = || "expected two levels or more, as in -2,-1,0,1,2 or -2..2:0.5".to_owned();
    let mut levels = match text.split_once("..") {
        Some((first, rest)) => range(first, rest, MOST).ok_or_else(expected)?,
        None => text.split(',').map(finite).collect::<Option<Vec<f64>>>().ok_or_else(expected)?,
    };
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    if levels.len() < 2 {
        return Err(expected());
    }
    if levels.len() > MOST {
        return Err(format!("more than {MOST} levels"));
    }
    Ok(Levels(levels))
}

/// `first`, and on in steps, as long as `most` and one more.
fn range(first: &str, rest: &str, most: usize) -> Option<Vec<f64>> {
    let (last, step) = rest.split_once(':')?;
    let (first, last, step) = (finite(first)?, finite(last)?, finite(step)?);
    if step <= 0.0 || last < first {
        return None;
    }
    // The last level belongs to the range, however its multiple is rounded.
    let end = last + 1e-9 * step;
    let level = |k: usize| {
        let level = first + k as f64 * step;
        // Zero is meant where rounding leaves a little.
        if level.abs() < 1e-9 * step { 0.0 } else { to_decimals(level, 9) }
    };
    Some((0..=most).map(level).take_while(|level| *level <= end).collect())
}

/// A number that inputs, outputs and seconds can have: squares of larger ones leave double precision,
/// and so do the inverses of smaller ones.
fn finite(text: &str) -> Option<f64> {
    const RANGE: std::ops::RangeInclusive<f64> = 1e-12..=1e12;
    let number = text.trim().parse().ok();
    number.filter(|number: &f64| *number == 0.0 || RANGE.contains(&number.abs()))
}

pub(crate) fn number(text: &str) -> Result<f64, String> {
    finite(text).ok_or_else(|| "expected a number, as in 12.5".to_owned())
}

pub(crate) fn ascending(text: &str) -> Result<(f64, f64), String> {
    pair(text).ok_or_else(|| "expected two numbers, the lower one first, as in 0.9,2".to_owned())
}

fn pair(text: &str) -> Option<(f64, f64)> {
    let (low, high) = text.split_once(',')?;
    let (low, high) = (finite(low)?, finite(high)?);
    (low <= high).then_some((low, high))
}

pub(crate) fn above_zero(text: &str) -> Result<f64, String> {
    finite(text).filter(|x| *x > 0.0).ok_or_else(|| "expected a number above zero".to_owned())
}

pub(crate) fn share(text: &str) -> Result<f64, String> {
    let share = finite(text).filter(|share| (0.0..1.0).contains(share));
    share.ok_or_else(|| "expected a share from 0 and below 1".to_owned())
}

pub(crate) fn power(text: &str) -> Result<f64, String> {
    let power = finite(text).filter(|power| *power > 0.0 && *power < 1.0);
    power.ok_or_else(|| "expected a probability above 0 and below 1".to_owned())
}

pub(crate) fn rehearsals(text: &str) -> Result<usize, String> {
    const MOST: usize = 10_000;
    let number = text.parse().ok().filter(|number| *number <= MOST);
    number.ok_or_else(|| format!("expected a whole number from 0 to {MOST}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_a_list_or_a_range() {
        assert_eq!(levels("2, -1,0,-1"), Ok(Levels(vec![-1.0, 0.0, 2.0])));
        assert_eq!(levels("-1..1:0.5"), Ok(Levels(vec![-1.0, -0.5, 0.0, 0.5, 1.0])));
        assert_eq!(levels("-0.3..0.3:0.1").map(|levels| levels.0.len()), Ok(7));
        for wrong in ["", "1", "1,1", "1,x", "1..2", "2..1:0.5", "0..1:0", "0..1:nan"] {
            assert!(levels(wrong).is_err_and(|why| why.starts_with("expected")), "{wrong}");
        }
        assert!(levels("0..1000:0.1").is_err_and(|why| why.contains("more than 100")));
    }

    #[test]
    fn pairs_ascend() {
        assert_eq!(ascending("0.9,2"), Ok((0.9, 2.0)));
        assert!(ascending("2,0.9").is_err() && ascending("2").is_err());
    }
}
