//! What every repair is asked.

use crate::experiment::log::Log;

/// A fault that logs of some kind have, as it was found in one.
pub(super) trait Repair: Sized {
    /// Where the fault is.
    fn detect(log: &Log<'_>) -> impl IntoIterator<Item = Self>;

    /// Mends it, and says what was done where a reader of the log should know.
    fn apply(self, log: &mut Log<'_>) -> Option<String>;
}
