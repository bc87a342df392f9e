//! `tauscope doctor`: what is there to look at recordings with, and what is missing.

use std::env;
use std::fmt::Write as _;
use std::process::{Command, Stdio};

use clap::Args as ClapArgs;
use serde::Serialize;
use serde_json::json;

use crate::cli::args::Format;
use crate::cli::failure::Completion;
use crate::cli::viewer::{NEWEST, VERSION, installed, on_path};
use crate::report::json::document;

/// Check what is needed to make and view recordings, and say what is missing
///
/// It looks for the Rerun viewer and its version, for a screen, and at this program; each line that
/// is not `ok` names the remedy. Exit status 1 when something is missing.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let checks = [
        ("program", program()),
        ("viewer", viewer()),
        ("importer", importer()),
        ("screen", screen()),
    ];
    let checks = checks.map(|(name, found)| Check { name, found });
    let complete = checks.iter().all(|check| check.found.state != State::Missing);
    let facts = || json!({ "complete": complete, "checks": checks });
    args.format.print(|| text(&checks), || document("tauscope/doctor/1", facts()))?;
    Ok(if complete { Completion::Whole } else { Completion::Partial })
}

fn text(checks: &[Check]) -> String {
    let mut text = String::new();
    let width = checks.iter().map(|check| check.name.len()).max().unwrap_or(0);
    for Check { name, found: Finding { state, found, remedy } } in checks {
        let state = format!("{state:?}").to_lowercase();
        writeln!(text, "{state:<7}  {name:<width$}  {found}").unwrap_or_default();
        if let Some(remedy) = remedy {
            writeln!(text, "{:9}{:width$}  → {remedy}", "", "").unwrap_or_default();
        }
    }
    text
}

/// How well a thing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum State {
    /// As it should be.
    Ok,
    /// Work goes on without it.
    Note,
    /// Something cannot be done without it.
    Missing,
}

/// What was found of one thing, and what to do where it is not as it should be.
#[derive(Debug, Serialize)]
struct Finding {
    state: State,
    found: String,
    remedy: Option<String>,
}

/// What was found, by the name of the thing.
#[derive(Debug, Serialize)]
struct Check {
    name: &'static str,
    #[serde(flatten)]
    found: Finding,
}

fn ok(found: impl Into<String>) -> Finding {
    Finding { state: State::Ok, found: found.into(), remedy: None }
}

fn note(found: impl Into<String>, remedy: impl Into<String>) -> Finding {
    Finding { state: State::Note, ..missing(found, remedy) }
}

fn missing(found: impl Into<String>, remedy: impl Into<String>) -> Finding {
    Finding { state: State::Missing, found: found.into(), remedy: Some(remedy.into()) }
}

/// What of this program was built.
fn program() -> Finding {
    let found = format!("tauscope {}", env!("CARGO_PKG_VERSION"));
    if cfg!(feature = "rrd") {
        return ok(format!("{found}, with recordings (feature `rrd`)"));
    }
    let found = format!("{found}, without recordings");
    missing(found, "build it with feature `rrd`, which is on unless switched off")
}

fn is_set(name: &str) -> bool {
    env::var_os(name).is_some_and(|value| !value.is_empty())
}

fn screen() -> Finding {
    if !cfg!(target_os = "linux") {
        return ok("the system's own");
    }
    if let Some(name) = ["WAYLAND_DISPLAY", "DISPLAY"].into_iter().find(|name| is_set(name)) {
        return ok(format!("{name} is set"));
    }
    missing(
        "neither WAYLAND_DISPLAY nor DISPLAY is set: the viewer has no screen here",
        "copy recordings to a machine with a screen, or run `rerun --web-viewer FILE.rrd` here \
         and open its address there",
    )
}

/// What puts the right viewer on a machine.
fn remedy() -> String {
    format!("pip install rerun-sdk=={VERSION}")
}

fn importer() -> Finding {
    if let Some(place) = installed() {
        return ok(format!("{}: `rerun LOG.csv` opens a log", place.display()));
    }
    let found = "`rerun LOG.csv` does not open logs";
    note(found, "`tauscope importer --install` lets it")
}

fn viewer() -> Finding {
    if let Some(path) = on_path("rerun", env::var_os("PATH").as_deref()) {
        let place = path.display();
        let answer = output(Command::new(&path).arg("--version").env("RERUN_ANALYTICS", "0"));
        return match answer.as_deref().and_then(version_in) {
            None => {
                let found = format!("{place} does not report its version");
                missing(found, remedy())
            }
            Some(version) => judged(version, &format!("rerun {version}, {place}")),
        };
    }
    missing("no `rerun` on PATH", remedy())
}

/// Whether `version` fits: an older minor version does not.
fn judged(version: &str, found: &str) -> Finding {
    if [VERSION, NEWEST].contains(&version) {
        return ok(found);
    }
    let made = format!("recordings are made for {VERSION} and were looked at in {NEWEST}");
    let found = format!("{found}; {made}");
    if minor(version) >= minor(VERSION) { note(found, remedy()) } else { missing(found, remedy()) }
}

/// The first two numbers of a version.
fn minor(version: &str) -> Option<(u32, u32)> {
    let mut numbers = version.split('.').map(|number| number.parse().ok());
    numbers.next().flatten().zip(numbers.next().flatten())
}

/// What a command prints, if it ends well.
fn output(command: &mut Command) -> Option<String> {
    let output = command.stdin(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The first word of `text` that looks like a version.
fn version_in(text: &str) -> Option<&str> {
    let is_version = |word: &&str| {
        word.split('.').count() >= 3 && word.starts_with(|first: char| first.is_ascii_digit())
    };
    text.split_whitespace().find(is_version)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_thing_has_a_line_and_what_is_missing_a_remedy() {
        let found = [("screen", ok("2")), ("viewer", missing("none", "install it"))];
        let checks = found.map(|(name, found)| Check { name, found });
        let text = anstream::adapter::strip_str(&text(&checks)).to_string();
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        assert_eq!(
            lines,
            ["ok       screen  2", "missing  viewer  none", "                 → install it"]
        );
    }

    #[test]
    fn a_version_is_found_and_judged_by_its_minor_number() {
        assert_eq!(version_in("rerun-cli 0.36.3 (base) [rustc 1.95.0"), Some("0.36.3"));
        assert_eq!(version_in("no version"), None);
        let state = |version| judged(version, "").state;
        assert_eq!(state(VERSION), State::Ok);
        assert_eq!(state(NEWEST), State::Ok);
        assert_eq!(state("0.36.9"), State::Note);
        assert_eq!(state("0.99.0"), State::Note);
        assert_eq!(state("0.35.0"), State::Missing);
    }
}
