//! What is to be done with each log.

use std::path::Path;

use crate::cli::args::{DataArgs, RunArgs};

/// A command that is to run for each log.
pub(crate) struct Each<'a> {
    pub(crate) command: &'static str,
    pub(crate) data: &'a DataArgs,
    /// Where all decisions go, where the command has any.
    pub(crate) decisions: Option<&'a Path>,
    /// Options that make no sense for many logs, and whether they were given.
    pub(crate) refused: &'a [(&'static str, bool)],
    pub(crate) run: &'a RunArgs,
}
