//! Pieces of work done several at a time, their results in the order of the pieces.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, ScopedJoinHandle};

/// What `work` makes of each of `pieces`, which it is told with its place, `threads` at a time.
pub(crate) fn in_order<T: Sync, R: Send>(
    pieces: &[T],
    threads: usize,
    work: impl Fn(usize, &T) -> anyhow::Result<R> + Sync,
) -> anyhow::Result<Vec<R>> {
    let next = AtomicUsize::new(0);
    let take = || {
        let index = next.fetch_add(1, Ordering::Relaxed);
        pieces.get(index).map(|piece| (index, piece))
    };
    let one = |(index, piece): (usize, &T)| Ok((index, work(index, piece)?));
    let all = || std::iter::from_fn(take).map(one).collect();
    let parts: Vec<anyhow::Result<Vec<(usize, R)>>> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(all)).collect();
        let ended = workers.into_iter().map(ScopedJoinHandle::join);
        ended.map(|part| part.unwrap_or_else(|panic| resume_unwind(panic))).collect()
    });
    let mut done = Vec::new();
    for part in parts {
        done.extend(part?);
    }
    done.sort_by_key(|(index, _)| *index);
    Ok(done.into_iter().map(|(_, result)| result).collect())
}
