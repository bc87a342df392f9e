//! The folder of results: a file per log, written when the log is done.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use crate::report::folder::LogResult;
use anyhow::{Context as _, bail};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest as _, Sha256};

use crate::cli::output::write_file;

const SCHEMA: &str = "tauscope/result/1";

/// What is kept of a log.
#[derive(Debug, Default, Deserialize, Serialize)]
pub(crate) struct Kept {
    pub(super) schema: String,
    pub(super) version: String,
    pub(crate) command: String,
    /// The log, as it was given.
    pub(crate) file: String,
    /// Logs that were given in all.
    pub(crate) of: usize,
    /// The options, as they were given.
    pub(super) settings: String,
    /// Stands for the bytes of the log, the settings and the version.
    pub(crate) key: String,
    /// What the command said in JSON.
    pub(crate) document: Value,
}

impl Kept {
    /// Of `log`, which was worked on by this version of the program.
    pub(crate) fn of(log: &Path, document: Value) -> Self {
        let (schema, version) = (SCHEMA.to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        let file = text_of(log.as_os_str());
        Self { schema, version, file, document, ..Self::default() }
    }

    /// The result of a log, where there is one.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let name = path.display();
        // A pipe would be waited for, and a device has no end.
        if path.metadata().is_ok_and(|found| !found.is_file()) {
            bail!("{name}: a result must be a file, and this is none; remove it");
        }
        let text = std::fs::read(path).with_context(|| format!("{name}: cannot be read"))?;
        let kept: Self = serde_json::from_slice(&text)
            .with_context(|| format!("{name}: not a result of tauscope; remove it"))?;
        if kept.schema != SCHEMA {
            bail!("{name}: not a result of tauscope ({}); remove it", kept.schema);
        }
        Ok(kept)
    }

    pub(crate) fn write(&self, path: &Path) -> anyhow::Result<()> {
        check_own_file(path)?;
        write_file(path, |file| Ok(serde_json::to_writer(file, self)?))
    }

    /// What it is of: documents of many logs are large.
    pub(super) fn without_document(self) -> Self {
        Self { document: Value::Null, ..self }
    }

    /// The result, for the tables.
    pub(crate) fn result(self) -> LogResult {
        LogResult { file: self.file, document: self.document }
    }
}

/// Whether a file holds JSON of another program, which is nobody's result: not even a damaged one.
pub(crate) fn is_foreign(path: &Path) -> bool {
    let is_file = path.metadata().is_ok_and(|found| found.is_file());
    let text = if is_file { std::fs::read(path).unwrap_or_default() } else { Vec::new() };
    let is_result = |document: &Value| {
        let schema = document.get("schema").and_then(Value::as_str);
        schema.is_some_and(|schema| schema.starts_with("tauscope/result/"))
    };
    serde_json::from_slice(&text).is_ok_and(|document| !is_result(&document))
}

/// Refuses what is not a file of its own under the name of a result: it may lead to a log, or be a pipe
/// that nobody reads.
pub(crate) fn check_own_file(path: &Path) -> anyhow::Result<()> {
    if path.symlink_metadata().is_ok_and(|found| !found.is_file()) {
        bail!("{}: a result must be a file of its own; remove it", path.display());
    }
    Ok(())
}

/// The name of a log's file in the folder, without its ending: readable, and its own also
/// where logs of several folders have one name.
pub(crate) fn name_of(log: &Path) -> String {
    /// Bytes of the log's name that are shown: file systems allow 255 with what is added.
    const LONGEST: usize = 200;
    let name = text_of(log.file_name().unwrap_or_default());
    let stem = name.get(..name.floor_char_boundary(LONGEST)).unwrap_or_default();
    let hash = Sha256::digest(log.as_os_str().as_encoded_bytes());
    let hash = base16ct::lower::encode_string(&hash);
    format!("{stem}-{}", hash.get(..12).unwrap_or_default())
}

/// A name as text, of which there is only one: bytes that are no text are written as `\xff`.
pub(crate) fn text_of(name: &OsStr) -> String {
    let escaped = || name.as_encoded_bytes().escape_ascii().to_string();
    name.to_str().map_or_else(escaped, str::to_owned)
}

/// All results of some folders, by the names of their logs.
pub(crate) struct Merged {
    pub(crate) command: String,
    pub(crate) results: Vec<LogResult>,
    /// What is not as it should be.
    pub(crate) failures: Vec<String>,
    /// Files that are no results.
    pub(crate) notes: Vec<String>,
}

/// Reads all results of some folders.
pub(crate) fn read_folders(folders: &[PathBuf]) -> anyhow::Result<Merged> {
    // A result is told by the name of its file, too, which has a hash of the log's.
    let mut found: BTreeMap<(String, OsString), (PathBuf, Kept)> = BTreeMap::new();
    let (mut unread, mut foreign) = (Vec::new(), Vec::new());
    for path in results_in(folders)? {
        let kept = match Kept::read(&path) {
            Ok(kept) => kept,
            Err(_) if is_foreign(&path) => {
                foreign.push(format!("{}: no result of tauscope, and left alone", path.display()));
                continue;
            }
            Err(error) => {
                unread.push(format!("{error:#}"));
                continue;
            }
        };
        if kept.is_copied_to(&path) {
            let path = path.display();
            unread.push(format!("{path}: a copy of the result of {}; remove it", kept.file));
            continue;
        }
        let different = found.values().next().filter(|(_, first)| !first.is_like(&kept));
        if let Some((other, _)) = different {
            bail!(
                "{}: its command, settings or version differ from those of {}; merge results of \
                 one kind only",
                path.display(),
                other.display()
            );
        }
        let name = (kept.file.clone(), path.file_name().unwrap_or_default().to_owned());
        let twice = found.get(&name).filter(|(_, other)| other.key != kept.key);
        if let Some((other, _)) = twice {
            bail!(
                "{}: another result of {} is in {}; remove the older one",
                path.display(),
                kept.file,
                other.display()
            );
        }
        found.insert(name, (path, kept));
    }
    let of = found.values().map(|(_, kept)| kept.of).max().unwrap_or_default();
    let Some(command) = found.values().next().map(|(_, kept)| kept.command.clone()) else {
        if let Some(first) = unread.iter().chain(&foreign).next() {
            bail!("{first}");
        }
        bail!("no result in these folders; name the folders that were given to `--results`");
    };
    let missing = of.saturating_sub(found.len());
    let missing = (missing > 0).then(|| {
        format!("{missing} of {of} logs have no result yet; run the command again for them")
    });
    let results = found.into_values().map(|(_, kept)| kept.result()).collect();
    let failures = unread.into_iter().chain(missing).collect();
    Ok(Merged { command, results, failures, notes: foreign })
}

impl Kept {
    /// Whether it was made by this version of the program with these settings.
    pub(super) fn has(&self, settings: &str) -> bool {
        self.version == env!("CARGO_PKG_VERSION") && self.settings == settings
    }

    /// Whether a file is not called as the result of this log is.
    fn is_copied_to(&self, path: &Path) -> bool {
        // Of a log whose name is no text only the text is known.
        let is_text = !self.file.contains('\\');
        is_text && path.file_stem() != Some(OsStr::new(&name_of(Path::new(&self.file))))
    }

    fn is_like(&self, other: &Self) -> bool {
        self.command == other.command
            && self.settings == other.settings
            && self.version == other.version
    }
}

/// The files of results in some folders.
fn results_in(folders: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    files_in(folders, &["json"])
}

/// What a run over many logs keeps in `folders`, sorted: results and models.
///
/// # Errors
/// When a folder cannot be listed.
pub(crate) fn kept_in(folders: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    files_in(folders, &["json", "toml"])
}

/// The files in `folders` whose names have one of the `endings`, sorted.
fn files_in(folders: &[PathBuf], endings: &[&str]) -> anyhow::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for folder in folders {
        let unread = || format!("{}: cannot be read as a folder of results", folder.display());
        for entry in folder.read_dir().with_context(unread)? {
            files.push(entry.with_context(unread)?.path());
        }
    }
    let has_ending = |file: &PathBuf| {
        file.extension().is_some_and(|own| endings.iter().any(|ending| own == *ending))
    };
    files.retain(has_ending);
    files.sort();
    Ok(files)
}
