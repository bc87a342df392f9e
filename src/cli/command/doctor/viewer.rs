//! The Rerun viewer: where it is, and of which version.

use std::io::Read as _;
use std::net::{Ipv4Addr, SocketAddr};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::check::{Check, Found, missing, note, ok};
use crate::cli::viewer::{NEWEST, PORT, VERSION, installed, is_listening, on_path};

/// Longest time that a program may take to report its version.
const PATIENCE: Duration = Duration::from_secs(10);

/// What puts the right viewer on a machine.
fn remedy() -> String {
    format!("pip install rerun-sdk=={VERSION}")
}

/// The viewer, whether one is running, and whether it opens logs.
pub(crate) fn check() -> Vec<Check> {
    let all = [("viewer", viewer()), ("running", running()), ("importer", importer())];
    all.map(|(name, found)| Check { name, found }).into()
}

fn importer() -> Found {
    if let Some(place) = installed() {
        return ok(format!("{}: `rerun LOG.csv` opens a log", place.display()));
    }
    let found = "`rerun LOG.csv` does not open logs";
    note(found, "`tauscope importer --install` lets it")
}

fn viewer() -> Found {
    if let Some(path) = on_path("rerun", std::env::var_os("PATH").as_deref()) {
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
    let ask = "import importlib.metadata as m; print(m.version('rerun-sdk'))";
    for python in ["python3", "python"] {
        let answer = output(Command::new(python).args(["-c", ask]));
        if let Some(version) = answer.as_deref().and_then(version_in) {
            let found = format!("rerun-sdk {version} of {python}, not on PATH");
            let check = judged(version, &found);
            let remedy = format!("start it with: {python} -m rerun FILE.rrd");
            return Found { remedy: check.remedy.or(Some(remedy)), ..check };
        }
    }
    missing("no `rerun` on PATH, no package `rerun-sdk` of python3", remedy())
}

/// Whether `version` fits: an older minor version does not.
fn judged(version: &str, found: &str) -> Found {
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

fn running() -> Found {
    if is_listening(SocketAddr::from((Ipv4Addr::LOCALHOST, PORT))) {
        return ok(format!("something listens on port {PORT}, where viewers do"));
    }
    let found = format!("no viewer listens on port {PORT}");
    note(found, "`--spawn` starts one; `--connect` needs one: start it with: rerun")
}

/// What a command prints, if it ends well and in time.
fn output(command: &mut Command) -> Option<String> {
    let quiet = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = quiet.spawn().ok()?;
    if !ends_well(&mut child) {
        child.kill().unwrap_or_default();
        child.wait().ok()?;
        return None;
    }
    let mut text = String::new();
    child.stdout?.read_to_string(&mut text).ok()?;
    Some(text)
}

/// Whether `child` ends with success before patience does.
fn ends_well(child: &mut Child) -> bool {
    let end = Instant::now() + PATIENCE;
    while Instant::now() < end {
        match child.try_wait() {
            Ok(Some(status)) => return status.success(),
            Ok(None) => std::thread::sleep(Duration::from_millis(20)),
            Err(_) => return false,
        }
    }
    false
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
    use super::super::check::State;
    use super::*;

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
