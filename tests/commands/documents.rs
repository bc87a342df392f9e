//! What the documents say is true: commands run as printed and print what is printed.

use std::fs;
use std::path::Path;
use std::process::Command;

/// The blocks of `text` that are fenced as `language`.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    let starts = text.match_indices(&fence).map(|(start, _)| start + fence.len());
    starts.map(|start| text[start..].split("```").next().unwrap().to_owned()).collect()
}

#[test]
fn the_readme_has_two_commands_and_the_first_prints_its_table() {
    let readme = fs::read_to_string("README.md").unwrap();
    let commands = blocks(&readme, "sh");
    assert_eq!(commands.len(), 2);
    assert_eq!(commands[1].trim(), "cargo test --release");
    let arguments = commands[0].trim().strip_prefix("cargo run --release -- ").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let arguments = arguments.replace("manipulator.rrd", "recording");
    let file = folder.path().join("recording");
    let mut arguments: Vec<String> = arguments.split(' ').map(str::to_owned).collect();
    if cfg!(feature = "rrd") {
        *arguments.last_mut().unwrap() = file.to_str().unwrap().to_owned();
    } else {
        arguments.truncate(arguments.len() - 2);
    }
    let output = Command::new(env!("CARGO_BIN_EXE_tauscope")).args(&arguments).output().unwrap();
    assert!(output.status.success());
    assert_eq!(file.exists(), cfg!(feature = "rrd"));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(blocks(&readme, "text"), [printed]);
}

#[test]
fn commands_in_the_documents_print_what_is_printed() {
    let cases = trycmd::TestCases::new();
    cases.case("docs/*.md");
    // What is said last of a file counts.
    if !cfg!(feature = "mcap") {
        // Not `eprintln`, which the test runner keeps to itself.
        let mut terminal = std::io::stderr();
        std::io::Write::write_all(
            &mut terminal,
            b"docs/formats.md is skipped: it needs the feature `mcap`\n",
        )
        .unwrap();
        cases.skip("docs/formats.md");
    }
}

#[test]
fn the_effect_shown_is_the_one_that_is_run() {
    let shown = blocks(&fs::read_to_string("docs/model_files.md").unwrap(), "toml");
    let run = fs::read_to_string("tests/cli/own_effect.toml").unwrap();
    assert!(shown.iter().any(|shown| run.ends_with(shown)));
}

/// Every source file below `folder`.
fn sources(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let files = files.into_iter().filter(|path| path.extension().is_some_and(|e| e == "rs"));
    files.chain(folders.iter().flat_map(|folder| sources(folder))).collect()
}

/// Docs of a source that lean on what is documented before them: each is read by itself.
fn leaning_docs(text: &str) -> Vec<&str> {
    let lines: Vec<&str> = text.lines().map(str::trim_start).collect();
    let doc = |line: &str| {
        let words = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
        words.map(|words| words.trim().to_owned())
    };
    let begins = |index: usize| {
        let before = index.checked_sub(1).and_then(|before| doc(lines[before]));
        let own = doc(lines[index]);
        before.is_none_or(|before| before.is_empty())
            && own.is_some_and(|own| own == "The same" || own.starts_with("The same "))
    };
    (0..lines.len()).filter(|index| begins(*index)).map(|index| lines[index]).collect()
}

#[test]
fn docs_of_the_source_stand_alone() {
    let files = sources(Path::new("src"));
    assert!(files.len() > 100);
    for path in files {
        let text = fs::read_to_string(&path).unwrap();
        assert_eq!(leaning_docs(&text), [""; 0], "{}", path.display());
    }
    let fault = "/// A mean.\nfn mean() {}\n/// The same of a slice.\nfn of() {}";
    assert_eq!(leaning_docs(fault), ["/// The same of a slice."]);
    assert_eq!(leaning_docs("/// Whether both are of\n/// The same kind."), [""; 0]);
}

#[test]
fn every_link_of_the_documents_leads_somewhere() {
    let folders = [".", "docs", "data", "benches"];
    for folder in folders {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|extension| extension != "md") {
                continue;
            }
            let text = fs::read_to_string(&path).unwrap();
            for (start, _) in text.match_indices("](") {
                let link = text[start + 2..].split(')').next().unwrap();
                if !link.starts_with("http") {
                    assert!(leads_somewhere(&path, link), "{} links to {link}", path.display());
                }
            }
        }
    }
}

/// Whether a page has what it links to: a file, or a heading in one.
fn leads_somewhere(page: &Path, link: &str) -> bool {
    let (file, heading) = link.split_once('#').map_or((link, None), |(f, h)| (f, Some(h)));
    let target = if file.is_empty() { page.to_owned() } else { page.parent().unwrap().join(file) };
    let Some(heading) = heading else { return target.exists() };
    let anchor = |line: &str| {
        let title = line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
        title.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect::<String>()
    };
    let text = fs::read_to_string(&target).unwrap_or_default();
    text.lines().filter(|line| line.starts_with('#')).any(|line| anchor(line) == heading)
}

/// `docs/glossary.md` has the terms that other pages define at their end; with `TRYCMD=overwrite` it is
/// made anew.
#[test]
fn the_glossary_is_made_of_the_terms_of_all_pages() {
    let pages = fs::read_dir("docs").unwrap().map(|entry| entry.unwrap().path());
    let pages = pages.filter(|page| page.extension().is_some_and(|ending| ending == "md"));
    let mut terms: Vec<String> = Vec::new();
    for page in pages {
        let text = fs::read_to_string(page).unwrap();
        let Some((_, end)) = text.split_once("\n## Terms\n\n") else { continue };
        terms.extend(end.trim_end().split("\n\n").map(str::to_owned));
    }
    terms.sort_by_key(|term| term.trim_start_matches("**").to_lowercase());
    assert!((30..=40).contains(&terms.len()), "{} terms", terms.len());
    assert!(terms.iter().all(|term| term.starts_with("**")), "{terms:?}");
    let made = format!("# Glossary\n\n{}\n", terms.join("\n\n"));
    if std::env::var("TRYCMD").is_ok_and(|how| how == "overwrite") {
        fs::write("docs/glossary.md", &made).unwrap();
    }
    assert_eq!(fs::read_to_string("docs/glossary.md").unwrap(), made);
}

#[test]
fn every_example_is_in_the_readme() {
    let readme = fs::read_to_string("README.md").unwrap();
    for entry in fs::read_dir("examples").unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(readme.contains(&format!("examples/{name}")), "{name}");
    }
}

/// What the tutorial says in its own words at the end is what the program printed before.
#[test]
fn figures_of_the_tutorial_are_those_that_were_printed() {
    let text = fs::read_to_string("docs/tutorial.md").unwrap();
    let (before, end) = text.split_once("## What it was").unwrap();
    let printed: Vec<&str> = before.lines().filter(|line| line.starts_with("  ")).collect();
    let number = |text: &str| -> f64 { text.split([' ', ',']).next().unwrap().parse().unwrap() };
    for row in end.lines().filter(|line| line.contains(" ± ")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let (value, error) = cells[3].split_once(" ± ").unwrap();
        let last_digit =
            10_f64.powi(-i32::try_from(value.split('.').nth(1).unwrap().len()).unwrap());
        let full = format!("{} ", cells[1]);
        let agrees = printed.iter().any(|line| {
            let Some((_, found)) = line.split_once(&full) else { return false };
            let Some((_, found_error)) = found.split_once(" ± ") else { return false };
            // A word of a sentence is no value.
            let is_value = found.starts_with(|c: char| c.is_ascii_digit() || c == '-');
            is_value
                && (number(found) - number(value)).abs() <= last_digit
                && (number(found_error) - number(error)).abs() <= last_digit
        });
        assert!(agrees, "{row}");
    }
    // The guess, and what is left of it.
    let of_guess = |count: usize| {
        let after = before.match_indices("direction_gain: negative_factor ").nth(count).unwrap();
        number(&before[after.0 + after.1.len()..])
    };
    let said = format!("was {:.2} and is {:.3} ±", of_guess(0), of_guess(1));
    assert!(before.contains(&said), "{said}");
}
