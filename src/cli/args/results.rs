//! Where results go, and how the work is done.

use std::path::PathBuf;

use anyhow::anyhow;
use clap::{Args, ValueEnum};
use serde::Serialize;

use super::number::threads;
use crate::batch::with_prepared_threads;
use crate::cli::console::{self, Host, Verbosity};
use crate::cli::viewer::StreamArgs;
use crate::delay::CandidateLines;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people
    Text,
    /// JSON, schema `tauscope/<command>/1`
    Json,
}

impl Format {
    /// Prints `text`, or JSON.
    pub(crate) fn print<J: Serialize>(
        self,
        text: impl FnOnce() -> String,
        json: impl FnOnce() -> J,
    ) -> anyhow::Result<()> {
        match self {
            Self::Text => console::print(&text()),
            Self::Json => console::print_json(&json()),
        }
    }
}

/// How a command works and prints.
#[derive(Args, Debug)]
pub(crate) struct RunArgs {
    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,

    /// Threads to use [default: all processors]
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,

    /// No progress, no notices
    #[arg(short, long)]
    quiet: bool,
}

impl RunArgs {
    /// Whether progress and notices are shown.
    pub(crate) fn verbosity(&self) -> Verbosity {
        self.quiet.into()
    }

    /// Does `work` with as many threads as are to be used.
    pub(crate) fn in_threads<T: Send>(&self, work: impl FnOnce() -> T + Send) -> anyhow::Result<T> {
        let host = Host::current();
        let run = move |thread: &mut (dyn FnMut() + Send)| {
            Host::enter(host.clone());
            match &host {
                Some(host) => host.run_thread(thread),
                None => thread(),
            }
        };
        with_prepared_threads(self.threads, run, work)
            .map_err(|error| anyhow!("threads cannot be started: {error}"))
    }
}

/// Where the results of a command go.
#[derive(Args, Debug)]
pub(crate) struct ResultArgs {
    /// Record the results for the Rerun viewer
    #[arg(short = 'o', long = "output", value_name = "FILE.rrd")]
    pub(crate) recording: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) stream: StreamArgs,

    #[command(flatten)]
    pub(crate) run: RunArgs,
}

impl ResultArgs {
    /// Whether anything is made for a viewer.
    pub(crate) fn is_recorded(&self) -> bool {
        self.recording.is_some() || self.stream.is_asked()
    }

    /// The lines of every candidate only where somebody looks at them.
    pub(crate) fn lines(&self) -> CandidateLines {
        if self.is_recorded() { CandidateLines::All } else { CandidateLines::Best }
    }
}
