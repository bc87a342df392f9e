//! `tauscope report`: a page with figures and numbers. `tauscope LOG`: the same in the terminal.

mod args;
mod first_look;

use std::path::Path;

use crate::batch::Threads;
use crate::experiment::{Joint, Source};
use crate::explain::{Improvement, Options, Revision, Verdict};
use crate::model::{LogHash, ModelFile};
use crate::report::answer::input_note;
use crate::report::page::compose::{report_json, report_text};
use crate::report::page::document::Report;
use crate::report::review_page::review_page;
use crate::report::{EstimatedJoint, ImprovedJoint};
use crate::study::{Known, Mode, OfJoints, explain_unknown_joints, improve_joints};
use anyhow::bail;
pub(crate) use args::Args;
use args::ModelArgs;
use args::{Target, file_name};

use crate::cli::args::{add_arguments, read_model};
use crate::cli::console::{Bar, Interrupt, STOPPING, Verbosity};
use crate::cli::failure::Completion;
use crate::cli::failure::{nothing_usable, said};
use crate::cli::output::write_bytes;
use crate::cli::run::{
    self, Session, Start, Study, as_it_is, compared, ended, estimated, log_hashes, others,
};
use crate::cli::typed::quoted;

/// Where the files of a first look go for which no name is given.
pub(crate) const BESIDE_THE_LOG: &str = ".";

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    report(args, Target::of(&args.output)?.as_ref(), Shown::Sentences)
}

/// `tauscope LOG`: shows in the terminal what a report says. The report, with the recording, is
/// written where `-o` is given: beside the log unless a name is.
pub(crate) fn first_look(args: &mut Args) -> anyhow::Result<Completion> {
    args.model.improve |= args.model.model.is_none();
    if let Some(path) = &mut args.output.report {
        match args.data.given() {
            _ if path != Path::new(BESIDE_THE_LOG) => {
                // The recording may be named as well as the report.
                if path.extension().is_none_or(|ending| ending == "rrd") {
                    path.set_extension("html");
                }
            }
            [log] => *path = log.with_extension("html"),
            logs => bail!("-o: of {} logs the report needs a name: `-o FILE.html`", logs.len()),
        }
    }
    let target = Target::of(&args.output)?;
    let target = target.map(|target| if args.model.improve { target.with_model() } else { target });
    report(args, target.as_ref(), Shown::Everything)
}

/// What is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    /// A sentence or two per joint, as at the head of the page.
    Sentences,
    /// The tables of `estimate` and `improve`, and what to do next.
    Everything,
}

/// Does what is asked, prints what is `shown`, and writes the files of `target`.
fn report(args: &Args, target: Option<&Target>, shown: Shown) -> anyhow::Result<Completion> {
    let settings = args.algorithm.only()?;
    let file = args.model.file()?;
    let options = args.model.options(&file)?;
    let inputs = args.data.files().into_iter().chain(args.model.model.clone());
    let inputs = inputs.chain(args.review.review.clone());
    let inputs: Vec<_> = inputs.chain(args.against.against.clone()).collect();
    if let Some(target) = target {
        target.check(&inputs)?;
    }
    let review = args.review.read()?;
    let stream = args.output.stream.open(args.output.run.verbosity())?;
    let reading = args.data.options_with_others()?;
    let session = Session::begin("report", &args.data, &reading, (&args.output.run, stream))?;
    let mut session = session.reviewed(review);
    let asked = std::slice::from_ref(&settings);
    session.beside = others(&session, (&args.against, &args.data), asked, &[])?;
    let study = Study::of(session, &settings)?;
    if shown == Shown::Everything {
        first_look::show_delays(args, &study)?;
    }
    let path = args.model.model.as_ref().or(target.and_then(|target| target.model.as_ref()));
    let path = path.map_or_else(|| "model.toml".to_owned(), |path| path.display().to_string());
    let arguments = add_arguments(&args.data, &path, study.joints());
    let start = Start::of(&study, &file, args.model.model.as_deref(), arguments)?;
    let (results, interrupt) = args.model.improved(&start, &file, &study, &options)?;
    let mut failures = run::failures(&study.experiment, &study.estimates);
    let joints = estimated(&study.experiment, &study.estimates);
    if joints.is_empty() {
        return Err(nothing_usable(failures.last()));
    }
    let mut models = Vec::new();
    for (index, (joint, result)) in study.joints().iter().zip(&results).enumerate() {
        match result {
            Some(Ok(found)) => models.extend(start.improved(index, joint, found)),
            Some(Err(error)) => {
                failures.push(format!("joint `{}`: no model: {}", joint.name, said(error)));
            }
            None => {}
        }
    }
    for model in &mut models {
        let searched = interrupt.map_or(*model, |interrupt| ended(*model, interrupt));
        *model = searched.since_its_beginning();
    }
    Reported { args, start: &start, study: &study, shown }
        .write(&joints, &models, &failures, target)
}

impl ModelArgs {
    /// The model file; an empty one where there is none.
    fn file(&self) -> anyhow::Result<ModelFile> {
        Ok(self.model.as_deref().map(read_model).transpose()?.unwrap_or_default())
    }

    fn options(&self, file: &ModelFile) -> anyhow::Result<Options> {
        let options = self.effects.options(file.candidates())?;
        Ok(Options { max_effects: self.max_effects, ..options })
    }

    /// The model of each joint with what it lacks; none where no model is asked for.
    fn improved(
        &self,
        start: &Start<'_>,
        file: &ModelFile,
        study: &Study<'_>,
        options: &Options,
    ) -> anyhow::Result<Improved> {
        let (joints, estimates) = (study.joints(), &study.estimates);
        let starts = |joint: &Joint| start.model(joint);
        let protocol = self.protocol.with(Mode::FitOrIntegrator);
        if self.improve {
            let interrupt = Interrupt::watch(STOPPING);
            let done = |index, revision: &Revision| {
                start.say(index, revision);
                !interrupt.was_pressed()
            };
            let models = study.work("improving", |bar, others| {
                let protocol = protocol.watched(bar).beside(others);
                improve_joints(joints, estimates, starts, protocol, options, done, &Threads)
            })?;
            return Ok((models, Some(interrupt)));
        }
        if self.model.is_some() {
            let known = |joint: &Joint| known(file, joint, &study.experiment.sources);
            let explained = study.work("explaining", |bar, others| {
                let watched = protocol.watched(bar).beside(others);
                explain_unknown_joints(joints, estimates, starts, known, watched, options, &Threads)
            })?;
            let models = explained.into_iter().map(|found| Some(found?.map(as_it_is)));
            return Ok((models.collect(), None));
        }
        Ok((Vec::new(), None))
    }
}

/// What the file says of the model of `joint`, where it was made from these very logs.
fn known(file: &ModelFile, joint: &Joint, sources: &[Source]) -> Option<Known> {
    let fitted = file.fitted(&joint.name)?;
    let hashes = |logs: &[LogHash]| logs.iter().map(|log| log.sha256.clone()).collect::<Vec<_>>();
    if hashes(&fitted.logs) != hashes(&log_hashes(sources)) {
        return None;
    }
    let last = file.history(&joint.name).last().map(|revision| &revision.errors);
    let rmse = last.or(fitted.start.as_ref())?.judged()?;
    Some(Known { rmse, verdict: Verdict::by_id(fitted.verdict.as_deref()?)? })
}

/// The models of all joints, and who may have stopped the search for what they lack.
type Improved = (OfJoints<Improvement>, Option<Interrupt>);

/// What is asked, and what came of it.
struct Reported<'a> {
    args: &'a Args,
    start: &'a Start<'a>,
    study: &'a Study<'a>,
    shown: Shown,
}

impl Reported<'_> {
    /// Writes the report of what was found.
    fn write(
        &self,
        joints: &[EstimatedJoint<'_>],
        models: &[ImprovedJoint<'_>],
        failures: &[String],
        target: Option<&Target>,
    ) -> anyhow::Result<Completion> {
        let Self { args, study, .. } = *self;
        let experiment = &study.experiment;
        let against = compared(joints, &study.beside)?;
        let notes = experiment.notes.iter().cloned().chain(run::notes(joints));
        let notes: Vec<String> = notes.collect();
        let revised = (!models.is_empty()).then(|| self.revised(models)).transpose()?;
        let recording_path = target.and_then(|target| target.recording.as_deref());
        study.record_revisions(recording_path, models)?;
        let recording_name = recording_path.map(file_name);
        let command = command();
        let has_models = args.model.improve || args.model.model.is_some();
        let with_models = (!has_models).then(|| format!("{command} --improve"));
        let report = Report {
            title: args.output.title.as_deref(),
            experiment,
            joints,
            settings: &study.settings,
            models,
            against: &against,
            revised: revised.as_ref().map(ModelFile::text),
            command: &command,
            with_models: with_models.as_deref(),
            recording: recording_name.as_deref(),
            notes: &notes,
            failures,
        };
        // Those on the logs are said by the session.
        // The tables are printed with what is said of the inputs.
        let with_tables = joints.iter().filter(|_| self.shown == Shown::Everything);
        let printed: Vec<String> = with_tables.filter_map(input_note).collect();
        let others = notes.iter().skip(experiment.notes.len());
        for note in others.filter(|note| !printed.contains(note)) {
            study.verbosity().say("note", note);
        }
        if let Some(target) = target {
            write_files(&report, target, study.verbosity())?;
        }
        if let Some((path, file)) =
            target.and_then(|target| target.model.as_ref()).zip(revised.as_ref())
        {
            write_model(path, file, study.verbosity())?;
        }
        let path = target.map(|target| target.path.display().to_string());
        let recording = recording_path.map(|path| path.display().to_string());
        let json = || report_json(&report, path.as_deref(), recording.as_deref());
        let text = || match self.shown {
            Shown::Sentences => report_text(&report),
            Shown::Everything => first_look::rest(args, &report, target),
        };
        let completion = study.end(failures, text, json)?;
        let is_whole = models.iter().all(|joint| !joint.interrupted);
        Ok(if is_whole { completion } else { Completion::Partial })
    }

    /// The model file with the fitted models in it.
    fn revised(&self, models: &[ImprovedJoint<'_>]) -> anyhow::Result<ModelFile> {
        let mut file = self.start.revised(models, |joint| Some(joint.finding.verdict))?;
        for joint in models.iter().filter(|joint| joint.revisions.len() == 1) {
            let compared = &joint.finding.compared;
            file = file.refitted(&compared.joint.name, &compared.comparison.fit.model)?;
        }
        Ok(file)
    }
}

/// Writes the model, unless there is a file of its name, which may have been edited.
fn write_model(path: &Path, file: &ModelFile, verbosity: Verbosity) -> anyhow::Result<()> {
    if path.exists() {
        let name = path.display();
        verbosity.say("note", format!("{name}: exists already and is not replaced"));
        return Ok(());
    }
    write_bytes(path, file.text())?;
    verbosity.say("model", path.display().to_string());
    Ok(())
}

/// Writes the page, and the one to review the decisions on.
fn write_files(report: &Report<'_>, target: &Target, verbosity: Verbosity) -> anyhow::Result<()> {
    {
        let _bar = Bar::spinner(verbosity, "writing the report");
        write_bytes(&target.path, report.document().html())?;
        if let Some(path) = &target.review {
            write_bytes(path, review_page(report))?;
        }
    }
    verbosity.say("report", target.path.display().to_string());
    if let Some(path) = &target.review {
        verbosity.say("review", format!("{}; open it in a browser", path.display()));
    }
    Ok(())
}

/// The command as it was typed, but for what changes nothing of the report.
fn command() -> String {
    let typed = std::env::args_os().skip(1);
    let typed = typed.map(|word| word.to_string_lossy().into_owned());
    quoted(&["tauscope".to_owned()].into_iter().chain(in_the_report(typed)).collect::<Vec<_>>())
}

/// The words that say what is in the report.
fn in_the_report(words: impl Iterator<Item = String>) -> Vec<String> {
    let mut kept = Vec::new();
    let mut words = words;
    while let Some(word) = words.next() {
        match word.as_str() {
            "-q" | "--quiet" => {}
            "--threads" | "--format" => drop(words.next()),
            _ if word.starts_with("--threads=") || word.starts_with("--format=") => {}
            _ => kept.push(word),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_tells_what_is_in_the_report() {
        let typed = "report log.csv --threads 3 -o r.html --quiet --format=json --beta 2";
        let kept = in_the_report(typed.split(' ').map(str::to_owned));
        assert_eq!(kept.join(" "), "report log.csv -o r.html --beta 2");
    }
}
