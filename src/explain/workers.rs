//! Who does independent pieces of work.

/// Does independent pieces of work.
///
/// The fits of a ranking know nothing of one another. Who runs them, and on how many threads,
/// is the caller's business; results come back in the order of the pieces.
pub trait Workers: Sync {
    /// `work` on each of `pieces`.
    fn map<T: Sync, R: Send>(&self, pieces: &[T], work: impl Fn(&T) -> R + Sync + Send) -> Vec<R>;
}

/// One piece after the other, on the caller's thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sequential;

impl Workers for Sequential {
    fn map<T: Sync, R: Send>(&self, pieces: &[T], work: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
        pieces.iter().map(work).collect()
    }
}
