//! What people see on a terminal: colours where there is one, none elsewhere.
//!
//! Only messages have any. `NO_COLOR`, `CLICOLOR` and `CLICOLOR_FORCE` are heeded.

use std::io::{self, BufWriter, StdoutLock, Write};
use std::sync::LazyLock;

use anstyle::AnsiColor;
use anyhow::Context as _;
use indicatif::MultiProgress;
use serde::Serialize;

use super::host::Host;
use crate::experiment::is_control;

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
}
