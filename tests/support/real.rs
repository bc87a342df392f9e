//! Measured logs that are not part of this project: the folder that holds them is
//! `TAUSCOPE_REAL_LOGS`, or `../shared/data`.

use std::io::Write as _;
use std::path::PathBuf;

/// The path of a log, or `None` after saying that the test is skipped.
pub(crate) fn log(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("TAUSCOPE_REAL_LOGS");
    let folder = folder.map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    let path = folder.join(name);
    if path.exists() {
        return Some(path);
    }
    // Not `eprintln`, which the test runner keeps to itself.
    let mut stderr = std::io::stderr();
    writeln!(stderr, "skipped: {} is not here", path.display()).unwrap();
    None
}
