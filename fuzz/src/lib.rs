//! What the targets share: what is tried with bytes, and how bytes are changed so that they
//! get past the first check of a reader.

#[path = "../../tests/reading/attempts.rs"]
pub mod attempts;
pub mod mutate;
pub mod share;
