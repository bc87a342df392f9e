//! `tauscope report`: a page with figures and numbers.

use std::ffi::OsStr;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::batch::Threads;
use crate::delay::Automatic;
use crate::experiment::{Joint, Source};
use crate::explain::{Change, Explanation, Improvement, MAX_EFFECTS, Options, Revision, Verdict};
use crate::model::{LogHash, ModelFile};
use crate::report::{
    Document, EstimatedJoint, Heading, ImprovedJoint, RecordingFile, Report, ReportJson,
    report_text, review_page,
};
use crate::study::{Known, Mode, OfJoints, explain_unknown_joints, improve_joints};
use anyhow::{Context as _, bail};
use clap::Args as ClapArgs;

use crate::cli::args::{
    AgainstArgs, AlgorithmArgs, DataArgs, EffectArgs, ProtocolArgs, ReviewArgs, RunArgs, name_of,
    note_missing, read_model,
};
use crate::cli::console::{Bar, Verbosity, message};
use crate::cli::exit::Completion;
use crate::cli::failure::{nothing_usable, said};
use crate::cli::output::{check_outputs, write_file};
use crate::cli::run::{
    self, Progress, Session, Study, StudyContext, add_arguments, compared, estimate_at, estimated,
    improved, log_hashes, others, revised,
};
use crate::cli::typed::quoted;
use crate::cli::viewer::StreamArgs;

/// Bytes of a recording up to which it is put into the page.
const EMBEDDED: u64 = 8 * 1024 * 1024;

/// Write a report: one page with figures and numbers to attach to an experiment
///
/// Per joint: the record, single decisions, delays, the table of decisions; with a model
/// also what it simulates, where it fails, and what it lacks. The page needs no network.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    data: DataArgs,

    #[command(flatten)]
    algorithm: AlgorithmArgs,

    #[command(flatten)]
    review: ReviewArgs,

    #[command(flatten)]
    against: AgainstArgs,

    #[command(flatten)]
    model: ModelArgs,

    #[command(flatten)]
    output: OutputArgs,
}

/// Which model is reported.
#[derive(ClapArgs, Debug)]
struct ModelArgs {
    /// Report this model, too (TOML, schema `tauscope/model/1`). One that `improve` made from
    /// these logs is shown as it is, with the ladder of its history; any other is fitted,
    /// starting at its values. Joints that it has not start as plain integrators
    #[arg(short, long, value_name = "MODEL.toml", help_heading = "Model")]
    model: Option<PathBuf>,

    /// Add to the model what it lacks, and report the ladder of errors. Without a model
    /// each joint starts as a plain integrator; no model file is written
    #[arg(long, help_heading = "Model")]
    improve: bool,

    #[command(flatten)]
    effects: EffectArgs,

    /// How many effects `--improve` adds at most
    #[arg(long, value_name = "N", default_value_t = MAX_EFFECTS, help_heading = "Model")]
    max_effects: usize,

    #[command(flatten)]
    protocol: ProtocolArgs,
}

/// What is written where.
#[derive(ClapArgs, Debug)]
#[command(next_help_heading = "Output")]
struct OutputArgs {
    /// The report: a page, or Markdown with its drawings in a folder `FILE_files` beside it.
    /// The recording goes beside it as `FILE.rrd`
    #[arg(short = 'o', long = "output", value_name = "FILE.html|FILE.md", required = true)]
    report: PathBuf,

    /// Put the recording into the page, if it has no more than 8 MiB
    #[arg(long, conflicts_with = "no_recording")]
    embed: bool,

    /// Write no recording
    #[arg(long)]
    no_recording: bool,

    /// Write a page beside the report, `FILE_review.html`, on which a person goes through the
    /// decisions, the most doubtful first, and saves a review
    #[arg(long)]
    interactive: bool,

    /// The title of the report, instead of the log's name
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,

    /// Whose report it is, written below the title
    #[arg(long, value_name = "NAME")]
    author: Option<String>,

    /// The date, written below the title as it is given
    #[arg(long, value_name = "TEXT")]
    date: Option<String>,

    #[command(flatten)]
    stream: StreamArgs,

    #[command(flatten)]
    run: RunArgs,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let settings = args.algorithm.only()?;
    let file = args.model.file()?;
    let options = args.model.options(&file)?;
    let target = args.output.target()?;
    let inputs = args.data.files().into_iter().chain(args.model.model.clone());
    let inputs = inputs.chain(args.review.review.clone());
    let inputs: Vec<_> = inputs.chain(args.against.against.clone()).collect();
    target.check(&inputs)?;
    let review = args.review.read()?;
    let stream = args.output.stream.open(args.output.run.verbosity())?;
    let session = Session::with_others("report", &args.data, &args.output.run, stream)?;
    let session = session.reviewed(review);
    let asked = (std::slice::from_ref(&settings), Automatic::default());
    let others = others(&session, (&args.against, &args.data), asked, &[])?;
    let session = session.with_results(others);
    let study =
        Study::of(session, &settings, |context| args.model.improved(&file, context, &options))?;
    if study.result.is_some() {
        note_missing(&file, &study.experiment().joints, study.verbosity());
    }
    Reported { args, file: &file, study: &study }.report(&target)
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
        file: &ModelFile,
        context: StudyContext<'_>,
        options: &Options,
    ) -> Option<OfJoints<Improvement>> {
        let (joints, estimates) = (context.joints, context.estimates);
        let starts = |joint: &Joint| file.joint(&joint.name).cloned();
        let protocol = self.protocol.with(Mode::FitOrIntegrator);
        if self.improve {
            let bar = context.bar("improving");
            let progress = Progress::new(file, joints, context.verbosity(), None);
            let done = |index, revision: &Revision| progress.done(index, revision);
            let protocol = protocol.watched(&bar).beside(context.others);
            return Some(improve_joints(
                joints, estimates, starts, protocol, options, done, &Threads,
            ));
        }
        self.model.as_ref()?;
        let bar = context.bar("explaining");
        let protocol = protocol.watched(&bar).beside(context.others);
        let known = |joint: &Joint| known(file, joint, &context.experiment().sources);
        let explained =
            explain_unknown_joints(joints, estimates, starts, known, protocol, options, &Threads);
        let one = |found: Option<Result<_, _>>| Some(found?.map(as_it_is));
        Some(explained.into_iter().map(one).collect())
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

/// A model and what it lacks, as the only revision.
fn as_it_is(explanation: Explanation) -> Improvement {
    let Explanation { base, verdict, ranking, attribution } = explanation;
    let revisions = vec![Revision { change: Change::Start, comparison: base, ranking }];
    Improvement { revisions, verdict, attribution }
}

impl OutputArgs {
    fn heading(&self) -> Heading<'_> {
        let Self { title, author, date, .. } = self;
        Heading { title: title.as_deref(), author: author.as_deref(), date: date.as_deref() }
    }

    fn target(&self) -> anyhow::Result<Target> {
        let path = self.report.clone();
        let kind = match path.extension().and_then(OsStr::to_str) {
            Some("html" | "htm") => Kind::Page,
            Some("md") => Kind::Markdown,
            _ => bail!("{}: a report is called FILE.html or FILE.md", path.display()),
        };
        let has_recordings = cfg!(feature = "rrd");
        if self.embed && kind == Kind::Markdown {
            bail!("--embed needs a page: Markdown cannot hold a file; use `-o FILE.html`");
        }
        if self.embed && !has_recordings {
            bail!("this program was built without recordings: build it with feature `rrd`");
        }
        let recording = has_recordings && !self.no_recording;
        let recording = recording.then(|| path.with_extension("rrd"));
        let review = self.interactive.then(|| beside(&path, "_review.html"));
        Ok(Target { path, kind, recording, review })
    }
}

/// Where the report and its recording go.
struct Target {
    path: PathBuf,
    kind: Kind,
    recording: Option<PathBuf>,
    /// The page to review the decisions on.
    review: Option<PathBuf>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Page,
    Markdown,
}

impl Target {
    /// Refuses what cannot be written.
    fn check(&self, inputs: &[PathBuf]) -> anyhow::Result<()> {
        let outputs = [self.path.as_path()].into_iter().chain(self.recording.as_deref());
        let outputs = outputs.chain(self.review.as_deref());
        check_outputs(&outputs.collect::<Vec<_>>(), inputs)?;
        let folder = self.folder();
        if self.kind == Kind::Markdown && folder.exists() && !folder.is_dir() {
            bail!("{}: the drawings need a folder of this name", folder.display());
        }
        let folder = folder.canonicalize().unwrap_or(folder);
        let inside =
            |input: &&PathBuf| input.canonicalize().is_ok_and(|input| input.starts_with(&folder));
        if let Some(input) = inputs.iter().find(inside) {
            bail!(
                "{}: a file that is read lies in the folder of the drawings; give the report another \
                 name",
                input.display()
            );
        }
        Ok(())
    }

    /// Where the drawings of Markdown go.
    fn folder(&self) -> PathBuf {
        beside(&self.path, "_files")
    }

    fn write(&self, document: &Document) -> anyhow::Result<()> {
        let text = match self.kind {
            Kind::Page => document.html(),
            Kind::Markdown => {
                let folder = self.folder();
                let markdown = document.markdown(&file_name(&folder));
                fs::create_dir_all(&folder)
                    .with_context(|| format!("{}: cannot be made", folder.display()))?;
                for (name, drawing) in &markdown.files {
                    let place = folder.join(name);
                    // It may lead to a log.
                    if place.is_symlink() {
                        let place = place.display();
                        bail!("{place}: a link, and drawings are files of their own; remove it");
                    }
                    write_text(&place, drawing)?;
                }
                markdown.text
            }
        };
        write_text(&self.path, &text)
    }
}

/// The name of `path` with another ending.
fn beside(path: &Path, ending: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}{ending}"))
}

fn write_text(path: &Path, text: &str) -> anyhow::Result<()> {
    write_file(path, |file| Ok(file.write_all(text.as_bytes())?))
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// What is asked, and what came of it.
struct Reported<'a> {
    args: &'a Args,
    file: &'a ModelFile,
    study: &'a Study<'a, Option<OfJoints<Improvement>>>,
}

impl Reported<'_> {
    /// Writes the report of what was found.
    fn report(&self, target: &Target) -> anyhow::Result<Completion> {
        let Self { args, file, study } = *self;
        let experiment = study.experiment();
        let name = name_of(args.model.model.as_deref());
        let mut failures = run::failures(experiment, &study.estimates);
        let joints = estimated(experiment, &study.estimates);
        if joints.is_empty() {
            return Err(nothing_usable(failures.last()));
        }
        let model = args.model.model.as_ref();
        let model =
            model.map_or_else(|| "model.toml".to_owned(), |path| path.display().to_string());
        let protocol = &args.model.protocol;
        let arguments = add_arguments(&args.data, protocol, &model, &experiment.joints);
        let mut models = Vec::new();
        let joints_of_models = experiment.joints.iter().zip(&arguments);
        let results = study.result.iter().flatten().enumerate();
        for ((joint, arguments), (index, result)) in joints_of_models.zip(results) {
            match result {
                Some(Ok(found)) => {
                    let delays = estimate_at(&study.estimates, index);
                    models.extend(improved(file, &name, joint, (found, delays), arguments));
                }
                Some(Err(error)) => {
                    failures.push(format!("joint `{}`: no model: {}", joint.name, said(error)));
                }
                None => {}
            }
        }
        self.write(&joints, &models, &failures, target)
    }

    fn write(
        &self,
        joints: &[EstimatedJoint<'_>],
        models: &[ImprovedJoint<'_>],
        failures: &[String],
        target: &Target,
    ) -> anyhow::Result<Completion> {
        let Self { args, study, .. } = *self;
        let experiment = study.experiment();
        let against = compared(joints, study.beside())?;
        let further = run::left_over(&against, &args.data);
        let notes = experiment.notes.iter().cloned().chain(run::notes(joints));
        let notes: Vec<String> = notes.chain(further).collect();
        let revised = (!models.is_empty()).then(|| self.revised(models)).transpose()?;
        let embedded = self.record(models, target)?;
        let recording_name = target.recording.as_deref().map(file_name);
        let recording = recording_name
            .as_deref()
            .map(|name| RecordingFile { name, bytes: embedded.as_deref() });
        let report = Report {
            heading: args.output.heading(),
            experiment,
            joints,
            settings: &study.settings,
            models,
            against: &against,
            revised: revised.as_ref().map(ModelFile::text),
            split: args.model.protocol.split(),
            command: &command(),
            recording,
            notes: &notes,
            failures,
        };
        {
            let _bar = Bar::spinner(study.verbosity(), "writing the report");
            target.write(&report.document()?)?;
            if let Some(path) = &target.review {
                write_text(path, &review_page(&report)?)?;
            }
        }
        if study.verbosity() == Verbosity::Normal {
            for note in &notes {
                message("note", note);
            }
            message("report", &target.path.display().to_string());
            if let Some(path) = &target.review {
                message("review", &format!("{}; open it in a browser", path.display()));
            }
        }
        let path = |path: &Path| path.display().to_string();
        let recording = target.recording.as_deref().map(path);
        let json = || ReportJson::new(&report, path(&target.path), recording);
        study.end(failures, || report_text(&report), json)
    }

    /// Writes the recording; its bytes, where they are to be in the page.
    fn record(
        &self,
        models: &[ImprovedJoint<'_>],
        target: &Target,
    ) -> anyhow::Result<Option<Vec<u8>>> {
        let names = run::revision_names(models);
        let compared: Vec<_> = models.iter().flat_map(|joint| run::models(joint, &names)).collect();
        self.study.record(target.recording.as_deref(), &compared, models)?;
        let Some(path) = target.recording.as_ref().filter(|_| self.args.output.embed) else {
            return Ok(None);
        };
        let size = fs::metadata(path).map_or(u64::MAX, |file| file.len());
        if size > EMBEDDED {
            let name = path.display();
            message("note", &format!("{name}: too large for the page; it is beside it"));
            return Ok(None);
        }
        let bytes = fs::read(path);
        Ok(Some(bytes.with_context(|| format!("{}: cannot be read", path.display()))?))
    }

    /// The model file with the fitted models in it.
    fn revised(&self, models: &[ImprovedJoint<'_>]) -> anyhow::Result<ModelFile> {
        let mut file = revised(self.file, models, &self.study.experiment().sources)?;
        for joint in models.iter().filter(|joint| joint.revisions.len() == 1) {
            let compared = &joint.finding.compared;
            file = file.refitted(&compared.joint.name, &compared.comparison.fit.model)?;
        }
        Ok(file)
    }
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
