//! What every document begins with.

use serde::Serialize;

/// Schema and version of the program.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Header {
    schema: &'static str,
    version: &'static str,
}

impl Header {
    pub(crate) const fn of(schema: &'static str) -> Self {
        Self { schema, version: env!("CARGO_PKG_VERSION") }
    }
}
