//! `tauscope effects`

use crate::effect::{REGISTRY, find};
use crate::report::{EffectsJson, listing, sheet};
use clap::Args as ClapArgs;

use super::Completion;
use super::fitting::Format;
use super::terminal;

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

pub(super) fn run(args: &Args) -> anyhow::Result<Completion> {
    /// Columns of the text.
    const WIDTH: usize = 90;
    match (args.format, &args.effect) {
        (Format::Json, _) => terminal::print_json(&EffectsJson::new(REGISTRY))?,
        (Format::Text, None) => terminal::print(&listing(WIDTH))?,
        (Format::Text, Some(id)) => terminal::print(&sheet(find(id)?, WIDTH))?,
    }
    Ok(Completion::Whole)
}
