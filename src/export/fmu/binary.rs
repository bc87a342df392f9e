//! The binary of this platform, where a C compiler is there.

use std::env::consts::{ARCH, DLL_SUFFIX, OS};
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::Path;
use std::process::Command;

use super::archive::Entry;

/// The library that the sources of `entries` make, under its name in an FMU.
///
/// # Errors
/// Why there is none, in words.
pub(super) fn compiled(entries: &[Entry], name: &str) -> Result<Entry, String> {
    let compiler = std::env::var_os("CC").unwrap_or_else(|| OsString::from("cc"));
    let platform = platform().ok_or_else(|| format!("FMI has no name for {ARCH}-{OS}"))?;
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let library = format!("{name}{DLL_SUFFIX}");
    run(&compiler, entries, folder.path(), &library)?;
    let content = fs::read(folder.path().join(&library)).map_err(|error| error.to_string())?;
    Ok(Entry { path: format!("binaries/{platform}/{library}"), content })
}

/// This platform, as FMI calls it.
fn platform() -> Option<String> {
    let system = match OS {
        "linux" => "linux",
        "macos" => "darwin",
        "windows" => "windows",
        _ => return None,
    };
    matches!(ARCH, "x86" | "x86_64" | "aarch64").then(|| format!("{ARCH}-{system}"))
}

fn run(compiler: &OsString, entries: &[Entry], folder: &Path, library: &str) -> Result<(), String> {
    let mut sources = Vec::new();
    for entry in entries {
        let Some(file) = entry.path.strip_prefix("sources/") else { continue };
        fs::write(folder.join(file), &entry.content).map_err(|error| error.to_string())?;
        if Path::new(file).extension().is_some_and(|ending| ending == "c") {
            sources.push(file);
        }
    }
    let shown = compiler.to_string_lossy();
    let done = Command::new(compiler)
        .args(["-std=c99", "-O2", "-shared", "-fPIC", "-fvisibility=hidden", "-o", library])
        .args(sources)
        .arg("-lm")
        .current_dir(folder)
        .output();
    let done = done.map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => format!("there is no C compiler `{shown}`; CC names another"),
        _ => format!("`{shown}`: {error}"),
    })?;
    if done.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&done.stderr);
    Err(format!("`{shown}` says: {}", said.lines().next().unwrap_or_default()))
}
