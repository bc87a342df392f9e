//! Independent pieces of work on many threads; the only file that names rayon.
//!
//! Each piece is done by one thread alone and results come back in the order of the pieces, so
//! that they are the same bit for bit on any number of threads.

use std::num::NonZero;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::thread;

use rayon::prelude::*;

use crate::experiment::address_space;
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
    with_prepared_threads(threads, |thread| thread(), work)
}

/// Threads at most: more take longer to start than they could save.
pub(crate) const MOST_THREADS: usize = 1024;

/// The threads that `RAYON_NUM_THREADS` asks for, as far as that makes sense; 0, which is one for
/// each processor, where it asks for none.
fn threads_of_environment() -> usize {
    let asked = std::env::var("RAYON_NUM_THREADS").ok();
    asked.and_then(|text| text.parse().ok()).unwrap_or(0).min(MOST_THREADS)
}

/// As many of `threads` as the addresses that this program may have leave room for, where they are
/// limited; 0 stands for one for each processor.
fn as_many_as_fit(threads: usize) -> usize {
    /// Addresses of a thread: its stack, and what the C library sets aside for what it allocates
    /// (64 MiB with glibc, twice as many while they are aligned).
    const OF_THREAD: u64 = 256 << 20;
    let Some(addresses) = address_space() else { return threads };
    let room = usize::try_from(addresses / OF_THREAD).unwrap_or(usize::MAX).max(1);
    let asked = match threads {
        0 => thread::available_parallelism().map_or(1, NonZero::get),
        threads => threads,
    };
    asked.min(room)
}

/// Runs `work` as [`with_threads`] does; `run` runs each thread, and all have ended after it.
///
/// # Errors
/// When the threads cannot be started.
pub(crate) fn with_prepared_threads<T: Send>(
    threads: Option<usize>,
    run: impl Fn(&mut (dyn FnMut() + Send)) + Send + Sync + 'static,
    work: impl FnOnce() -> T + Send,
) -> Result<T, rayon::ThreadPoolBuildError> {
    let (run, mut started) = (Arc::new(run), Vec::new());
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(as_many_as_fit(threads.unwrap_or_else(threads_of_environment)))
        .spawn_handler(|thread| {
            let (run, mut thread) = (Arc::clone(&run), Some(thread));
            let mut once = move || thread.take().into_iter().for_each(rayon::ThreadBuilder::run);
            started.push(thread::Builder::new().spawn(move || run(&mut once))?);
            Ok(())
        })
        .build()?;
    let result = catch_unwind(AssertUnwindSafe(|| pool.install(work)));
    drop(pool);
    for thread in started {
        // One that has panicked has informed the pool.
        thread.join().unwrap_or_default();
    }
    Ok(result.unwrap_or_else(|panic| resume_unwind(panic)))
}
