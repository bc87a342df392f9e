//! Independent pieces of work on many threads; the only file that names rayon.
//!
//! Each piece is done by one thread alone and results come back in the order of the pieces, so
//! that they are the same bit for bit on any number of threads.

use rayon::prelude::*;

use crate::explain::Workers;

/// The threads of the pool that the caller runs in: see [`with_threads`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Threads;

impl Workers for Threads {
    fn map<T: Sync, R: Send>(&self, pieces: &[T], work: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
        pieces.par_iter().map(work).collect()
    }
}

/// Runs `work` on `threads` threads; on as many as there are processors without a number.
///
/// # Errors
/// When the threads cannot be started.
pub fn with_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, rayon::ThreadPoolBuildError> {
    with_prepared_threads(threads, || (), work)
}

/// Runs `work` as [`with_threads`] does; each thread does `prepare` before all else.
///
/// # Errors
/// When the threads cannot be started.
pub fn with_prepared_threads<T: Send>(
    threads: Option<usize>,
    prepare: impl Fn() + Send + Sync + 'static,
    work: impl FnOnce() -> T + Send,
) -> Result<T, rayon::ThreadPoolBuildError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .start_handler(move |_| prepare())
        .build()?;
    Ok(pool.install(work))
}
