//! What a language does with a model.

use super::{Export, ExportError};

/// A language that a model can be written in.
pub trait Language: Sync {
    /// How the names of its files end; the first is that of the file with the step function.
    fn endings(&self) -> &'static [&'static str];

    /// What it is called.
    fn name(&self) -> &'static str;

    /// The files of `export`; `name` is what they are called, without their endings.
    ///
    /// # Errors
    /// [`ExportError::Name`] where `name` is not one in this language;
    /// [`ExportError::Archive`] where the files cannot be put together.
    fn files(&self, export: &Export, name: &str) -> Result<Vec<File>, ExportError> {
        if is_name(name) {
            self.written(export, name)
        } else {
            Err(ExportError::Name { name: name.to_owned(), language: self.name() })
        }
    }

    /// [`files`](Self::files) of a name that was checked.
    ///
    /// # Errors
    /// [`ExportError::Archive`] where the files cannot be put together.
    fn written(&self, export: &Export, name: &str) -> Result<Vec<File>, ExportError>;
}

/// Whether `name` is one in the languages that models are written in.
fn is_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// A file of an exported model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// The ending of its name, without a dot.
    pub ending: &'static str,
    /// Its bytes.
    pub content: Vec<u8>,
    /// What is to be said of it: what is missing in it, and why.
    pub note: Option<String>,
}

impl File {
    pub(super) fn of(ending: &'static str, text: String) -> Self {
        Self { ending, content: text.into_bytes(), note: None }
    }

    /// Its text, where it is text.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.content).into_owned()
    }
}
