//! Fits to very long records, one at a time.
//!
//! A fit holds the slope of the residual of each training sample to each free parameter. Of a
//! usual record that is a few megabytes, and as many fits run at once as there are processors;
//! of ten million samples it is most of a gigabyte.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Slopes that a fit may keep beyond those at which it is, and of which several fits at once may
/// hold as many. Chosen: 16 MB, a record of some 300,000 samples.
const MANY: usize = 2_000_000;

static TURN: Mutex<()> = Mutex::new(());

/// Whether so many slopes are most of the memory of a program.
pub(super) fn is_large(slopes: usize) -> bool {
    slopes > MANY
}

/// Waits until no other fit with so many slopes runs, where they are many; the turn ends with what is
/// returned.
pub(super) fn wait_for(slopes: usize) -> Option<MutexGuard<'static, ()>> {
    // It guards no data that a panic could have left half done.
    is_large(slopes).then(|| TURN.lock().unwrap_or_else(PoisonError::into_inner))
}
