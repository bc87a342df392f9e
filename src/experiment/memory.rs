//! How much memory reading a log may take. Readers ask before they allocate.

use std::cell::Cell;
use std::sync::LazyLock;

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

use super::error::{ReadError, ReadErrorKind};

/// The most memory that reading logs may take.
///
/// What a log says of its own size is not trusted: past this limit it is refused before memory
/// is taken ([`ReadErrorKind::TooLarge`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryLimit(u64);

impl MemoryLimit {
    /// A limit of so many bytes.
    pub fn of_bytes(bytes: u64) -> Self {
        Self(bytes)
    }

    /// The limit in bytes.
    pub fn bytes(self) -> u64 {
        self.0
    }
}

impl Default for MemoryLimit {
    /// Half of the memory of the machine, or of the share of it that this program may use: a control
    /// group's, or that of `ulimit -v`.
    fn default() -> Self {
        /// Where the machine does not say.
        const UNKNOWN: u64 = 4 << 30;
        static HALF: LazyLock<u64> = LazyLock::new(|| {
            let memory = MemoryRefreshKind::nothing().with_ram();
            let system = System::new_with_specifics(RefreshKind::nothing().with_memory(memory));
            let share = system.cgroup_limits().map(|limits| limits.total_memory);
            let all = share.into_iter().chain(address_space()).chain([system.total_memory()]);
            let all = all.filter(|bytes| *bytes > 0);
            all.min().unwrap_or(UNKNOWN) / 2
        });
        Self(*HALF)
    }
}

/// The addresses that this program may have, where they are limited.
#[cfg(unix)]
pub(crate) fn address_space() -> Option<u64> {
    rustix::process::getrlimit(rustix::process::Resource::As).current
}

#[cfg(not(unix))]
pub(crate) fn address_space() -> Option<u64> {
    None
}

/// Memory of a number that is read: itself, and a copy or what its vector has to spare.
pub(super) const NUMBER_SIZE: usize = 2 * size_of::<f64>();

/// What is left of the limit while a log is read.
#[derive(Debug)]
pub(super) struct Budget {
    limit: u64,
    taken: Cell<u64>,
}

impl Budget {
    pub(super) fn new(limit: MemoryLimit) -> Self {
        Self { limit: limit.0, taken: Cell::new(0) }
    }

    /// A budget of what is left, for what is given back when it is dropped.
    pub(super) fn rest(&self) -> Self {
        Self { limit: self.limit, taken: self.taken.clone() }
    }

    /// Bytes that are left.
    pub(super) fn left(&self) -> u64 {
        self.limit.saturating_sub(self.taken.get())
    }

    /// Takes `bytes`, before they are allocated.
    pub(super) fn take(&self, bytes: u64) -> Result<(), ReadError> {
        self.check(bytes).map(|()| self.taken.set(self.taken.get() + bytes))
    }

    /// Takes the memory of `count` values of `size` bytes each.
    pub(super) fn take_values(&self, count: usize, size: usize) -> Result<(), ReadError> {
        self.take((count as u64).saturating_mul(size as u64))
    }

    /// Whether `bytes` are left, which are given back at once.
    pub(super) fn check(&self, bytes: u64) -> Result<(), ReadError> {
        let needed = self.taken.get().saturating_add(bytes);
        if needed <= self.limit {
            return Ok(());
        }
        let [needed, limit] = [needed, self.limit].map(in_words);
        let text = format!(
            "reading it would need {needed} of memory, but {limit} are allowed; check that the \
             file is a log"
        );
        Err(ReadError::new(ReadErrorKind::TooLarge, text))
    }
}

/// A number of bytes for people: `1.5 GB`.
fn in_words(count: u64) -> String {
    match count as f64 {
        count @ 1e9.. => format!("{:.1} GB", count / 1e9),
        count @ 1e6.. => format!("{:.0} MB", count / 1e6),
        count => format!("{count} bytes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_past_the_limit_is_refused_and_the_rest_given_back() {
        let budget = Budget::new(MemoryLimit::of_bytes(100));
        budget.take(60).unwrap();
        budget.rest().take(40).unwrap();
        assert!(budget.take_values(usize::MAX, 8).is_err());
        let refused = budget.take(41).unwrap_err().to_string();
        assert!(
            refused.contains("reading it would need 101 bytes of memory, but 100 bytes"),
            "{refused}"
        );
        budget.take(40).unwrap();
    }

    #[test]
    fn the_machine_has_memory() {
        assert!(MemoryLimit::default().bytes() > 1 << 20);
    }
}
