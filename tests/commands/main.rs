//! The command line: exit status, messages, outputs, folders, and that the documents say what is so.
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

mod bad_input;
#[path = "../support/desk.rs"]
#[expect(dead_code, reason = "models are compared in a room of their own")]
mod desk;
mod determinism;
mod documents;
mod ease;
mod examples;
mod extremes;
mod faults;
mod first_look;
mod folders;
mod follow;
mod json_fields;
#[path = "../support/log_text.rs"]
mod log_text;
mod outputs;
mod simulate_command;
mod within;
