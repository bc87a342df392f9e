//! What a person said of the decisions: `--review`.

use std::path::PathBuf;

use clap::Args as ClapArgs;

use crate::study::Review;

/// A review of the decisions.
#[derive(ClapArgs, Debug)]
pub(crate) struct ReviewArgs {
    /// Put a person's word above the conditions: a table with the columns
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
