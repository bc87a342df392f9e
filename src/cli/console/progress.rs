//! Progress on stderr, where a person looks at it.

use std::time::Duration;

use super::host::Host;
use super::terminal::{BARS, Verbosity};
use crate::study::Watch;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar that is gone when it is dropped.
#[derive(Debug)]
pub(crate) struct Bar {
    drawn: ProgressBar,
    what: &'static str,
    host: Option<Host>,
}

impl Bar {
    /// A bar for `length` steps of `what`, with its rate and the time left; of an unknown
    /// number of steps where that is 0. `units` are what is counted.
    pub(crate) fn new(
        verbosity: Verbosity,
        what: &'static str,
        units: &'static str,
        length: u64,
    ) -> Self {
        let host = Host::current();
        let bar = if host.is_none() && verbosity == Verbosity::Normal {
            BARS.add(ProgressBar::new(length))
        } else {
            ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden())
        };
        bar.set_prefix(units);
        bar.set_style(style(length));
        bar.set_message(what);
        if host.is_none() {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        bar.set_length(length);
        Self { drawn: bar, what, host }
    }

    /// A sign of life for work that cannot be counted.
    pub(crate) fn spinner(verbosity: Verbosity, what: &'static str) -> Self {
        Self::new(verbosity, what, "", 0)
    }

    /// Says what is being done.
    pub(crate) fn say(&self, what: String) {
        self.drawn.set_message(what);
    }

    /// One step is done.
    pub(crate) fn step(&self) {
        self.drawn.inc(1);
        self.tell();
    }

    fn tell(&self) {
        if let Some(host) = &self.host {
            host.tell_progress(self.what, self.drawn.position(), self.drawn.length().unwrap_or(0));
        }
    }
}

fn style(length: u64) -> ProgressStyle {
    let style = match length {
        0 => ProgressStyle::with_template("{spinner} {msg} {elapsed}"),
        _ => ProgressStyle::with_template(
            "{msg} {wide_bar} {pos}/{len} {prefix}, {per_sec}, {eta} left",
        ),
    };
    style.unwrap_or_else(|_| ProgressStyle::default_bar())
}

impl Watch for Bar {
    fn more(&self, pieces: usize) {
        let before = self.drawn.length().unwrap_or(0);
        let length = before + pieces as u64;
        self.drawn.set_length(length);
        if before == 0 {
            self.drawn.set_style(style(length));
        }
    }

    fn done(&self) {
        self.step();
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.drawn.finish_and_clear();
        BARS.remove(&self.drawn);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_that_comes_up_makes_the_bar_longer() {
        let bar = Bar::new(Verbosity::Quiet, "fitting", "fits", 0);
        bar.more(3);
        bar.done();
        bar.more(2);
        assert_eq!((bar.drawn.position(), bar.drawn.length()), (1, Some(5)));
    }
}
