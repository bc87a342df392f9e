//! `tauscope effects`

use std::io::{self, Write as _};

use anyhow::Context as _;
use clap::{Args as ClapArgs, ValueEnum};
use tauscope::effect::{EffectsJson, REGISTRY, find, listing, sheet};

use super::Completion;

/// List the physical effects that a model can have
#[derive(ClapArgs, Debug)]
pub(super) struct Args {
    /// One effect, with its drawing and its source
    #[arg(value_name = "EFFECT")]
    effect: Option<String>,

    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// For people
    Text,
    /// JSON, schema `tauscope/effects/1`
    Json,
}

pub(super) fn run(args: &Args) -> anyhow::Result<Completion> {
    /// Columns of the text.
    const WIDTH: usize = 90;
    let text = match (args.format, &args.effect) {
        (Format::Json, _) => serde_json::to_string(&EffectsJson::new(REGISTRY))? + "\n",
        (Format::Text, None) => listing(WIDTH),
        (Format::Text, Some(id)) => sheet(find(id)?, WIDTH),
    };
    let mut out = io::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.context("standard output cannot be written")?;
    Ok(Completion::Whole)
}
