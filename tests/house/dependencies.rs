//! What the dependencies may be, as `deny.toml` says, and that each is built once.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use serde_json::Value;

/// The table `deny.toml`.
fn policy() -> toml::Table {
    fs::read_to_string("deny.toml").unwrap().parse().unwrap()
}

/// All packages that this system builds of the project, with all features.
fn packages() -> Vec<Value> {
    let said = Command::new(env!("CARGO")).arg("-vV").output().unwrap();
    let said = String::from_utf8(said.stdout).unwrap();
    let host = said.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let mut command = Command::new(env!("CARGO"));
    command.args(["metadata", "--format-version", "1", "--locked", "--all-features"]);
    let output = command.args(["--filter-platform", host]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let known: Value = serde_json::from_slice(&output.stdout).unwrap();
    known["packages"].as_array().unwrap().clone()
}

/// Whether one of the licences that an SPDX expression offers is among those allowed; an older
/// expression has `/` for `OR`.
fn is_allowed(expression: &str, allowed: &[String]) -> bool {
    let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
    let spaced = spaced.replace(" WITH ", "+WITH+");
    let words: Vec<String> =
        spaced.split_whitespace().map(|word| word.replace("+WITH+", " WITH ")).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let mut words = words.into_iter().peekable();
    let found = any(&mut words, allowed);
    assert_eq!(words.next(), None, "{expression}");
    found
}

/// The words of an expression.
type Words<'w> = std::iter::Peekable<std::vec::IntoIter<&'w str>>;

fn any(words: &mut Words<'_>, of: &[String]) -> bool {
    let mut found = every(words, of);
    while words.next_if_eq(&"OR").is_some() {
        found |= every(words, of);
    }
    found
}

fn every(words: &mut Words<'_>, of: &[String]) -> bool {
    let mut found = one(words, of);
    while words.next_if_eq(&"AND").is_some() {
        found &= one(words, of);
    }
    found
}

fn one(words: &mut Words<'_>, of: &[String]) -> bool {
    if words.next_if_eq(&"(").is_none() {
        let word = words.next().unwrap();
        return of.iter().any(|allowed| allowed == word);
    }
    let mut depth = 1;
    let inner = words.by_ref().take_while(|word| {
        depth += i32::from(*word == "(") - i32::from(*word == ")");
        depth > 0
    });
    let inner: Vec<&str> = inner.collect();
    any(&mut inner.into_iter().peekable(), of)
}

#[test]
fn each_dependency_has_a_licence_that_is_allowed() {
    let policy = policy();
    let allowed: Vec<String> = policy["licenses"]["allow"].clone().try_into().unwrap();
    let packages = packages();
    assert!(packages.len() > 100);
    for package in packages {
        let licence = package["license"].as_str().unwrap_or_default();
        assert!(is_allowed(licence, &allowed), "{}: `{licence}`", package["name"]);
    }
}

#[test]
fn each_dependency_comes_from_the_registry_and_none_is_banned() {
    let policy = policy();
    let banned = policy["bans"]["deny"].as_array().unwrap();
    let banned: Vec<&str> = banned.iter().map(|ban| ban["crate"].as_str().unwrap()).collect();
    assert!(!banned.is_empty());
    let lock: toml::Table = fs::read_to_string("Cargo.lock").unwrap().parse().unwrap();
    for package in lock["package"].as_array().unwrap() {
        let name = package["name"].as_str().unwrap();
        assert!(!banned.contains(&name), "{name}");
        let own = ["tauscope", "tauscope-python", "tauscope-synthetic"].contains(&name);
        let source = package.get("source").and_then(toml::Value::as_str);
        let registry = (!own).then_some("registry+https://github.com/rust-lang/crates.io-index");
        assert_eq!(source, registry, "{name}");
    }
    for path in ["Cargo.toml", "crates/synthetic/Cargo.toml"] {
        let manifest: toml::Table = fs::read_to_string(path).unwrap().parse().unwrap();
        let kinds =
            ["dependencies", "dev-dependencies"].iter().filter_map(|kind| manifest.get(*kind));
        for (name, asked) in kinds.flat_map(|kind| kind.as_table().unwrap()) {
            let version = asked.get("version").unwrap_or(asked).as_str();
            assert!(version.is_some_and(|version| version != "*"), "{name}");
        }
    }
}

/// The packages of `cargo tree`, a line each with version and features.
fn tree(arguments: &[&str]) -> BTreeSet<String> {
    let mut command = Command::new(env!("CARGO"));
    command.args(["tree", "--locked", "--prefix", "none", "--format", "{p} {f}"]);
    let output = command.args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| line.trim_end_matches(" (*)").to_owned())
        .collect()
}

/// A dependency that tests, or the package for Python, ask for with further features is built a
/// second time, and with it all that uses it.
#[test]
fn no_dependency_of_the_program_is_built_twice() {
    let program = tree(&["--edges", "normal,build", "--package", "tauscope"]);
    assert!(program.len() > 100);
    let tests = tree(&["--edges", "normal,build,dev", "--package", "tauscope"]);
    let python = tree(&["--edges", "normal,build", "--package", "tauscope-python"]);
    for (user, packages) in [("tests", &tests), ("the package for Python", &python)] {
        let own = |line: &&String| line.starts_with("tauscope v");
        let twice: Vec<_> = program.difference(packages).filter(|line| !own(line)).collect();
        assert!(twice.is_empty(), "{user}: {twice:#?}");
    }
}

#[test]
fn an_expression_of_licences_is_understood() {
    let allowed = ["MIT", "ISC", "Apache-2.0 WITH LLVM-exception"].map(str::to_owned);
    for good in ["MIT", "GPL-3.0 OR MIT", "GPL-3.0/MIT", "(GPL-3.0 OR MIT) AND ISC"] {
        assert!(is_allowed(good, &allowed), "{good}");
    }
    assert!(is_allowed("Apache-2.0 WITH LLVM-exception", &allowed));
    for bad in ["GPL-3.0", "MIT AND GPL-3.0", "(GPL-3.0 OR ISC) AND Apache-2.0"] {
        assert!(!is_allowed(bad, &allowed), "{bad}");
    }
}
