//! What people see on a terminal: colours where there is one, none elsewhere.
//!
//! `NO_COLOR`, `CLICOLOR` and `CLICOLOR_FORCE` are heeded. What is written to a file or a
//! pipe is the text alone.

use std::io::{self, StdoutLock, Write as _};

use anstream::AutoStream;
use anstyle::{AnsiColor, Style};
use anyhow::Context as _;
use serde::Serialize;

use super::progress;

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
pub(crate) fn has_colors() -> bool {
    AutoStream::choice(&io::stdout()) != anstream::ColorChoice::Never
}

/// Prints one line on stderr. That stderr is closed is no reason to stop.
pub(crate) fn message(kind: &str, text: &str) {
    let style = match kind {
        "error" => Tone::Bad.style(),
        "warning" | "stopping" => Tone::Notice.style(),
        _ => AnsiColor::Cyan.on_default(),
    };
    progress::aside(|| {
        writeln!(anstream::stderr().lock(), "{style}{kind}:{style:#} {text}").unwrap_or_default();
    });
}

/// Prints a warning of each failure.
pub(crate) fn warn(failures: &[String]) {
    for failure in failures {
        message("warning", failure);
    }
}

/// Prints results on stdout, tables with their frames dimmed.
pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    let mut out = anstream::stdout().lock();
    let painted = if has_colors() { painted(text) } else { text.to_owned() };
    let written = out.write_all(painted.as_bytes()).and_then(|()| out.flush());
    written.context("standard output cannot be written")
}

/// Prints results on stdout as one line of JSON.
pub(crate) fn print_json(value: &impl Serialize) -> anyhow::Result<()> {
    print_with(|out| {
        serde_json::to_writer(&mut *out, value)?;
        out.write_all(b"\n")
    })
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
    fn paint_adds_nothing_but_colours() {
        let table = "┌───┐\n│ a │\n╞═══╡\n│ 1 │\n└───┘\nbelow │ it\nno end";
        let painted = painted(table);
        assert_ne!(painted, table);
        assert_eq!(anstream::adapter::strip_str(&painted).to_string(), table);
        assert_eq!(painted.matches(&Style::new().bold().to_string()).count(), 1);
    }
}
