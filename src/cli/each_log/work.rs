//! What is to be done with each log: which are done, and this program on each of the others; and the folder
//! of results, a file per log, written when the log is done.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use anyhow::{Context as _, anyhow, bail};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest as _, Sha256};

use crate::cli::args::{DataArgs, RunArgs};
use crate::cli::console::{Bar, Verbosity};
use crate::cli::output::write_file;
use crate::cli::typed::Typed;
use crate::report::folder::LogResult;

/// What is to be done, and where results are kept.
pub(crate) struct Work<'a> {
    pub(crate) each: &'a Each<'a>,
    pub(crate) results: &'a Path,
    pub(crate) options: &'a LogOptions,
}

/// A log and what is known of it.
struct Known<'a> {
    log: &'a Path,
    /// Stands for all that its result depends on.
    key: anyhow::Result<String>,
    /// What is kept of it, but for the document.
    earlier: Option<Kept>,
}

impl Work<'_> {
    /// Works on each log that has no result yet: all results in the order of the logs, and messages on
    /// those that have none.
    pub(crate) fn run(&self, logs: &[&PathBuf]) -> anyhow::Result<(Vec<LogResult>, Vec<String>)> {
        let earlier =
            |log: &&PathBuf| Kept::read(&self.place(log)).ok().map(Kept::without_document);
        let earlier: Vec<Option<Kept>> = logs.iter().map(earlier).collect();
        self.check_command(&earlier)?;
        let known = logs.iter().zip(earlier);
        let known = known.map(|(log, earlier)| Known { log, key: self.key(log), earlier });
        let logs: Vec<Known<'_>> = known.collect();
        let open: Vec<&Known<'_>> = logs.iter().filter(|known| !self.is_done(known)).collect();
        let (done, all) = (logs.len() - open.len(), logs.len());
        if done > 0 {
            self.verbosity().say("note", format!("{done} of {all} logs are done already"));
        }
        let bar = Bar::new(self.verbosity(), "working", "logs", open.len() as u64);
        // They are sorted, as the logs are.
        let failures: Mutex<BTreeMap<&Path, String>> = Mutex::default();
        let next = AtomicUsize::new(0);
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = self.each.run.threads.unwrap_or(processors);
        let workers = threads.min(open.len());
        let of_each = (threads / workers.max(1)).max(1);
        let work = || {
            while let Some(known) = open.get(next.fetch_add(1, Ordering::Relaxed)) {
                if let Err(error) = self.work_on(known, of_each) {
                    // What an earlier version of the log gave is no result of this one; of one that
                    // cannot be read it may be.
                    if known.key.is_ok() {
                        std::fs::remove_file(self.place(known.log)).unwrap_or_default();
                    }
                    let mut failures = failures.lock().unwrap_or_else(PoisonError::into_inner);
                    failures.insert(known.log, format!("left out: {error:#}"));
                }
                bar.step();
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..workers {
                scope.spawn(work);
            }
        });
        let failures = failures.into_inner().unwrap_or_else(PoisonError::into_inner);
        let kept = logs.iter().filter(|known| !failures.contains_key(known.log));
        let results = kept.map(|known| Ok(Kept::read(&self.place(known.log))?.result()));
        let results = results.collect::<anyhow::Result<_>>()?;
        Ok((results, failures.into_values().collect()))
    }

    fn verbosity(&self) -> Verbosity {
        self.each.run.verbosity()
    }

    /// Refuses a folder with results of another command, which would be replaced.
    fn check_command(&self, earlier: &[Option<Kept>]) -> anyhow::Result<()> {
        match earlier.iter().flatten().find(|kept| kept.command != self.each.command) {
            Some(kept) => bail!(
                "{}: has results of `{}`; give the results of `{}` another folder",
                self.results.display(),
                kept.command,
                self.each.command
            ),
            None => Ok(()),
        }
    }

    /// Where the result of a log is kept.
    fn place(&self, log: &Path) -> PathBuf {
        self.results.join(format!("{}.json", name_of(log)))
    }

    /// Whether what is kept of a log is its result.
    fn is_done(&self, Known { log, key, earlier }: &Known<'_>) -> bool {
        let has_model = self.model_of(log).is_none_or(|model| model.is_file());
        let is_result = |kept: &Kept| {
            key.as_ref().is_ok_and(|key| kept.key == *key) && kept.file == text_of(log.as_os_str())
        };
        has_model && earlier.as_ref().is_some_and(is_result)
    }

    /// Where the model of a log is written, where the command makes one.
    fn model_of(&self, log: &Path) -> Option<PathBuf> {
        (self.each.command == "improve").then(|| self.place(log).with_extension("toml"))
    }

    fn settings(&self) -> String {
        let words: Vec<_> = self.options.words.iter().map(|word| text_of(word)).collect();
        words.join(" ")
    }

    /// Stands for all that the result of a log depends on.
    fn key(&self, log: &Path) -> anyhow::Result<String> {
        let place = self.place(log);
        if is_foreign(&place) {
            bail!(
                "{}: has the name of a result, but tauscope did not write it; move it",
                place.display()
            );
        }
        // It is read twice: for its hash, and by the program that works on it.
        if log.metadata().is_ok_and(|found| !found.is_file()) {
            bail!(
                "{}: a pipe or a device can be read once, and `--results` reads a log twice; write it \
                 to a file, or leave out `--results`",
                log.display()
            );
        }
        let mut hash = Sha256::new();
        for part in [env!("CARGO_PKG_VERSION"), self.each.command] {
            hash.update(part);
            hash.update([0]);
        }
        for word in &self.options.words {
            hash.update(word.as_encoded_bytes());
            hash.update([0]);
        }
        // A model file that is not there yet is made, and counts as empty.
        for file in self.options.files.iter().filter(|file| file.exists()) {
            hash.update(hash_of(file)?);
        }
        hash.update(hash_of(log)?);
        Ok(base16ct::lower::encode_string(&hash.finalize()))
    }

    /// Runs this program on one log and keeps what it says.
    fn work_on(&self, Known { log, key, .. }: &Known<'_>, threads: usize) -> anyhow::Result<()> {
        let key = key.as_ref().map_err(|error| anyhow!("{error:#}"))?;
        let program = std::env::current_exe().context("this program cannot be found")?;
        let mut command = Command::new(program);
        command.arg(self.each.command).args(&self.options.words);
        command.args(["--format=json", "--quiet"]).arg(format!("--threads={threads}"));
        if let Some(model) = self.model_of(log) {
            check_own_file(&model)?;
            let mut write = OsString::from("--write=");
            write.push(model);
            command.arg(write);
        }
        let output = command.arg("--").arg(log).stdin(Stdio::null()).output();
        let output = output.context("this program cannot be run")?;
        let said = String::from_utf8_lossy(&output.stderr);
        if !matches!(output.status.code(), Some(0 | 1)) {
            let error = said.lines().find_map(|line| line.strip_prefix("error: "));
            let error =
                error.map_or_else(|| format!("it ended with {}", output.status), str::to_owned);
            let name = log.display().to_string();
            let named = error.contains(&name);
            return Err(if named { anyhow!(error) } else { anyhow!("{name}: {error}") });
        }
        let document = serde_json::from_slice(&output.stdout)
            .with_context(|| format!("{}: its result is not JSON", log.display()))?;
        let (command, key) = (self.each.command.to_owned(), key.clone());
        let kept = Kept { command, settings: self.settings(), key, ..Kept::of(log, document) };
        kept.write(&self.place(log))
    }
}

fn hash_of(path: &Path) -> anyhow::Result<[u8; 32]> {
    let unread = || format!("{}: cannot be read", path.display());
    let mut hash = Sha256::new();
    let mut file = BufReader::new(File::open(path).with_context(unread)?);
    loop {
        let bytes = file.fill_buf().with_context(unread)?;
        if bytes.is_empty() {
            return Ok(hash.finalize().into());
        }
        hash.update(bytes);
        let count = bytes.len();
        file.consume(count);
    }
}

/// A command that is to run for each log.
pub(crate) struct Each<'a> {
    pub(crate) command: &'static str,
    pub(crate) data: &'a DataArgs,
    /// Where all decisions go, where the command has any.
    pub(crate) decisions: Option<&'a Path>,
    /// Options that make no sense for many logs, and whether they were given.
    pub(crate) refused: &'a [(&'static str, bool)],
    pub(crate) run: &'a RunArgs,
}

/// Options that do not change the result of a log, and the logs.
const WITHOUT_EFFECT: [&str; 8] =
    ["data", "results", "shard", "summary", "decisions", "format", "threads", "quiet"];

/// Options that name a file, whose content counts.
const FILES: [&str; 2] = ["columns", "model"];

/// What was typed beside the logs that changes the result of one.
pub(crate) struct LogOptions {
    /// Options and their values.
    pub(crate) words: Vec<OsString>,
    /// Files that they name.
    pub(crate) files: Vec<PathBuf>,
}

impl LogOptions {
    pub(super) fn of(typed: &Typed) -> Self {
        let mut options = Self { words: Vec::new(), files: Vec::new() };
        for (name, value) in typed.of(|name| !WITHOUT_EFFECT.contains(&name)) {
            let mut word = OsString::from(format!("--{name}"));
            if let Some(value) = value {
                word.push("=");
                word.push(value);
                options.files.extend(FILES.contains(&name).then(|| PathBuf::from(value)));
            }
            options.words.push(word);
        }
        options
    }
}

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
