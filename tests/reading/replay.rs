//! What the fuzzer begins from, and what it found, on any compiler: all of it is read or
//! refused. How they came about is said in `fuzz/README.md`.

use crate::attempts;
use std::fs;
use std::path::Path;

/// The targets of the fuzzer, and what each does with bytes.
type Target = (&'static str, fn(&[u8]) -> bool);

const TARGETS: &[Target] = &[
    ("columns", attempts::columns),
    ("csv", |bytes| attempts::log("log.csv", bytes)),
    ("expression", attempts::expression),
    #[cfg(feature = "mat")]
    ("mat5", |bytes| attempts::log("log.mat", bytes)),
    #[cfg(feature = "mat")]
    ("mat73", |bytes| attempts::log("log.mat", bytes)),
    #[cfg(feature = "mcap")]
    ("mcap", |bytes| attempts::log("log.mcap", bytes)),
    ("model", attempts::model),
    #[cfg(feature = "parquet")]
    ("parquet", |bytes| attempts::log("log.parquet", bytes)),
    ("plant", attempts::plant),
    ("review", attempts::review),
    #[cfg(feature = "xlsx")]
    ("xlsx", |bytes| attempts::log("log.xlsx", bytes)),
];

/// The files of a target, by name.
fn files(folder: &str, target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new("fuzz").join(folder).join(target);
    let entries = folder.read_dir().into_iter().flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| (path.display().to_string(), fs::read(path).unwrap())).collect()
}

#[test]
fn each_seed_is_read() {
    for (target, attempt) in TARGETS {
        let seeds = files("seeds", target);
        assert!(!seeds.is_empty(), "{target} has no seeds");
        for (name, bytes) in seeds {
            assert!(attempt(&bytes), "{name} is refused");
        }
    }
}

#[test]
fn what_was_found_is_read_or_refused() {
    for (target, attempt) in TARGETS {
        for (name, bytes) in files("found", target) {
            let done = std::panic::catch_unwind(|| attempt(&bytes));
            assert!(done.is_ok(), "{name}");
        }
    }
}
