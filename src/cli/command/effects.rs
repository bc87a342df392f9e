//! `tauscope effects`

use crate::effect::{REGISTRY, find};
use crate::report::effects::{effects_json, listing, sheet};
use clap::Args as ClapArgs;

use crate::cli::args::Format;
use crate::cli::failure::Completion;

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
    let effect = args.effect.as_deref().filter(|_| args.format == Format::Text);
    let effect = effect.map(find).transpose()?;
    let text = || effect.map_or_else(|| listing(WIDTH), |effect| sheet(effect, WIDTH));
    args.format.print(text, || effects_json(REGISTRY))?;
    Ok(Completion::Whole)
}
