//! `tauscope importer`: lets the viewer open logs.

use std::path::{Path, PathBuf};
use std::{env, fs};

use anyhow::{Context as _, bail};
use clap::Args as ClapArgs;

use crate::cli::console;
use crate::cli::failure::Completion;
use crate::cli::viewer::{IMPORTER, installed, on_path};

/// Let the Rerun viewer open logs: `rerun LOG.csv` shows the whole recording
///
/// To open a file, the viewer calls every program on PATH whose name begins with `rerun-importer-`.
/// `--install` makes a link of that kind, `rerun-importer-tauscope`, to this program. To undo it,
/// delete the link.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// Make the link
    #[arg(long)]
    install: bool,

    /// The folder for the link [default: the one of the viewer `rerun`, else ~/.local/bin]
    #[arg(long, value_name = "FOLDER", requires = "install")]
    folder: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    if !args.install {
        bail!("`tauscope importer --install` makes the link; `tauscope doctor` says where one is");
    }
    let link = install(args.folder.as_deref())?;
    let is_found = installed().is_some_and(|found| is_same(&found, &link));
    let folder = link.parent().unwrap_or(Path::new(".")).display();
    let said = if is_found {
        "`rerun LOG.csv` opens the recording of a log".to_owned()
    } else {
        format!("put {folder} on PATH, where viewers look, and `rerun LOG.csv` opens a log")
    };
    console::print(&format!("{}: {said}\n", link.display()))?;
    Ok(Completion::Whole)
}

/// Makes the link, in the place of an older one; where it is.
fn install(folder: Option<&Path>) -> anyhow::Result<PathBuf> {
    let folder = match folder {
        Some(folder) => folder.to_owned(),
        None => default_folder()?,
    };
    fs::create_dir_all(&folder).with_context(|| format!("{}: cannot be made", folder.display()))?;
    let link = folder.join(format!("{IMPORTER}{}", env::consts::EXE_SUFFIX));
    let program = env::current_exe().context("it is not known where this program is")?;
    // A file that is no link was put there by somebody.
    if link.exists() && !link.is_symlink() && cfg!(unix) {
        bail!("{}: exists already and is not a link; remove it first", link.display());
    }
    if link.is_symlink() || link.exists() {
        fs::remove_file(&link)
            .with_context(|| format!("{}: cannot be replaced", link.display()))?;
    }
    place(&program, &link).with_context(|| {
        format!("{}: cannot be made; name another folder with --folder", link.display())
    })?;
    Ok(link)
}

/// The folder of the viewer, which is on PATH where the viewer is started by its name; else the one
/// for programs of a person.
fn default_folder() -> anyhow::Result<PathBuf> {
    let viewer = on_path("rerun", env::var_os("PATH").as_deref());
    if let Some(folder) = viewer.as_deref().and_then(Path::parent) {
        return Ok(folder.to_owned());
    }
    let home = env::home_dir().context("there is no home folder; name a folder with --folder")?;
    Ok(home.join(".local/bin"))
}

#[cfg(unix)]
fn place(program: &Path, link: &Path) -> std::io::Result<()> {
    std::os::unix::fs::symlink(program, link)
}

#[cfg(not(unix))]
fn place(program: &Path, link: &Path) -> std::io::Result<()> {
    fs::copy(program, link).map(drop)
}

fn is_same(a: &Path, b: &Path) -> bool {
    a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b)
}
