//! `tauscope effects`

use crate::effect::{REGISTRY, find};
use crate::report::{EffectsJson, listing, sheet};
use clap::Args as ClapArgs;

use crate::cli::args::Format;
use crate::cli::console;
use crate::cli::exit::Completion;

/// List the physical effects that a model can have
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// One effect, with its drawing and its source
    #[arg(value_name = "EFFECT")]
    effect: Option<String>,

    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    /// Columns of the text.
    const WIDTH: usize = 90;
    match (args.format, &args.effect) {
        (Format::Json, _) => console::print_json(&EffectsJson::new(REGISTRY))?,
        (Format::Text, None) => console::print(&listing(WIDTH))?,
        (Format::Text, Some(id)) => console::print(&sheet(find(id)?, WIDTH))?,
    }
    Ok(Completion::Whole)
}
