//! `tauscope completions`: what shells know of the program.

use std::io::Write as _;

use clap::{Args as ClapArgs, Command};
use clap_complete::Shell;

use crate::cli::console;
use crate::cli::failure::Completion;

/// Print the script by which a shell completes commands, options and their values
///
/// For bash: `tauscope completions bash > ~/.local/share/bash-completion/completions/tauscope`.
/// For fish: `tauscope completions fish > ~/.config/fish/completions/tauscope.fish`.
/// For zsh: `tauscope completions zsh > FOLDER/_tauscope`, the folder being one of `$fpath`.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Prints the script for `program`.
pub(crate) fn run(args: &Args, mut program: Command) -> anyhow::Result<Completion> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program, "tauscope", &mut script);
    console::print_with(|out| out.write_all(&script))?;
    Ok(Completion::Whole)
}
