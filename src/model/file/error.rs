//! Why a model file cannot be used.

use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

/// Why a model file cannot be used: the file, the place in it, what is wrong there and what to do, and
/// as [source](Error::source) what the system, the parser or the catalogue said.
#[derive(Debug)]
pub struct ModelError {
    place: Place,
    problem: String,
    source: Option<Box<dyn Error + Send + Sync>>,
}

impl Display for ModelError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { place: Place { path, part }, problem, .. } = self;
        match part {
            Some(part) => write!(f, "{}, {part}: {problem}", path.display()),
            None => write!(f, "{}: {problem}", path.display()),
        }
    }
}

impl Error for ModelError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.source.as_deref().map(|source| source as &(dyn Error + 'static))
    }
}

/// A file, or a part of it.
#[derive(Clone, Debug)]
pub(super) struct Place {
    path: PathBuf,
    part: Option<String>,
}

impl Place {
    pub(super) fn file(path: &Path) -> Self {
        Self { path: path.to_owned(), part: None }
    }

    pub(super) fn joint(path: &Path, joint: &str) -> Self {
        Self::part(path, format!("joint `{joint}`"))
    }

    pub(super) fn part(path: &Path, part: String) -> Self {
        Self { path: path.to_owned(), part: Some(part) }
    }

    pub(super) fn error(&self, problem: impl Into<String>) -> ModelError {
        ModelError { place: self.clone(), problem: problem.into(), source: None }
    }

    /// An error with the cause that it had.
    pub(super) fn error_from(
        &self,
        problem: impl Into<String>,
        source: impl Into<Box<dyn Error + Send + Sync>>,
    ) -> ModelError {
        ModelError { source: Some(source.into()), ..self.error(problem) }
    }
}
