//! The program `rerun`: its version, where it is found; and this program as an importer of it, so that
//! `rerun LOG.csv` opens the recording of the log.
//!
//! The viewer asks every program on `PATH` whose name begins with `rerun-importer-` about each file
//! that it is to open. Such a program gets the path as its argument, writes a recording to standard
//! output, and ends with a status of its own where the file is none of its formats. See
//! <https://rerun.io/docs/concepts/logging-and-ingestion/importers/overview>.

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// The version of the viewer that recordings are made for: an older one does not read them for
/// certain.
pub(crate) const VERSION: &str = "0.36.3";

/// The newest version of the viewer in which recordings were looked at, and were right.
pub(crate) const NEWEST: &str = "0.41.0";

/// Where the viewer listens unless another port is given.
pub(crate) const PORT: u16 = 9876;

/// The program `name` in the folders of `path`.
pub(crate) fn on_path(name: &str, path: Option<&OsStr>) -> Option<PathBuf> {
    let name = format!("{name}{}", env::consts::EXE_SUFFIX);
    let mut places = env::split_paths(path?).map(|folder| folder.join(&name));
    places.find(|place| is_program(place))
}

#[cfg(unix)]
fn is_program(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt as _;
    path.metadata().is_ok_and(|found| found.is_file() && found.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
fn is_program(path: &Path) -> bool {
    path.is_file()
}

/// The name under which the viewer calls this program.
pub(crate) const IMPORTER: &str = "rerun-importer-tauscope";

/// The exit status by which an importer declines a file.
pub(crate) const DECLINED: u8 = 66;

/// Where the viewer finds the importer.
pub(crate) fn installed() -> Option<PathBuf> {
    on_path(IMPORTER, env::var_os("PATH").as_deref())
}

/// The file that the viewer asks about, where it has called this program as an importer. The
/// identity of a recording that others may write to, and whatever else it passes, is not used: a
/// recording of this program is one of its own.
pub(crate) fn asked_about(mut arguments: impl Iterator<Item = OsString>) -> Option<PathBuf> {
    let called = arguments.next()?;
    let name = Path::new(&called).file_stem()?;
    if name != IMPORTER {
        return None;
    }
    // Options come with their values after them, the file before or after them.
    let mut file = None;
    while let Some(argument) = arguments.next() {
        let text = argument.to_string_lossy().into_owned();
        if !text.starts_with("--") {
            file = file.or(Some(argument));
        } else if !text.contains('=') && !FLAGS.contains(&text.as_str()) {
            arguments.next();
        }
    }
    Some(file.unwrap_or_default().into())
}

/// Options of an importer without a value.
const FLAGS: [&str; 2] = ["--static", "--timeless"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_the_one_that_the_library_has() {
        let manifest = include_str!("../../../Cargo.toml");
        assert!(manifest.contains(&format!("rerun = {{ version = \"{VERSION}\"")));
    }

    #[test]
    fn a_program_is_found_in_the_folders_of_a_path() {
        let path = env::var_os("PATH").unwrap();
        assert!(on_path("cargo", Some(&path)).is_some());
        assert_eq!(on_path("no-such-program-here", Some(&path)), None);
    }

    fn asked(arguments: &str) -> Option<PathBuf> {
        asked_about(arguments.split(' ').map(OsString::from))
    }

    #[test]
    fn the_file_is_found_among_what_a_viewer_passes() {
        let log = Some(PathBuf::from("a/log.csv"));
        let called = format!("/usr/bin/{IMPORTER}");
        let options = "--recording-id x --application-id y --static --time_sequence=frame=3";
        assert_eq!(asked(&format!("{called} a/log.csv {options}")), log);
        assert_eq!(asked(&format!("{called} {options} a/log.csv")), log);
        assert_eq!(asked("tauscope estimate a/log.csv"), None);
        assert_eq!(asked(&called), Some(PathBuf::new()), "no file at all");
    }
}
