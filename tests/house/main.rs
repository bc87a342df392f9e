//! The project itself: which module may use which, and what the dependencies may be.
#![expect(clippy::unwrap_used, clippy::panic, reason = "a test may fail loudly")]

mod dependencies;
mod layering;
mod programs;
mod record;
