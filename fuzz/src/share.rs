//! How many of the inputs get past the reader, and from which of them the fuzzer goes on.

use std::sync::atomic::{AtomicU64, Ordering};

use libfuzzer_sys::Corpus;

/// Runs between two messages.
const EVERY: u64 = 1 << 12;

/// Of those that are refused, the fuzzer goes on from one of so many: there are thousands of ways
/// to be refused, and from a corpus of these little is read.
const REFUSED: u64 = 16;

/// Counts a run, and says now and then which share was read.
pub fn count(was_read: bool) -> Corpus {
    static RUNS: AtomicU64 = AtomicU64::new(0);
    static READ: AtomicU64 = AtomicU64::new(0);
    let read = READ.fetch_add(u64::from(was_read), Ordering::Relaxed) + u64::from(was_read);
    let runs = RUNS.fetch_add(1, Ordering::Relaxed) + 1;
    if runs.is_multiple_of(EVERY) {
        eprintln!("read: {read} of {runs} ({} %)", 100 * read / runs);
    }
    if was_read || runs.is_multiple_of(REFUSED) { Corpus::Keep } else { Corpus::Reject }
}
