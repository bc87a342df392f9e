//! What people see on a terminal: colours where there is one, none elsewhere.
//!
//! `NO_COLOR`, `CLICOLOR` and `CLICOLOR_FORCE` are heeded. What is written to a file or a
//! pipe is the text alone.

use std::io::{self, BufWriter, StdoutLock, Write};
use std::sync::LazyLock;

use anstream::AutoStream;
use anstyle::{AnsiColor, Style};
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

/// `text` with its control characters shown, but for the colours of [`toned`] words.
fn shown_in_tones(text: &str) -> String {
    let tones = [Tone::Good, Tone::Notice, Tone::Bad].map(Tone::style);
    let mut codes: Vec<String> = tones.iter().map(ToString::to_string).collect();
    codes.push(format!("{:#}", Tone::Good.style()));
    let (mut all, mut rest) = (String::new(), text);
    while let Some(at) = rest.find(ESCAPE) {
        let (before, escaped) = rest.split_at(at);
        // A code may be made of several escapes, so that it is taken whole.
        let code = codes.iter().find(|code| escaped.starts_with(code.as_str()));
        let (code, letter) = code.map_or((0, ESCAPE.len_utf8()), |code| (code.len(), 0));
        let (code, after) = escaped.split_at(code);
        let (letter, after) = after.split_at(letter);
        all += &shown(before);
        all += code;
        all += &shown(letter);
        rest = after;
    }
    all + &shown(rest)
}

/// What colours and all else that a terminal does begin with.
const ESCAPE: char = '\u{1b}';

/// What a word is coloured for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tone {
    Good,
    Notice,
    Bad,
}

impl Tone {
    fn style(self) -> Style {
        let color = match self {
            Self::Good => AnsiColor::Green,
            Self::Notice => AnsiColor::Yellow,
            Self::Bad => AnsiColor::Red,
        };
        color.on_default().bold()
    }
}

/// `text` in a tone. It must be printed by this module.
pub(crate) fn toned(tone: Tone, text: &str) -> String {
    let style = tone.style();
    format!("{style}{text}{style:#}")
}

/// Whether results are shown with colours.
fn has_colors() -> bool {
    AutoStream::choice(&io::stdout()) != anstream::ColorChoice::Never
}

/// Prints one line on stderr. That stderr is closed is no reason to stop.
pub(crate) fn message(kind: &str, text: &str) {
    if let Some(host) = Host::current() {
        return host.say(kind, &anstream::adapter::strip_str(text).to_string());
    }
    let style = match kind {
        "error" => Tone::Bad.style(),
        "warning" | "stopping" => Tone::Notice.style(),
        _ => AnsiColor::Cyan.on_default(),
    };
    let text = shown_in_tones(text);
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

/// Prints results on stdout, tables with their frames dimmed.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    if let Some(mut host) = Host::current() {
        let text = anstream::adapter::strip_str(text).to_string();
        return host.write_all(text.as_bytes()).context(NOT_KEPT);
    }
    let mut out = anstream::stdout().lock();
    let text = shown_in_tones(text);
    let painted = if has_colors() { painted(&text) } else { text };
    let written = out.write_all(painted.as_bytes()).and_then(|()| out.flush());
    written.context("standard output cannot be written")
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

/// Frames of tables dimmed, their header lines bold; all else as it is.
fn painted(text: &str) -> String {
    let mut is_header = false;
    let line = |line: &str| {
        // The header of a table is between its upper frame and the next rule.
        is_header = match line.chars().next() {
            Some('┌') => true,
            Some('│') => is_header,
            _ => false,
        };
        let (line, end) = line.strip_suffix('\n').map_or((line, ""), |line| (line, "\n"));
        painted_line(line, if is_header { Style::new().bold() } else { Style::new() }) + end
    };
    text.split_inclusive('\n').map(line).collect()
}

/// A line of a table, its cells in `style`; other lines as they are.
fn painted_line(line: &str, style: Style) -> String {
    let dimmed = Style::new().dimmed();
    if line.starts_with(['┌', '╞', '└', '├']) {
        return format!("{dimmed}{line}{dimmed:#}");
    }
    let bar = format!("{dimmed}│{dimmed:#}");
    match line.strip_prefix('│').and_then(|line| line.strip_suffix('│')) {
        Some(cells) => format!("{bar}{style}{cells}{style:#}{bar}"),
        None => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown_and_own_colours_sent() {
        let name = "a\u{1b}]0;mine\u{7}\u{9b}2J\u{202e}b\u{1b}[8m";
        let said = format!("{}\n{}\tend", toned(Tone::Good, name), toned(Tone::Bad, "lost"));
        let found = shown_in_tones(&said);
        let hidden = "a\\u{1b}]0;mine\\u{7}\\u{9b}2J\\u{202e}b\\u{1b}[8m";
        assert_eq!(
            found,
            format!("{}\n{}\tend", toned(Tone::Good, hidden), toned(Tone::Bad, "lost"))
        );
        assert_eq!(shown("plain °, 日本"), "plain °, 日本");
    }

    #[test]
    fn paint_adds_nothing_but_colours() {
        let table = "┌───┐\n│ a │\n╞═══╡\n│ 1 │\n└───┘\nbelow │ it\nno end";
        let painted = painted(table);
        assert_ne!(painted, table);
        assert_eq!(anstream::adapter::strip_str(&painted).to_string(), table);
        assert_eq!(painted.matches(&Style::new().bold().to_string()).count(), 1);
    }
}
