//! Which schema a plant file follows.

/// The schema of a plant file.
pub const SCHEMA: &str = "tauscope/plant/1";
