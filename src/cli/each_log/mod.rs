//! `--results FOLDER`: each log an experiment of its own, whose result is kept.
//!
//! A log is worked on by this program itself, called for that log alone, so that its result
//! is what anybody gets who calls it so.

mod work;

use std::path::{Path, PathBuf};

use crate::report::folder::{FolderReport, folder_json};
use anyhow::{Context as _, bail};
use clap::Args;

use crate::cli::args::{Format, RunArgs};
use crate::cli::console::warn;
use crate::cli::failure::Completion;
use crate::cli::output::{OutputKind, Outputs, write_table};

pub(crate) use work::Each;
use work::{LogOptions, Work};

/// Many logs, each by itself.
#[derive(Args, Debug)]
#[command(next_help_heading = "Many logs")]
pub(crate) struct FolderArgs {
    /// Process each log as an experiment of its own, and keep its result in this folder. A log
    /// whose result is there already, from the same bytes, settings and version, is skipped
    #[arg(long, value_name = "FOLDER")]
    results: Option<PathBuf>,

    /// Work on the K-th of N parts of the logs only; when all parts are done, the command without this
    /// makes the tables
    #[arg(long, value_name = "K/N", requires = "results")]
    shard: Option<Shard>,

    /// Write a row per log and joint, as CSV or Parquet
    #[arg(long, value_name = "FILE", requires = "results")]
    summary: Option<PathBuf>,
}

/// A part of the logs: every `of`-th, from the `number`-th on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shard {
    number: usize,
    of: usize,
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts = text.split_once('/');
        let parts = parts.and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        let shard = parts.map(|(number, of)| Self { number, of });
        let shard = shard.filter(|shard| (1..=shard.of).contains(&shard.number));
        shard.ok_or_else(|| "expected K/N, with K from 1 to N: 3/16".to_owned())
    }
}

impl Shard {
    fn has(self, index: usize) -> bool {
        index % self.of + 1 == self.number
    }
}

impl FolderArgs {
    /// Whether each log is an experiment of its own.
    pub(crate) fn is_asked_for(&self) -> bool {
        self.results.is_some()
    }

    /// Runs the command for each log that has no result yet.
    pub(crate) fn run(&self, each: &Each<'_>) -> anyhow::Result<Completion> {
        let results = self.results.as_deref().unwrap_or(Path::new("."));
        if let Some((name, _)) = each.refused.iter().find(|(_, given)| *given) {
            bail!("{name}: it is for one log; leave it out, or leave out `--results`");
        }
        let tables = [each.decisions, self.summary.as_deref()];
        if self.shard.is_some() && tables.iter().any(Option::is_some) {
            bail!(
                "--shard: the tables need the results of all parts; leave out `--decisions` and \
                 `--summary`, and run the command with them, without `--shard`, when all parts are done"
            );
        }
        let options = LogOptions::of(&each.data.typed);
        // A table may be in the folder.
        std::fs::create_dir_all(results)
            .with_context(|| format!("{}: cannot be made", results.display()))?;
        let (all, mut failures) = each.data.logs();
        for note in each.data.left_out() {
            each.run.verbosity().say("note", note);
        }
        // No result of a log has the name of a table.
        let outputs = Outputs::default().with(OutputKind::Table, tables.into_iter().flatten());
        outputs.check(&[each.data.files(), options.files.clone()].concat())?;
        if all.is_empty() {
            bail!(failures.into_iter().next().unwrap_or_else(|| "no log is given".to_owned()));
        }
        let part =
            |(index, _): &(usize, &PathBuf)| self.shard.is_none_or(|shard| shard.has(*index));
        let logs: Vec<&PathBuf> = all.iter().enumerate().filter(part).map(|(_, log)| log).collect();
        let (found, failed) = Work { each, results, options: &options }.run(&logs)?;
        failures.extend(failed);
        if let Some(Shard { number, of }) = self.shard {
            warn(&failures);
            let done =
                format!("part {number} of {of}; without `--shard` the command makes the tables");
            each.run.verbosity().say("done", done);
            return Ok(Completion::without(&failures));
        }
        present(&FolderReport::new(each.command, found), failures, tables, each.run)
    }
}

/// Writes the tables of decisions and of all logs, and prints what the logs have in common.
fn present(
    report: &FolderReport,
    mut failures: Vec<String>,
    [decisions, summary]: [Option<&Path>; 2],
    run: &RunArgs,
) -> anyhow::Result<Completion> {
    failures.extend(report.failures());
    warn(&failures);
    if report.is_empty() {
        bail!("no log has a result");
    }
    if decisions.or(summary).is_none() && run.format == Format::Text {
        run.verbosity().say("note", "`--summary FILE` writes a row per log and joint");
    }
    if let Some(path) = decisions {
        write_table(&report.decisions(), path)?;
    }
    if let Some(path) = summary {
        write_table(&report.summary(), path)?;
    }
    run.format.print(|| report.text(), || folder_json(report, &failures))?;
    Ok(Completion::without(&failures))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_log_is_in_one_part() {
        for of in 1..6 {
            for index in 0..20 {
                let parts = (1..=of).filter(|&number| Shard { number, of }.has(index));
                assert_eq!(parts.count(), 1, "{index} of {of}");
            }
        }
    }

    #[test]
    fn a_part_is_written_as_its_number_of_all() {
        assert_eq!("3/16".parse(), Ok(Shard { number: 3, of: 16 }));
        for bad in ["0/4", "5/4", "3", "a/b", "1/0", "-1/2"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }
}
