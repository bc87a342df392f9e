//! What people see on a terminal: colours where there is one, none elsewhere; progress on stderr, where a
//! person looks at it; and Ctrl-C: once to stop at the next occasion, twice to end.
//!
//! Only messages have colours. `NO_COLOR`, `CLICOLOR` and `CLICOLOR_FORCE` are heeded.

use std::io::{self, BufWriter, StdoutLock, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{LazyLock, Mutex, Once};
use std::time::Duration;

use anstyle::AnsiColor;
use anyhow::Context as _;
use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use super::host::Host;
use crate::experiment::is_control;
use crate::study::Watch;

/// `text` with its control characters shown, not sent: names in a log may hold what moves a
/// terminal's cursor, renames its window or turns the direction of writing.
pub(super) fn shown(text: &str) -> String {
    let is_sent = |letter: char| matches!(letter, '\n' | '\t') || !is_control(letter);
    if text.chars().all(is_sent) {
        return text.to_owned();
    }
    let letter = |letter: char| match letter {
        _ if is_sent(letter) => letter.to_string(),
        _ => letter.escape_unicode().to_string(),
    };
    text.chars().map(letter).collect()
}

/// Prints one line on stderr. That stderr is closed is no reason to stop.
pub(crate) fn message(kind: &str, text: &str) {
    if let Some(host) = Host::current() {
        return host.say(kind, &anstream::adapter::strip_str(text).to_string());
    }
    let style = match kind {
        "error" => AnsiColor::Red.on_default().bold(),
        "warning" | "stopping" => AnsiColor::Yellow.on_default().bold(),
        _ => AnsiColor::Cyan.on_default(),
    };
    let text = shown(text);
    BARS.suspend(|| {
        writeln!(anstream::stderr().lock(), "{style}{kind}:{style:#} {text}").unwrap_or_default();
    });
}

/// All bars there are, which no message is to be in the way of. It draws nothing where stderr is no terminal.
pub(super) static BARS: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);

/// Whether progress and notices are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verbosity {
    Normal,
    Quiet,
}

impl From<bool> for Verbosity {
    /// What `--quiet` says.
    fn from(quiet: bool) -> Self {
        if quiet { Self::Quiet } else { Self::Normal }
    }
}

impl Verbosity {
    /// Prints one line on stderr, where notices are shown.
    pub(crate) fn say(self, kind: &str, text: impl AsRef<str>) {
        if self == Self::Normal {
            message(kind, text.as_ref());
        }
    }
}

/// Prints a warning of each failure.
pub(crate) fn warn(failures: &[String]) {
    for failure in failures {
        message("warning", failure);
    }
}

/// What is wrong where a program that runs commands cannot take their results.
const NOT_KEPT: &str = "the results cannot be kept";

/// Prints results on stdout.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    if let Some(mut host) = Host::current() {
        let text = anstream::adapter::strip_str(text).to_string();
        return host.write_all(text.as_bytes()).context(NOT_KEPT);
    }
    print_with(|out| out.write_all(shown(text).as_bytes()))
}

/// Prints results on stdout as one line of JSON.
pub(crate) fn print_json(value: &impl Serialize) -> anyhow::Result<()> {
    if let Some(host) = Host::current() {
        return write_json(value, host).and_then(|mut out| out.flush()).context(NOT_KEPT);
    }
    print_with(|out| {
        let mut json = write_json(value, out)?;
        json.write_all(b"\n")?;
        // Dropped, it would write the rest and say nothing of what went wrong.
        json.flush()
    })
}

/// Writes JSON as it is made: all decisions of a long log are many times as long as a buffer.
fn write_json<W: Write>(value: &impl Serialize, out: W) -> io::Result<BufWriter<W>> {
    /// Bytes that are written at once.
    const PIECE: usize = 1 << 16;
    let mut out = BufWriter::with_capacity(PIECE, out);
    serde_json::to_writer(&mut out, value)?;
    Ok(out)
}

/// Lets `write` print on stdout as it is, without a thought for colours.
pub(crate) fn print_with(
    write: impl FnOnce(&mut StdoutLock<'_>) -> io::Result<()>,
) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    let written = write(&mut out).and_then(|()| out.flush());
    written.context("standard output cannot be written")
}

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
    fn control_characters_are_shown() {
        let name = "a\u{1b}]0;mine\u{7}\u{9b}2J\u{202e}b\u{1b}[8m\n\tend";
        let hidden = "a\\u{1b}]0;mine\\u{7}\\u{9b}2J\\u{202e}b\\u{1b}[8m\n\tend";
        assert_eq!(shown(name), hidden);
        assert_eq!(shown("plain °, 日本"), "plain °, 日本");
    }

    #[test]
    fn work_that_comes_up_makes_the_bar_longer() {
        let bar = Bar::new(Verbosity::Quiet, "fitting", "fits", 0);
        bar.more(3);
        bar.done();
        bar.more(2);
        assert_eq!((bar.drawn.position(), bar.drawn.length()), (1, Some(5)));
    }
}
