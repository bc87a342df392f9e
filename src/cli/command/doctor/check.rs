//! What was found of a thing, and what to do about it.

use serde::Serialize;

/// How well a thing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum State {
    /// As it should be.
    Ok,
    /// Work goes on without it.
    Note,
    /// Something cannot be done without it.
    Missing,
}

/// What was found of one thing, and what to do where it is not as it should be.
#[derive(Debug, Serialize)]
pub(super) struct Found {
    pub(super) state: State,
    pub(super) found: String,
    pub(super) remedy: Option<String>,
}

/// What was found, by the name of the thing.
#[derive(Debug, Serialize)]
pub(super) struct Check {
    pub(super) name: &'static str,
    #[serde(flatten)]
    pub(super) found: Found,
}

pub(super) fn ok(found: impl Into<String>) -> Found {
    Found { state: State::Ok, found: found.into(), remedy: None }
}

pub(super) fn note(found: impl Into<String>, remedy: impl Into<String>) -> Found {
    Found { state: State::Note, ..missing(found, remedy) }
}

pub(super) fn missing(found: impl Into<String>, remedy: impl Into<String>) -> Found {
    Found { state: State::Missing, found: found.into(), remedy: Some(remedy.into()) }
}
