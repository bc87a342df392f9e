//! `tauscope design`: the next experiment.

mod desk;
mod random;
mod separate;
mod values;

use std::path::{Path, PathBuf};

use crate::batch::with_threads;
use crate::experiment::ReadOptions;
use crate::report::{DesignJson, DesignedJoint, design_text, write_input, write_preview};
use anyhow::anyhow;
use clap::Args as ClapArgs;

use super::fitting::{Format, print};
use super::output::{check_outputs, write_file};
use super::progress::{Bar, Verbosity};
use super::record::{PreviewContents, recordings_are_there};
use super::terminal::message;
use super::{Completion, read_failures};

use desk::Desk;
use values::{BandChoice, Levels};

/// Design the next experiment: an input to play
///
/// Random steps, as Albrecht and Taylor advise: a finite set of levels, repeated, held for
/// random times, from each level to each other about as often. With a model the joint stays in
/// the range that it may have. `--separate A,B` makes the shortest input that tells two effects
/// apart, and says how surely.
#[derive(ClapArgs, Debug)]
pub(super) struct Args {
    /// Logs of earlier experiments (CSV): what they tell of the joints is used
    #[arg(value_name = "DATA")]
    data: Vec<PathBuf>,

    /// The model file (TOML, schema `tauscope/model/1`)
    #[arg(short, long, value_name = "MODEL.toml", help_heading = "Model")]
    model: Option<PathBuf>,

    /// How far the numbers of a model may be off that no log confirms, in parts
    #[arg(
        long, value_name = "SHARE", value_parser = values::share, default_value_t = 0.1,
        allow_negative_numbers = true, help_heading = "Model"
    )]
    uncertainty: f64,

    /// A joint that is driven, by name. May be repeated [default: those of the logs or of the
    /// model file]
    #[arg(long, value_name = "NAME", help_heading = "Input")]
    joint: Vec<String>,

    /// The levels: a list, or a range with its step, as in -2,-1,0,1,2 or -2..2:0.5
    #[arg(
        long, value_name = "LIST", value_parser = values::levels, allow_hyphen_values = true,
        help_heading = "Input"
    )]
    levels: Option<Levels>,

    /// Largest magnitude of the input, where levels are not given [default: that of the logs,
    /// else what suits the model, else 2]
    #[arg(
        long, value_name = "X", value_parser = values::above_zero, allow_negative_numbers = true,
        help_heading = "Input"
    )]
    largest: Option<f64>,

    /// Shortest and longest hold in seconds [default: longer than the model takes to respond,
    /// else 1,2.5]
    #[arg(
        long, value_name = "MIN,MAX", value_parser = values::ascending,
        allow_hyphen_values = true, help_heading = "Input"
    )]
    hold: Option<(f64, f64)>,

    /// Length in seconds; with `--separate` the longest that is tried [default: 120, or 60]
    #[arg(
        long, value_name = "SECONDS", value_parser = values::above_zero,
        allow_negative_numbers = true, help_heading = "Input"
    )]
    duration: Option<f64>,

    /// Samples per second [default: as the logs, else 100]
    #[arg(
        long, value_name = "HZ", value_parser = values::above_zero,
        allow_negative_numbers = true, help_heading = "Input"
    )]
    rate: Option<f64>,

    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = "Input")]
    seed: u64,

    /// Lowest and highest output that the joint may come to; needs a model or a log [default
    /// with `--separate` and a log: where the log has been]
    #[arg(
        long, value_name = "LO,HI", value_parser = values::ascending,
        allow_hyphen_values = true, help_heading = "Input"
    )]
    output_range: Option<(f64, f64)>,

    /// The output at which it starts [default: 0, or the middle of the range]
    #[arg(long, value_name = "X", allow_negative_numbers = true, help_heading = "Input")]
    start: Option<f64>,

    /// `cross`: a level lies in the model's dead band; `avoid`: none does; or the ends of a
    /// band in which none is to lie
    #[arg(
        long, value_name = "cross|avoid|LO,HI", value_parser = values::band,
        allow_hyphen_values = true, help_heading = "Input"
    )]
    dead_band: Option<BandChoice>,

    /// Two effects to tell apart. The model has one of them, or a log is given
    #[arg(
        long, value_name = "EFFECT,EFFECT", value_delimiter = ',',
        conflicts_with_all = ["levels", "dead_band"], help_heading = "Telling effects apart"
    )]
    separate: Vec<String>,

    /// The probability of success that is wanted
    #[arg(
        long, value_name = "SHARE", value_parser = values::power, default_value_t = 0.95,
        allow_negative_numbers = true, help_heading = "Telling effects apart"
    )]
    power: f64,

    /// Standard deviation of the measurement noise [default: that of the log, else the error
    /// in the model file's history]
    #[arg(
        long, value_name = "X", value_parser = values::above_zero, allow_negative_numbers = true,
        help_heading = "Telling effects apart"
    )]
    noise: Option<f64>,

    /// How often the experiment is rehearsed with either effect, in simulation
    #[arg(
        long, value_name = "N", value_parser = values::rehearsals, default_value_t = 40,
        help_heading = "Telling effects apart"
    )]
    rehearsals: usize,

    /// Where the input goes: `time_s`, and `<joint>.input` of each joint
    #[arg(short, long, value_name = "INPUT.csv", help_heading = "Output")]
    output: Option<PathBuf>,

    /// Where the input goes with what is expected of it: a table (.csv), or a recording for the
    /// Rerun viewer (.rrd)
    #[arg(long, value_name = "FILE.csv|FILE.rrd", help_heading = "Output")]
    preview: Option<PathBuf>,

    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text, help_heading = "Output")]
    format: Format,

    /// Threads to use [default: all processors]
    #[arg(long, value_name = "N", value_parser = super::data::threads, help_heading = "Output")]
    threads: Option<usize>,

    /// No notices
    #[arg(short, long, help_heading = "Output")]
    quiet: bool,
}

impl Args {
    fn verbosity(&self) -> Verbosity {
        if self.quiet { Verbosity::Quiet } else { Verbosity::Normal }
    }

    /// Writes the preview recording to `path`.
    fn record(&self, desk: &Desk, joints: &[DesignedJoint], path: &Path) -> anyhow::Result<()> {
        let usual = ReadOptions::default();
        let read = desk.experiment.as_ref();
        let contents = PreviewContents {
            joints,
            sources: read.map_or(&[][..], |experiment| &experiment.sources),
            reading: read.map_or(&usual, |experiment| &experiment.options),
            model: self.model.as_deref(),
        };
        contents.record(path, self.verbosity())
    }

    /// Says which file was written.
    fn tell(&self, kind: &str, path: &Path) {
        if !self.quiet {
            message(kind, &path.display().to_string());
        }
    }
}

pub(super) fn run(args: &Args) -> anyhow::Result<Completion> {
    let outputs: Vec<_> = args.output.iter().chain(&args.preview).map(PathBuf::as_path).collect();
    let inputs = args.data.iter().chain(&args.model).filter_map(|path| path.canonicalize().ok());
    check_outputs(&outputs, &inputs.collect::<Vec<_>>())?;
    if args.preview.as_deref().is_some_and(is_recording) {
        recordings_are_there()?;
    }
    let designed = with_threads(args.threads, || {
        let desk = Desk::new(args)?;
        let (joints, failures) = designed(args, &desk)?;
        anyhow::Ok((desk, joints, failures))
    });
    let (desk, joints, failures) =
        designed.map_err(|error| anyhow!("threads cannot be started: {error}"))??;
    if let Some(path) = &args.output {
        write_file(path, |file| Ok(write_input(&joints, file)?))?;
        args.tell("input", path);
    }
    match args.preview.as_deref() {
        Some(path) if is_recording(path) => args.record(&desk, &joints, path)?,
        Some(path) => {
            write_file(path, |file| Ok(write_preview(&joints, file)?))?;
            args.tell("preview", path);
        }
        None => {}
    }
    print(
        args.format,
        &failures,
        || design_text(&joints),
        |out| serde_json::to_writer(out, &DesignJson::new(args.seed, &joints, &failures)),
    )
}

/// Whether a preview of this name is a recording.
fn is_recording(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("rrd"))
}

/// The inputs of all joints, and messages on those that have none.
fn designed(args: &Args, desk: &Desk) -> anyhow::Result<(Vec<DesignedJoint>, Vec<String>)> {
    let bar = Bar::spinner(args.verbosity(), "designing");
    let results = if args.separate.is_empty() {
        random::designed(args, desk)
    } else {
        separate::designed(args, desk, &bar)?
    };
    let mut failures = desk.experiment.as_ref().map(read_failures).unwrap_or_default();
    let mut joints = Vec::new();
    for (name, result) in desk.names.iter().zip(results) {
        match result {
            Ok(joint) => joints.push(joint),
            Err(error) => failures.push(format!("joint `{name}`: {error:#}")),
        }
    }
    match failures.first() {
        Some(first) if joints.is_empty() => Err(anyhow!(first.clone())),
        _ => Ok((joints, failures)),
    }
}
