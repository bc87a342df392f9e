//! Files with results, of a person or of an earlier run: tables, and what is wrong with them.

use std::error::Error;
use std::path::{Path, PathBuf};

/// Why a file with results cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// It cannot be opened, or is not whole.
    #[error("{path}: {problem}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What it is not.
        problem: &'static str,
        /// What is wrong with it.
        source: Box<dyn Error + Send + Sync>,
    },
    /// Something in it cannot be understood.
    #[error("{path}{place}: {problem}")]
    Wrong {
        /// The file.
        path: PathBuf,
        /// Where in the file; empty where it is about the whole.
        place: String,
        /// What is wrong.
        problem: String,
    },
}

impl FileError {
    /// That `path` cannot be read, for the reason that its reader gives.
    pub(super) fn unreadable<E: Error + Send + Sync + 'static>(
        path: &Path,
        problem: &'static str,
    ) -> impl Fn(E) -> Self {
        move |source| {
            let source = Box::new(source);
            Self::Unreadable { path: path.to_owned(), problem, source }
        }
    }

    /// That something at a `place` in `path` cannot be understood.
    pub(super) fn wrong(path: &Path, place: String, problem: String) -> Self {
        Self::Wrong { path: path.to_owned(), place, problem }
    }
}

/// A reader of the table `text`, whose cells are parted by what its header has most of: a comma, a
/// semicolon or a tab. Lines that begin with `comment` are none of it.
pub(super) fn table_reader(text: &str, comment: Option<u8>) -> csv::Reader<&[u8]> {
    let is_comment =
        |line: &&str| comment.is_some_and(|mark| line.as_bytes().first() == Some(&mark));
    let header = text.lines().find(|line| !is_comment(line)).unwrap_or_default();
    let count = |delimiter: &u8| header.bytes().filter(|byte| byte == delimiter).count();
    let delimiter = [b',', b';', b'\t'].into_iter().max_by_key(count);
    let mut builder = csv::ReaderBuilder::new();
    builder.delimiter(delimiter.unwrap_or(b',')).trim(csv::Trim::All).comment(comment);
    builder.from_reader(text.as_bytes())
}
