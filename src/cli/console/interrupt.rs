//! Ctrl-C: once to stop at the next occasion, twice to end.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once};
use std::time::Duration;

use super::host::Host;
use super::terminal::message;

/// Exit status of a program that was ended by an interrupt, as shells have it.
const ENDED: i32 = 130;

/// What is said to somebody who stops the improvement of models.
pub(crate) const STOPPING: &str = "after this revision; Ctrl-C again ends at once, without results";

/// Whether Ctrl-C was pressed since somebody watched.
static PRESSED: AtomicBool = AtomicBool::new(false);

/// What is said then.
static ANSWER: Mutex<&str> = Mutex::new("");

/// Whether somebody pressed Ctrl-C.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interrupt(());

impl Interrupt {
    /// Watches from now on, and says `answer` when it is pressed. Where that cannot be done,
    /// Ctrl-C ends the program as ever.
    pub(crate) fn watch(answer: &'static str) -> Self {
        static HANDLER: Once = Once::new();
        if let Ok(mut said) = ANSWER.lock() {
            *said = answer;
        }
        if Host::current().is_some() {
            // Signals are the host's.
            return Self(());
        }
        PRESSED.store(false, Ordering::SeqCst);
        HANDLER.call_once(|| ctrlc::set_handler(pressed).unwrap_or_default());
        Self(())
    }

    #[expect(clippy::unused_self, reason = "who has it has watched")]
    pub(crate) fn was_pressed(self) -> bool {
        match Host::current() {
            Some(host) => host.is_stopping(),
            None => PRESSED.load(Ordering::SeqCst),
        }
    }

    /// Sleeps for `time`, or until it is pressed; whether it was.
    pub(crate) fn sleep(self, time: Duration) -> bool {
        const TICK: Duration = Duration::from_millis(20);
        let mut left = time;
        while !left.is_zero() && !self.was_pressed() {
            std::thread::sleep(TICK.min(left));
            left = left.saturating_sub(TICK);
        }
        self.was_pressed()
    }
}

fn pressed() {
    if PRESSED.swap(true, Ordering::SeqCst) {
        std::process::exit(ENDED);
    }
    let answer = ANSWER.lock().map(|answer| *answer).unwrap_or_default();
    message("stopping", answer);
}
