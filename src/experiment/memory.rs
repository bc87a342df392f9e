//! How much memory reading a log may take. Readers ask before they allocate.

use std::cell::Cell;
use std::path::Path;
use std::sync::LazyLock;

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

use super::error::ReadError;

/// The most memory that reading logs may take.
///
/// What a log says of its own size is not trusted: past this limit it is refused before memory
/// is taken ([`ReadError::TooLarge`]).
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

/// What is left of the limit while a log is read.
#[derive(Debug)]
pub(super) struct Budget {
    limit: u64,
    taken: Cell<u64>,
}

/// More was asked for than is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TooLarge {
    /// Bytes that are needed, as far as is known.
    needed: u64,
    limit: u64,
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
    pub(super) fn take(&self, bytes: u64) -> Result<(), TooLarge> {
        self.check(bytes)?;
        self.taken.set(self.taken.get() + bytes);
        Ok(())
    }

    /// Gives back bytes that were taken and are free again.
    #[cfg(feature = "mat")]
    pub(super) fn give_back(&self, bytes: u64) {
        self.taken.set(self.taken.get().saturating_sub(bytes));
    }

    /// Takes the memory of `count` values of `size` bytes each.
    pub(super) fn take_values(&self, count: usize, size: usize) -> Result<(), TooLarge> {
        self.take((count as u64).saturating_mul(size as u64))
    }

    /// Whether `bytes` are left, which are given back at once.
    pub(super) fn check(&self, bytes: u64) -> Result<(), TooLarge> {
        let needed = self.taken.get().saturating_add(bytes);
        if needed <= self.limit { Ok(()) } else { Err(TooLarge { needed, limit: self.limit }) }
    }
}

impl TooLarge {
    /// The log at `path` is refused.
    pub(super) fn refuse(self, path: &Path) -> ReadError {
        ReadError::TooLarge { path: path.to_owned(), needed: self.needed, limit: self.limit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_past_the_limit_is_refused_and_the_rest_given_back() {
        let budget = Budget::new(MemoryLimit::of_bytes(100));
        assert_eq!(budget.take(60), Ok(()));
        assert_eq!(budget.rest().take(40), Ok(()));
        assert_eq!(budget.take_values(usize::MAX, 8).unwrap_err().limit, 100);
        assert_eq!(budget.take(41), Err(TooLarge { needed: 101, limit: 100 }));
        assert_eq!(budget.take(40), Ok(()));
    }

    #[test]
    fn the_machine_has_memory() {
        assert!(MemoryLimit::default().bytes() > 1 << 20);
    }
}
