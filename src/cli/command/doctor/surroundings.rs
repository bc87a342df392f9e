//! This program, the screen, and the terminal.

use std::env;
use std::io::{self, IsTerminal as _};
use std::path::Path;

use super::check::{Check, Found, missing, note, ok};
use crate::cli::console;

/// What of this program was built.
pub(crate) fn program() -> Found {
    let found = format!("tauscope {}", env!("CARGO_PKG_VERSION"));
    if cfg!(feature = "rrd") {
        return ok(format!("{found}, with recordings (feature `rrd`)"));
    }
    let found = format!("{found}, without recordings");
    missing(found, "build it with feature `rrd`, which is on unless switched off")
}

/// Everything around the program, but for the viewer.
pub(crate) fn all() -> Vec<Check> {
    let all = [
        ("screen", screen()),
        ("graphics", graphics()),
        ("threads", threads()),
        ("folder", folder()),
        ("terminal", terminal()),
        ("letters", letters()),
    ];
    all.map(|(name, found)| Check { name, found }).into()
}

fn is_set(name: &str) -> bool {
    env::var_os(name).is_some_and(|value| !value.is_empty())
}

fn screen() -> Found {
    if !cfg!(target_os = "linux") {
        return ok("the system's own");
    }
    for name in ["WAYLAND_DISPLAY", "DISPLAY"] {
        if is_set(name) {
            let value = env::var_os(name).unwrap_or_default();
            return ok(format!("{name}={}", value.to_string_lossy()));
        }
    }
    missing(
        "neither WAYLAND_DISPLAY nor DISPLAY is set: the viewer has no screen here",
        "copy recordings to a machine with a screen, or run `rerun --web-viewer FILE.rrd` and \
         look from there",
    )
}

fn graphics() -> Found {
    if !cfg!(target_os = "linux") {
        return ok("the system's own");
    }
    if let Some(device) = first_in("/dev/dri", "renderD") {
        return ok(format!("/dev/dri/{device}"));
    }
    let drivers = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d"];
    if drivers.iter().any(|folder| first_in(folder, "").is_some()) {
        let found = "no device; a Vulkan driver draws in software";
        return note(found, "the viewer works, but slowly");
    }
    note(
        "neither a device nor a Vulkan driver",
        "the viewer in a browser (`rerun --web-viewer FILE.rrd`) needs none here; for its own \
         window install a driver, as in `apt install mesa-vulkan-drivers`",
    )
}

/// The first name in `folder` that starts like `prefix`.
fn first_in(folder: &str, prefix: &str) -> Option<String> {
    let entries = Path::new(folder).read_dir().ok()?.filter_map(Result::ok);
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.filter(|name| name.starts_with(prefix)).min()
}

fn threads() -> Found {
    match std::thread::available_parallelism() {
        Ok(number) => ok(number.to_string()),
        Err(error) => note(error.to_string(), "say how many with `--threads N`"),
    }
}

/// Whether results can be written where the program is.
fn folder() -> Found {
    let here = env::current_dir().unwrap_or_default();
    let here = here.display();
    match tempfile::Builder::new().prefix(".tauscope-").tempfile_in(".") {
        Ok(_) => ok(format!("{here} can be written to")),
        Err(error) => note(
            format!("{here} cannot be written to: {error}"),
            "give outputs a path elsewhere, as in `-o /tmp/log.rrd`",
        ),
    }
}

fn terminal() -> Found {
    let said = |is: bool| if is { "a terminal" } else { "no terminal" };
    let (out, err) = (io::stdout().is_terminal(), io::stderr().is_terminal());
    let colors = if console::has_colors() { "with colours" } else { "without colours" };
    let found = format!("output goes to {}, {colors}; messages to {}", said(out), said(err));
    if err {
        return ok(found);
    }
    note(found, "progress is shown where messages go to a terminal")
}

/// Whether the terminal is likely to show tables and Greek letters.
fn letters() -> Found {
    if cfg!(windows) {
        return ok("the system's own");
    }
    let set = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find(|name| is_set(name));
    let value = set.and_then(|name| env::var(name).ok()).unwrap_or_default();
    let plain = value.to_lowercase().replace('-', "");
    if plain.contains("utf8") {
        return ok(format!("{}={value}", set.unwrap_or_default()));
    }
    let found = match set {
        Some(name) => format!("{name}={value} is not UTF-8"),
        None => "none of LC_ALL, LC_CTYPE, LANG is set".to_owned(),
    };
    note(found, "where tables look broken, try: export LC_ALL=C.UTF-8")
}
