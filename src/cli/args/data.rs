//! The options of every command that reads logs, and what is held beside their decisions.

use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::{Args, Args as ClapArgs};

use super::number;
use crate::cli::console::Host;
use crate::cli::failure::said;
use crate::cli::typed::Typed;
use crate::experiment::{
    ColumnMap, Experiment, JointColumns, MemoryLimit, ReadOptions, Repair, expand_folders,
    format_names, notes_on_subfolders,
};
use crate::study::Review;
use crate::units::SamplePeriod;

/// Where the logs are and how they are read.
#[derive(Args, Debug)]
pub(crate) struct DataArgs {
    /// The options of the command. It stands first, since what is read of a command line is taken out of
    /// it; so does this group in each command.
    #[command(flatten)]
    pub(crate) typed: Typed,

    #[arg(help = help(), required = true, value_name = "DATA")]
    data: Vec<PathBuf>,

    #[command(flatten)]
    reading: ReadingArgs,
}

fn help() -> String {
    format!("Logs ({}), or folders of logs", format_names())
}

/// How logs are read.
#[derive(Args, Debug)]
#[command(next_help_heading = "How logs are read")]
pub(crate) struct ReadingArgs {
    /// A joint to use, by name; or `NAME=INPUT_COLUMN:OUTPUT_COLUMN` where the columns have other
    /// names. May be repeated
    #[arg(long, value_name = "NAME[=IN:OUT]")]
    joint: Vec<String>,

    /// Column of the time in seconds
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,

    /// Column that names the trial of a row, or `none`
    #[arg(long, value_name = "COLUMN")]
    trial: Option<String>,

    /// Seconds between samples, for a log without a time column
    #[arg(long, value_name = "SECONDS", value_parser = number::period)]
    sample_period: Option<SamplePeriod>,

    /// A TOML file that says which columns are the time and the inputs and outputs, as `tauscope
    /// columns -w` writes it
    #[arg(long, value_name = "FILE")]
    columns: Option<PathBuf>,

    /// Put unevenly sampled logs on a grid of this period: output linear, input held
    #[arg(long, value_name = "SECONDS", value_parser = number::period)]
    resample: Option<SamplePeriod>,

    /// Fill gaps of the output up to this long; longer ones split the trial in two. An
    /// input that is missing is held
    #[arg(long, value_name = "SECONDS", value_parser = number::seconds)]
    fill: Option<f64>,

    #[command(flatten)]
    memory: MemoryArgs,
}

/// How much memory logs may take.
#[derive(Args, Debug)]
pub(crate) struct MemoryArgs {
    /// Limit of the memory for reading logs, in bytes or as `500MB` or `4GB`: a log that needs more
    /// is refused [default: half of the machine's]
    #[arg(long, value_name = "SIZE", value_parser = number::bytes)]
    max_memory: Option<u64>,
}

impl MemoryArgs {
    pub(crate) fn limit(&self) -> MemoryLimit {
        self.max_memory.map_or_else(MemoryLimit::default, MemoryLimit::of_bytes)
    }
}

impl DataArgs {
    /// The logs by their names, each once; and messages on folders without any.
    pub(crate) fn logs(&self) -> (Vec<PathBuf>, Vec<String>) {
        let (mut files, unlisted) = expand_folders(&self.data);
        files.sort();
        files.dedup();
        (files, unlisted.iter().map(|failure| said(&failure.error)).collect())
    }

    /// The logs and folders as they are named.
    pub(crate) fn given(&self) -> &[PathBuf] {
        &self.data
    }

    /// A note on each folder that has logs in folders of its own, which are left out.
    pub(crate) fn left_out(&self) -> Vec<String> {
        notes_on_subfolders(&self.data)
    }

    /// The only log, which need not be there yet.
    ///
    /// # Errors
    /// When there are several, or when gaps are to be filled: trials get new names at each.
    pub(crate) fn only_file(&self) -> anyhow::Result<PathBuf> {
        let [path] = self.data.as_slice() else {
            bail!("expected one log, but {} are given", self.data.len());
        };
        if path.is_dir() {
            bail!("{}: expected a log, but this is a folder", path.display());
        }
        if path.metadata().is_ok_and(|found| !found.is_file()) {
            bail!(
                "{}: a pipe or a device cannot be followed; write it to a file, as with `tee`, \
                 and follow that file",
                path.display()
            );
        }
        if self.reading.fill.is_some() {
            bail!(
                "`--fill` splits and renames trials at gaps, which a growing log does not \
                   allow; leave it out until the log has ended"
            );
        }
        Ok(path.clone())
    }

    /// How logs are read.
    pub(crate) fn options(&self) -> anyhow::Result<ReadOptions> {
        self.reading.options()
    }

    /// How logs are read, also of the joints that are not asked for.
    pub(crate) fn options_with_others(&self) -> anyhow::Result<ReadOptions> {
        Ok(ReadOptions { others: true, ..self.options()? })
    }

    /// The files that are read, where they really are.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let (files, _) = expand_folders(&self.data);
        let files = files.iter().chain(&self.reading.columns);
        // One that is to be followed may not be there yet.
        files.map(|file| file.canonicalize().unwrap_or_else(|_| file.clone())).collect()
    }

    /// Logs and options as they are typed, with those that are `further`; for one joint of several where
    /// it is named.
    pub(crate) fn words(&self, joint: Option<&str>, further: &[&str]) -> Vec<String> {
        const READING: [&str; 7] =
            ["time", "trial", "sample-period", "columns", "resample", "fill", "max-memory"];
        let is_mapped = |given: &&String| {
            joint.is_none_or(|name| given.split_once('=').is_some_and(|(own, _)| own == name))
        };
        let mut joints: Vec<String> =
            self.reading.joint.iter().filter(is_mapped).cloned().collect();
        if joints.is_empty() {
            joints.extend(joint.map(str::to_owned));
        }
        let joints = joints.into_iter().flat_map(|joint| ["--joint".to_owned(), joint]);
        let options = self.typed.of(|name| READING.contains(&name) || further.contains(&name));
        let options = options.filter_map(|(name, value)| {
            Some([format!("--{name}"), value?.to_string_lossy().into_owned()])
        });
        let logs = self.data.iter().map(|path| path.display().to_string());
        logs.chain(joints).chain(options.flatten()).collect()
    }
}

impl ReadingArgs {
    /// The joints that are named.
    pub(crate) fn joints(&self) -> Vec<String> {
        let name = |joint: &String| joint.split('=').next().unwrap_or_default().to_owned();
        self.joint.iter().map(name).collect()
    }

    /// How logs are read.
    pub(crate) fn options(&self) -> anyhow::Result<ReadOptions> {
        let mut columns = match &self.columns {
            Some(path) => ColumnMap::read(path)?,
            None => ColumnMap::default(),
        };
        columns.time = self.time.clone().or(columns.time);
        columns.trial = self.trial.clone().or(columns.trial);
        let period = self.sample_period.map(SamplePeriod::seconds);
        columns.sample_period_s = period.or(columns.sample_period_s);
        let (mapped, named): (Vec<_>, Vec<_>) =
            self.joint.iter().partition(|joint| joint.contains('='));
        let mut joints: Vec<String> = named.into_iter().cloned().collect();
        for text in mapped {
            let joint: JointColumns = text.parse().context("--joint")?;
            joints.push(joint.name.clone());
            columns.joints.push(joint);
        }
        // Beside mapped joints, a native one is known by its columns' names.
        if !columns.joints.is_empty() {
            for name in &joints {
                if columns.joints.iter().all(|joint| &joint.name != name) {
                    let (input, output) = (format!("{name}.input"), format!("{name}.output"));
                    columns.joints.push(JointColumns::new(name, &input, &output));
                }
            }
        }
        let repair = Repair { resample: self.resample, fill_s: self.fill, as_it_stands: false };
        let memory = self.memory.limit();
        Ok(ReadOptions { columns, joints, others: false, repair, memory })
    }
}

/// Reads the logs `data`. Failures of single files and joints are in the result.
///
/// # Errors
/// When no joint at all can be read.
pub(crate) fn read(data: &[PathBuf], options: &ReadOptions) -> anyhow::Result<Experiment> {
    let mut experiment = read_or_take(data, options);
    if !experiment.joints.is_empty() {
        return Ok(experiment);
    }
    let others = experiment.failures.len().saturating_sub(1);
    let first = experiment.failures.drain(..).next().context("no joint in the logs")?;
    let error = anyhow::Error::from(first.error);
    Err(match others {
        0 => error,
        1 => error.context("nothing could be read (and one more failed)"),
        _ => error.context(format!("nothing could be read (and {others} more failed)")),
    })
}

/// What the program that runs the command has in memory, or else what is in the files.
fn read_or_take(data: &[PathBuf], options: &ReadOptions) -> Experiment {
    if let Some(handed) = Host::current().and_then(|host| host.logs(options)) {
        return handed;
    }
    let (files, unlisted) = expand_folders(data);
    let mut experiment = Experiment::read(&files, options);
    experiment.failures.splice(0..0, unlisted);
    experiment.notes.extend(notes_on_subfolders(data));
    experiment
}

/// Results to compare with.
#[derive(ClapArgs, Debug)]
pub(crate) struct AgainstArgs {
    /// Show where decisions differ from those of another result: the JSON of an earlier
    /// `estimate --format json`, its table of `--decisions`, or another log of the experiment,
    /// which is estimated with the same settings. May be repeated
    #[arg(long, value_name = "FILE")]
    pub(crate) against: Vec<PathBuf>,
}

/// A review of the decisions.
#[derive(ClapArgs, Debug)]
pub(crate) struct ReviewArgs {
    /// Apply a person's review, which overrides the conditions: a table with the columns
    /// `joint,trial,i,verdict,delay_s,note,reviewer`, as `estimate --review-sheet` writes it and
    /// `report --interactive` saves it
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) review: Option<PathBuf>,
}

impl ReviewArgs {
    /// What was said; nothing where no file is given.
    pub(crate) fn read(&self) -> anyhow::Result<Review> {
        Ok(self.review.as_deref().map(Review::read).transpose()?.unwrap_or_default())
    }
}
