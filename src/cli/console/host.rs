//! A program that runs commands inside itself, and takes what a terminal would be shown.

use std::cell::RefCell;
use std::ops::Deref;
use std::sync::Arc;
use std::{fmt, io};

use crate::effect::Effect;
use crate::experiment::{Experiment, ReadOptions};

/// What a program does for the commands that it runs inside itself.
pub trait Hosting: Send + Sync {
    /// The logs that it has in memory, read with these options; `None` where they are in the
    /// files that the arguments name.
    fn logs(&self, _options: &ReadOptions) -> Option<Experiment> {
        None
    }

    /// Effects of its own, which models may name, and which are tried like those of the
    /// catalogue where one is missing.
    fn effects(&self) -> Vec<&'static dyn Effect> {
        Vec::new()
    }

    /// Runs a thread of a command, in the surroundings that its effects need.
    fn run_thread(&self, thread: &mut (dyn FnMut() + Send)) {
        thread();
    }

    /// Takes a piece of the results, UTF-8; characters may be cut.
    ///
    /// # Errors
    /// When it cannot be kept.
    fn print(&self, _results: &[u8]) -> io::Result<()> {
        Ok(())
    }

    /// Takes a message: its kind, such as `warning`, and its text.
    fn say(&self, _kind: &str, _text: &str) {}

    /// So many pieces of `of` are done, where it is known how many there are.
    fn progress(&self, _what: &str, _done: u64, _of: u64) {}

    /// Whether to stop at the next occasion, with what was reached.
    fn is_stopping(&self) -> bool {
        false
    }

    /// Whether to end at once, without results.
    fn is_ending(&self) -> bool {
        false
    }
}

/// The program in whose place this thread works.
#[derive(Clone)]
pub(crate) struct Host(Arc<dyn Hosting>);

impl fmt::Debug for Host {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Host").finish_non_exhaustive()
    }
}

impl Deref for Host {
    type Target = dyn Hosting;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

thread_local! {
    /// Of this thread: two programs may run commands at the same time.
    static CURRENT: RefCell<Option<Host>> = const { RefCell::new(None) };
}

impl io::Write for Host {
    fn write(&mut self, results: &[u8]) -> io::Result<usize> {
        self.0.print(results).map(|()| results.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What a thread that is to end is unwound with.
#[derive(Debug)]
pub(crate) struct Ended;

impl Host {
    pub(crate) fn new(hosting: Arc<dyn Hosting>) -> Self {
        Self(hosting)
    }

    /// That of this thread; `None` where a person started the program.
    pub(crate) fn current() -> Option<Self> {
        CURRENT.with_borrow(Clone::clone)
    }

    /// This thread works for `host` from now on.
    pub(crate) fn enter(host: Option<Self>) {
        CURRENT.set(host);
    }

    /// Says how far the work is; unwinds the thread where it is to end.
    pub(crate) fn tell_progress(&self, what: &str, done: u64, of: u64) {
        self.0.progress(what, done, of);
        if self.0.is_ending() {
            // Not a panic: nothing went wrong, and nobody is to be told so.
            std::panic::resume_unwind(Box::new(Ended));
        }
    }
}
