//! What is held beside decisions: other results (`--against`), and what a person said (`--review`).

use std::path::PathBuf;

use clap::Args as ClapArgs;

use crate::study::Review;

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
