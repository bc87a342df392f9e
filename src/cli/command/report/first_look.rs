//! What `tauscope LOG` prints: what was measured, its delays, what a model lacks, what to do next.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::args::{Args, Target};
use crate::cli::args::{DataArgs, Format, read_model};
use crate::cli::console;
use crate::cli::run::{Study, estimated};
use crate::cli::typed::quoted;
use crate::report::columns::extent;
use crate::report::estimate::estimate_table;
use crate::report::improve::improve_text;
use crate::report::page::document::Report;

/// Prints how the log was read, what was measured and its delays, as soon as they are known: models
/// take longer.
pub(super) fn show_delays(args: &Args, study: &Study<'_>) -> anyhow::Result<()> {
    if args.output.run.format == Format::Json {
        return Ok(());
    }
    study.say_notes();
    let joints = estimated(&study.experiment, &study.estimates);
    let extent = extent(study.joints().iter());
    console::print(&format!("{extent}\n\n{}\n", estimate_table(&joints, &study.settings)))?;
    let said = "searching for the effects that the models lack, which takes seconds, or minutes for \
                a long log; Ctrl-C stops the search and keeps what was found";
    study.verbosity().say("improving", said);
    Ok(())
}

/// What is to be said of the models, and the commands that lead on.
pub(super) fn rest(args: &Args, report: &Report<'_>, target: Option<&Target>) -> String {
    let mut text = String::new();
    if !report.models.is_empty() {
        text += &improve_text(report.models);
        text.push('\n');
    }
    let model = target.and_then(|target| target.model.as_deref());
    // Where no joint has a model there is no such file, and one that was there may be no model.
    let model = model.filter(|path| report.revised.is_some() && read_model(path).is_ok());
    let steps = next_steps(&args.data, target, model);
    let width = steps.iter().map(|(command, _)| command.len()).max().unwrap_or(0);
    text += "what next:\n";
    for (command, what) in steps {
        writeln!(text, "  {command:width$}  {what}").unwrap_or_default();
    }
    text
}

/// Commands, and what each of them does.
fn next_steps(
    data: &DataArgs,
    target: Option<&Target>,
    model: Option<&Path>,
) -> Vec<(String, &'static str)> {
    let typed = quoted(&data.words(None, &[]));
    let mut steps = Vec::new();
    match target {
        None => steps.push((
            format!("tauscope {typed} -o"),
            "the report and the recording, as files beside the log",
        )),
        Some(target) => {
            let path = |path: &PathBuf| quoted(&[path.display().to_string()]);
            steps.push((path(&target.path), "the report, to be opened in a browser"));
            let recording = target.recording.as_ref().map(path);
            steps.extend(
                recording.map(|path| {
                    (format!("rerun {path}"), "every decision, candidate by candidate")
                }),
            );
        }
    }
    match model {
        Some(path) => {
            let model = quoted(&[path.display().to_string()]);
            steps.push((
                format!("tauscope compare {typed} --model {model}"),
                "where the model fails, in numbers",
            ));
        }
        None => steps.push((
            format!("tauscope improve {typed} --write model.toml"),
            "the model as a file, to be used and changed",
        )),
    }
    steps.push((
        format!("tauscope estimate {typed} --decisions decisions.csv"),
        "every decision as a table",
    ));
    steps
}
