//! `tauscope design`: the next experiment.

use std::path::{Path, PathBuf};

use anyhow::bail;
use known::Known;

use crate::cli::console::{Bar, warn};
use crate::cli::failure::{Completion, nothing_usable, read_failures, said};
use crate::cli::output::{OutputKind, Outputs, write_bytes, write_file};
use crate::report::design::{DesignedJoint, design_json, input_table, preview_table};
use crate::report::design_words::design_text;
use crate::report::page::design::design_document;

mod args;
mod known;
mod random;
mod separate;

pub(crate) use args::Args;

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let inputs: Vec<PathBuf> = args.data.iter().chain(&args.model).cloned().collect();
    let preview = args.preview.as_deref();
    let kind = if preview.is_some_and(is_page) { OutputKind::Other } else { OutputKind::Log };
    Outputs::default().with(OutputKind::Log, &args.output).with(kind, preview).check(&inputs)?;
    let (known, joints, failures) = args.run.in_threads(|| {
        let known = Known::new(args)?;
        for note in known.experiment.iter().flat_map(|experiment| &experiment.notes) {
            args.run.verbosity().say("note", note);
        }
        warn(&known.cautions());
        let (joints, failures) = designed(args, &known)?;
        anyhow::Ok((known, joints, failures))
    })??;
    if let Some(path) = &args.output {
        write_file(path, |file| Ok(input_table(&joints).write_csv(file)?))?;
        args.run.verbosity().say("input", path.display().to_string());
    }
    if let Some(path) = preview {
        if is_page(path) {
            let sources = known.experiment.as_ref().map_or(&[][..], |read| &read.sources);
            write_bytes(path, design_document(&joints, sources).html())?;
        } else {
            write_file(path, |file| Ok(preview_table(&joints).write_csv(file)?))?;
        }
        args.run.verbosity().say("preview", path.display().to_string());
    }
    warn(&failures);
    let json = || design_json(args.seed, &joints, &failures);
    args.run.format.print(|| design_text(&joints), json)?;
    Ok(Completion::without(&failures))
}

/// Whether a preview of this name is a page.
fn is_page(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("html"))
}

/// The inputs of all joints, and messages on those that have none.
fn designed(args: &Args, known: &Known) -> anyhow::Result<(Vec<DesignedJoint>, Vec<String>)> {
    /// Joints of one plan: its rows have a cell for each, and each is simulated.
    const MOST_JOINTS: usize = 1000;
    let count = known.names.len();
    if count > MOST_JOINTS {
        bail!("{count} joints; a plan is for {MOST_JOINTS} at most: choose some with --joint");
    }
    let bar = Bar::spinner(args.run.verbosity(), "designing");
    let results = if args.separate.is_empty() {
        random::designed(args, known, &bar)
    } else {
        separate::designed(args, known, &bar)?
    };
    let mut failures = known.experiment.as_ref().map(read_failures).unwrap_or_default();
    let mut joints = Vec::new();
    for (name, result) in known.names.iter().zip(results) {
        match result {
            Ok(joint) => joints.push(joint),
            Err(error) => failures.push(format!("joint `{name}`: {}", said(error.as_ref()))),
        }
    }
    match failures.first() {
        Some(first) if joints.is_empty() => Err(nothing_usable(Some(first))),
        _ => Ok((joints, failures)),
    }
}
