//! `tauscope columns`: what a log's columns are taken for, and the mapping that follows.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args as ClapArgs;

use crate::cli::args::{MemoryArgs, RunArgs};
use crate::cli::console::{Verbosity, warn};
use crate::cli::failure::Completion;
use crate::cli::output::{OutputKind, Outputs, write_bytes};
use crate::cli::typed::mapping_options;
use crate::experiment::{ColumnMap, Experiment, KEPT, MemoryLimit, ReadOptions, Survey};
use crate::report::columns::{columns_json, columns_table};

/// Say what each column of a log is taken for, and why
///
/// Names and data tell which column is the time, which drives a joint, and which follows.
/// With `-w` the mapping is written as a file for `--columns`, to be corrected by hand; without a name it is
/// `columns.toml` beside the log, which holds for all logs in this folder from then on. It also
/// lists the repairs made while reading the log.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// The log
    #[arg(value_name = "LOG")]
    log: PathBuf,

    /// Write the mapping for `--columns` [default file: `columns.toml` beside the log, which is read unasked]
    #[arg(short = 'w', long = "write", value_name = "FILE.toml", num_args = 0..=1, default_missing_value = "")]
    write: Option<OsString>,

    #[command(flatten)]
    memory: MemoryArgs,

    #[command(flatten)]
    run: RunArgs,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let survey = Survey::of(&args.log, args.memory.limit())?;
    if let Some(path) = &args.write {
        let beside = args.log.with_file_name(KEPT);
        let path = if path.is_empty() { &beside } else { Path::new(path) };
        let outputs = Outputs::default().with(OutputKind::Toml, [path]);
        outputs.check(std::slice::from_ref(&args.log))?;
        write(&survey, path, args.run.verbosity())?;
    }
    let map = &survey.map;
    let named = [map.time.as_deref(), map.trial.as_deref()];
    let mut options = Vec::new();
    for joints in survey.named_joints() {
        options.push(mapping_options(named, &joints));
    }
    let mended = mended(&survey, args.memory.limit());
    let text = || columns_table(&survey, &options, &mended);
    let time_alone = [mapping_options(named, &[])];
    let of_json = if options.is_empty() { &time_alone[..] } else { &options };
    args.run.format.print(text, || columns_json(&survey, of_json, &mended))?;
    let told = !survey.map.joints.is_empty();
    Ok(if told { Completion::Whole } else { Completion::Partial })
}

/// Writes the mapping of `survey` to `path`, unless it names no joint.
fn write(survey: &Survey, path: &Path, verbosity: Verbosity) -> anyhow::Result<()> {
    let name = path.display();
    if survey.map.joints.is_empty() {
        warn(&[format!("--write {name}: not written: no columns of a joint are recognized")]);
        return Ok(());
    }
    let mapping = survey.map.to_toml();
    // A mapping may have been corrected by hand.
    let is_mapping = path.is_file() && ColumnMap::read(path).is_ok();
    if is_mapping && std::fs::read_to_string(path).is_ok_and(|text| text != mapping) {
        bail!(
            "--write {name}: exists already with another mapping; remove it, or name another file"
        );
    }
    write_bytes(path, mapping)?;
    verbosity.say("columns", name.to_string());
    Ok(())
}

/// What is mended in the log where its columns are read as `survey` takes them, or why it cannot be read so;
/// nothing where that does not say what to read.
fn mended(survey: &Survey, memory: MemoryLimit) -> Vec<String> {
    if survey.map.joints.is_empty() || survey.map.time.is_none() {
        return Vec::new();
    }
    let columns = survey.map.clone();
    let options = ReadOptions { columns, memory, ..ReadOptions::default() };
    let read = Experiment::read(std::slice::from_ref(&survey.path), &options);
    let failures = read.failures.iter().map(|failure| failure.error.to_string());
    read.notes.into_iter().chain(failures).collect()
}
