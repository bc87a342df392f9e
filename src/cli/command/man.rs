//! `tauscope man`: the manual pages.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::{Args as ClapArgs, Command};
use clap_mangen::Man;

use crate::cli::console::{self, message};
use crate::cli::exit::Completion;
use crate::cli::output::write_bytes;
use crate::experiment::{did_you_mean, nearest_name};

/// Print the manual page of a command, or write all pages to a folder
///
/// `tauscope man estimate | man -l -` shows one; `tauscope man -o ~/.local/share/man/man1`
/// puts them where `man tauscope-estimate` finds them.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// The command [default: the program as a whole]
    #[arg(value_name = "COMMAND", conflicts_with = "folder")]
    command: Option<String>,

    /// Write a page per command to this folder
    #[arg(short = 'o', long = "output", value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

/// Prints or writes the pages of `program`.
pub(crate) fn run(args: &Args, program: Command) -> anyhow::Result<Completion> {
    let pages = pages(program);
    if let Some(folder) = &args.folder {
        return write_all(&pages, folder);
    }
    let name =
        args.command.as_ref().map_or("tauscope".to_owned(), |name| format!("tauscope-{name}"));
    let Some(page) = pages.iter().find(|page| name_of(page) == name) else {
        bail!(unknown(args.command.as_deref().unwrap_or_default(), &pages));
    };
    let page = rendered(page)?;
    console::print_with(|out| out.write_all(&page))?;
    Ok(Completion::Whole)
}

/// The program and each of its commands, by the names of their pages.
fn pages(program: Command) -> Vec<Command> {
    let mut program = program.disable_help_subcommand(true);
    program.build();
    let shown = program.get_subcommands().filter(|command| !command.is_hide_set());
    let commands: Vec<_> = shown.cloned().collect();
    std::iter::once(program).chain(commands).collect()
}

/// What a page is called: `tauscope`, or `tauscope-` and the command.
fn name_of(page: &Command) -> &str {
    page.get_display_name().unwrap_or_else(|| page.get_name())
}

fn rendered(page: &Command) -> io::Result<Vec<u8>> {
    let mut roff = Vec::new();
    let version = format!("tauscope {}", env!("CARGO_PKG_VERSION"));
    Man::new(page.clone()).source(version).render(&mut roff)?;
    Ok(roff)
}

fn write_all(pages: &[Command], folder: &Path) -> anyhow::Result<Completion> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{}: cannot be made", folder.display()))?;
    for page in pages {
        let path = folder.join(format!("{}.1", name_of(page)));
        write_bytes(&path, rendered(page)?)?;
    }
    message("pages", &format!("{} in {}", pages.len(), folder.display()));
    Ok(Completion::Whole)
}

fn unknown(wanted: &str, pages: &[Command]) -> String {
    let names = pages.iter().filter_map(|page| name_of(page).strip_prefix("tauscope-"));
    let names: Vec<&str> = names.collect();
    let near = did_you_mean(nearest_name(wanted, names.iter().copied()));
    format!("no command `{wanted}`{near}; expected one of {}", names.join(", "))
}
