//! Logs as machines, programs and people write them: what is read, what is refused, and with what words.
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

#[expect(unreachable_pub, reason = "the fuzzer's targets are crates of their own")]
mod attempts;
#[cfg(any(feature = "mat", feature = "mcap"))]
mod bytes;
mod column_names;
mod formats;
mod hostile;
#[path = "../support/log_text.rs"]
mod log_text;
mod messy_logs;
mod mutations;
mod replay;
mod spellings;
mod unlogged_steps;
