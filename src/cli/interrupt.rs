//! Ctrl-C: once to stop at the next occasion, twice to end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::message;

/// Exit status of a program that was ended by an interrupt, as shells have it.
const ENDED: i32 = 130;

/// Whether somebody pressed Ctrl-C.
#[derive(Clone, Debug, Default)]
pub(super) struct Interrupt {
    pressed: Arc<AtomicBool>,
}

impl Interrupt {
    /// Watches from now on. Where that cannot be done, Ctrl-C ends the program as ever.
    pub(super) fn watch() -> Self {
        let interrupt = Self::default();
        let pressed = Arc::clone(&interrupt.pressed);
        let handler = move || {
            if pressed.swap(true, Ordering::SeqCst) {
                std::process::exit(ENDED);
            }
            message("stopping", "after this revision; Ctrl-C again ends at once, without results");
        };
        ctrlc::set_handler(handler).unwrap_or_default();
        interrupt
    }

    pub(super) fn was_pressed(&self) -> bool {
        self.pressed.load(Ordering::SeqCst)
    }
}
