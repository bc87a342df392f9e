//! `tauscope doctor`: what is there to look at recordings with, and what is missing.

mod check;
mod surroundings;
mod viewer;

use std::fmt::Write as _;

use clap::Args as ClapArgs;
use serde::Serialize;

use check::{Check, Found, State};

use crate::cli::args::Format;
use crate::cli::console::{self, Tone};
use crate::cli::exit::Completion;
use crate::report::Header;

/// Say what is missing to make recordings and to look at them
///
/// It looks for the Rerun viewer and its version, for a screen, and at this program and the
/// terminal; each line that is not `ok` names the remedy. Exit status 1 when something is
/// missing.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// How results are printed
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// JSON, schema `tauscope/doctor/1`.
#[derive(Serialize)]
struct DoctorJson<'a> {
    #[serde(flatten)]
    header: Header,
    /// Nothing is missing.
    complete: bool,
    checks: &'a [Check],
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let mut checks = vec![Check { name: "program", found: surroundings::program() }];
    checks.extend(viewer::check());
    checks.extend(surroundings::all());
    let complete = checks.iter().all(|check| check.found.state != State::Missing);
    let header = Header::of("tauscope/doctor/1");
    let json = DoctorJson { header, complete, checks: &checks };
    args.format.print(|| text(&checks), || json)?;
    Ok(if complete { Completion::Whole } else { Completion::Partial })
}

fn text(checks: &[Check]) -> String {
    let mut text = String::new();
    let width = checks.iter().map(|check| check.name.len()).max().unwrap_or(0);
    for Check { name, found: Found { state, found, remedy } } in checks {
        let (word, tone) = match state {
            State::Ok => ("ok", Tone::Good),
            State::Note => ("note", Tone::Notice),
            State::Missing => ("missing", Tone::Bad),
        };
        let word = console::toned(tone, &format!("{word:<7}"));
        writeln!(text, "{word}  {name:<width$}  {found}").unwrap_or_default();
        if let Some(remedy) = remedy {
            writeln!(text, "{:9}{:width$}  → {remedy}", "", "").unwrap_or_default();
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_thing_has_a_line_and_what_is_missing_a_remedy() {
        let found = [("threads", check::ok("2")), ("viewer", check::missing("none", "install it"))];
        let checks = found.map(|(name, found)| Check { name, found });
        let text = anstream::adapter::strip_str(&text(&checks)).to_string();
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        assert_eq!(
            lines,
            ["ok       threads  2", "missing  viewer   none", "                  → install it"]
        );
    }
}
