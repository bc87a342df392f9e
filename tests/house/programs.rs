//! Tests are few programs, and each of their files is part of one.

use std::fs;
use std::path::{Path, PathBuf};

/// Each takes seconds to link with recordings.
const MOST: usize = 8;

fn entries(folder: &str) -> Vec<PathBuf> {
    let mut entries: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    entries
}

fn is_source(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "rs")
}

/// The folders of `tests` that are a program each.
fn rooms() -> Vec<PathBuf> {
    entries("tests").into_iter().filter(|path| path.join("main.rs").exists()).collect()
}

#[test]
fn few_programs_are_linked() {
    let alone = entries("tests").into_iter().filter(|path| is_source(path)).count();
    let manifest: toml::Table = fs::read_to_string("Cargo.toml").unwrap().parse().unwrap();
    let examples = manifest["example"].as_array().unwrap();
    let tested =
        |example: &&toml::Value| example.get("test").is_some_and(|test| test == &true.into());
    // The unit tests of the library are one, too.
    let programs = 1 + alone + rooms().len() + examples.iter().filter(tested).count();
    assert!(rooms().len() > 1 && programs <= MOST, "{programs}");
}

#[test]
fn no_story_is_left_out() {
    for room in rooms() {
        let main = fs::read_to_string(room.join("main.rs")).unwrap();
        let stories = entries(room.to_str().unwrap()).into_iter().filter(|path| is_source(path));
        for story in stories.filter(|path| !path.ends_with("main.rs")) {
            let name = story.file_stem().unwrap().to_str().unwrap();
            let is_part = main.lines().any(|line| line == format!("mod {name};"));
            assert!(is_part, "{} is in no program", story.display());
        }
    }
}
