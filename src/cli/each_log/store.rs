//! The folder of results: a file per log, written when the log is done.

use std::ffi::OsStr;
use std::path::Path;

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
