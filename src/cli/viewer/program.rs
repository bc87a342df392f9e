//! The program `rerun`: its version, where it is found, and whether one listens.

use std::ffi::OsStr;
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
    let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    let mut places = std::env::split_paths(path?).map(|folder| folder.join(&name));
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
        let path = std::env::var_os("PATH").unwrap();
        assert!(on_path("cargo", Some(&path)).is_some());
        assert_eq!(on_path("no-such-program-here", Some(&path)), None);
    }
}
