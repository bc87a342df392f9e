//! Progress on stderr, where a person looks at it.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Whether progress and notices are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verbosity {
    Normal,
    Quiet,
}

/// A bar for `length` steps of `what`; it is gone when it is dropped, and never drawn
/// where stderr is no terminal.
pub(super) fn bar(verbosity: Verbosity, what: &'static str, length: u64) -> ProgressBar {
    let bar = match verbosity {
        Verbosity::Quiet => ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden()),
        Verbosity::Normal => ProgressBar::new(length),
    };
    let style = match length {
        0 => ProgressStyle::with_template("{spinner} {msg} {elapsed}"),
        _ => ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}"),
    };
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.set_message(what);
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}
