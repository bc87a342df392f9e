//! Modules import downward only: the order is part of the design.
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::fs;
use std::path::{Path, PathBuf};

/// The library's modules; each may use those before it.
const ORDER: [&str; 15] = [
    "units",
    "statistics",
    "effect",
    "filter",
    "experiment",
    "delay",
    "model",
    "synthetic",
    "fit",
    "diagnosis",
    "explain",
    "design",
    "batch",
    "report",
    "recording",
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The library module that a file belongs to.
fn module(path: &Path) -> Option<usize> {
    let inside = path.strip_prefix("src").unwrap();
    let first = inside.components().next()?.as_os_str().to_string_lossy().into_owned();
    ORDER.iter().position(|module| *module == first.trim_end_matches(".rs"))
}

/// The library modules that a file's `use crate::…` lines name.
fn imports(text: &str) -> Vec<usize> {
    let paths = text.match_indices("crate::").map(|(start, found)| &text[start + found.len()..]);
    let names = paths.map(|path| path.split(|c: char| !c.is_alphanumeric() && c != '_').next());
    names.filter_map(|name| ORDER.iter().position(|module| Some(*module) == name)).collect()
}

/// Imports that go upward, as sentences.
fn upward(path: &Path, text: &str) -> Vec<String> {
    let Some(own) = module(path) else { return Vec::new() };
    let wrong = imports(text).into_iter().filter(|import| *import > own);
    wrong.map(|import| format!("{} imports {}", path.display(), ORDER[import])).collect()
}

#[test]
fn no_module_imports_upward() {
    let files = sources(Path::new("src"));
    assert!(files.len() > 30);
    let wrong: Vec<_> =
        files.iter().flat_map(|path| upward(path, &fs::read_to_string(path).unwrap())).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn an_upward_import_would_be_seen() {
    let fault = "use crate::delay::Settings;";
    assert_eq!(upward(Path::new("src/experiment/read.rs"), fault).len(), 1);
    assert_eq!(upward(Path::new("src/batch.rs"), fault).len(), 0);
}

#[test]
fn each_library_is_named_in_its_own_place_only() {
    for (library, place) in [
        ("rayon", "src/batch.rs"),
        ("rerun", "src/recording"),
        ("sci_rs", "src/filter.rs"),
        ("statrs", "src/statistics"),
        ("levenberg_marquardt", "src/fit"),
        ("winnow", "src/effect/expression"),
        ("toml_edit", "src/model/file"),
        ("ctrlc", "src/cli/interrupt.rs"),
        ("plotters", "src/report/page/plot.rs"),
        ("flate2", "src/experiment/format/mat"),
        ("hdf5_pure", "src/experiment/format/mat"),
        ("mcap", "src/experiment/format"),
        ("re_cdr", "src/experiment/format/mcap"),
        ("re_ros_msg", "src/experiment/format/mcap"),
    ] {
        for path in sources(Path::new("src")) {
            let text = fs::read_to_string(&path).unwrap();
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
            let named = code.clone().any(|line| line.contains(&format!("{library}::")));
            assert!(!named || path.starts_with(place), "{} names {library}", path.display());
        }
    }
}
