//! The delay table as source code that a controller looks its delays up in.
//!
//! ```text
//! side(u) = 1 above the neutral band, −1 below it, 0 within it
//! ```
//!
//! The kind of a step follows from the sides of both levels, as in
//! [`Transition::of`](crate::delay::Transition::of). Within a kind, a side and a direction the
//! delay is a line from point to point over the level (for a stop that before, else that
//! after), and beyond the first and the last point it stays what it is there. What was not
//! measured is not a number.

mod code;
mod contents;
mod json;

use std::path::Path;

pub(crate) use contents::Lookup;

/// What a lookup is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Language {
    C,
    Matlab,
    Python,
    Json,
}

impl Language {
    /// By the ending of the file's name.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?;
        let known =
            [("c", Self::C), ("m", Self::Matlab), ("py", Self::Python), ("json", Self::Json)];
        known.into_iter().find(|(name, _)| *name == ending).map(|(_, language)| language)
    }

    /// The source code of `lookup`; `name` is what the file is called, without its ending.
    ///
    /// # Errors
    /// Never: what JSON is made of can be written.
    pub(crate) fn source(self, lookup: &Lookup<'_>, name: &str) -> serde_json::Result<String> {
        Ok(match self {
            Self::C => code::c(lookup),
            Self::Matlab => code::matlab(lookup, name),
            Self::Python => code::python(lookup),
            Self::Json => json::source(lookup)?,
        })
    }
}
