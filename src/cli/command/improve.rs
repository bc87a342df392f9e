//! `tauscope improve`: explain and add until nothing significant is left.

use std::sync::Mutex;

use crate::batch::Threads;
use crate::experiment::Joint;
use crate::explain::{Attribution, Improvement, MAX_EFFECTS, Options, Revision as Step, Verdict};
use crate::model::ModelFile;
use crate::report::improve::{improve_json, improve_text};
use crate::study::{Mode, improve_joints};
use clap::Args as ClapArgs;

use crate::cli::args::number::whole;
use crate::cli::args::{
    DataArgs, EffectArgs, ModelFileArgs, ProtocolArgs, ResultArgs, add_arguments,
};
use crate::cli::console::{Interrupt, STOPPING, message};
use crate::cli::each_log::{Each, FolderArgs};
use crate::cli::exit::Completion;
use crate::cli::failure::outcomes;
use crate::cli::run::{Shown, Start, Study, ended};

/// Add to a model what it lacks, effect by effect
///
/// After each effect, those added before that have become superfluous are removed; effects
/// that the model file had stay. It ends when no lack of fit is shown, or when no effect
/// accounts for it. Ctrl-C ends it after the current revision.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    data: DataArgs,

    #[command(flatten)]
    model: ModelFileArgs,

    #[command(flatten)]
    effects: EffectArgs,

    /// How many effects are added at most
    #[arg(long, value_name = "N", default_value_t = MAX_EFFECTS, value_parser = whole::<usize>)]
    max_effects: usize,

    /// Keep effects that are significant but have no practical consequence: without them the error
    /// grows by less than 3 % of the initial error beyond the noise
    #[arg(long)]
    refine: bool,

    #[command(flatten)]
    protocol: ProtocolArgs,

    #[command(flatten)]
    output: ResultArgs,

    #[command(flatten)]
    folder: FolderArgs,
}

/// Improves a model of each log by itself.
fn each_log(args: &Args) -> anyhow::Result<Completion> {
    args.folder.run(&Each {
        command: "improve",
        data: &args.data,
        decisions: None,
        refused: &[
            ("--output", args.output.recording.is_some()),
            ("--connect, --spawn or --serve", args.output.stream.is_asked()),
            ("--write", args.model.is_written_elsewhere()),
        ],
        run: &args.output.run,
    })
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    if args.folder.is_asked_for() {
        return each_log(args);
    }
    let file = args.model.read()?;
    let options = args.options(&file)?;
    let target = args.model.target();
    let (data, output) = (&args.data, &args.output);
    let interrupt = Interrupt::watch(STOPPING);
    let study = Study::begin(
        ("improve", Shown::ByRevision),
        data,
        output,
        (Some(target), args.model.kept()),
    )?;
    let joints = study.joints();
    let arguments = add_arguments(data, &target.display().to_string(), joints);
    let start = Start::of(&study, &file, Some(target), arguments)?;
    args.model.check_target(&file, joints)?;
    let stage = Stage::new(&study, &start);
    let starts = |joint: &Joint| start.model(joint);
    let protocol = args.protocol.with(Mode::FitOrIntegrator);
    let done = |index, revision: &Step| {
        stage.show(index, revision);
        start.say(index, revision);
        !interrupt.was_pressed()
    };
    let results = study.work("improving", |bar, others| {
        let watched = protocol.watched(bar).beside(others);
        improve_joints(joints, &study.estimates, starts, watched, &options, done, &Threads)
    })?;
    let improved = |index, joint, found| start.improved(index, joint, found);
    let (improved, failures) = outcomes(&study.experiment, &results, improved)?;
    let improved = improved.into_iter().flatten();
    let improved: Vec<_> = improved.map(|joint| ended(joint, interrupt)).collect();
    study.record_revisions(output.recording.as_deref(), &improved)?;
    let revised = start.revised(&improved, |joint| Some(joint.finding.verdict))?;
    args.model.write(&file, &revised, study.verbosity())?;
    let text = || improve_text(&improved);
    let completion = study.end(&failures, text, || improve_json(&improved, &failures))?;
    let is_whole = improved.iter().all(|joint| !joint.interrupted);
    Ok(if is_whole { completion } else { Completion::Partial })
}

impl Args {
    fn options(&self, file: &ModelFile) -> anyhow::Result<Options> {
        Ok(Options {
            max_effects: self.max_effects,
            keeps_refinements: self.refine,
            keeps_series: self.output.is_recorded(),
            ..self.effects.options(file.candidates())?
        })
    }
}

/// The revisions so far, shown to whoever looks on.
struct Stage<'a> {
    study: &'a Study<'a>,
    start: &'a Start<'a>,
    /// Per joint.
    steps: Vec<Mutex<Vec<Step>>>,
}

impl<'a> Stage<'a> {
    fn new(study: &'a Study<'a>, start: &'a Start<'a>) -> Self {
        let steps = study.joints().iter().map(|_| Mutex::default()).collect();
        Self { study, start, steps }
    }

    /// Shows one more revision of a joint. What goes wrong is reported, and is no reason to stop:
    /// the results do not depend on the viewer.
    fn show(&self, index: usize, revision: &Step) {
        if !self.study.stream.is_open() {
            return;
        }
        let of_joint = self.study.joints().get(index).zip(self.steps.get(index));
        let Some((joint, steps)) = of_joint else { return };
        let Ok(mut steps) = steps.lock() else { return };
        steps.push(revision.clone());
        let (revisions, attribution) = (steps.clone(), Attribution::default());
        let improvement = Improvement { revisions, verdict: so_far(revision), attribution };
        let improved = self.start.improved(index, joint, &improvement);
        let revisions: Vec<_> = improved.into_iter().collect();
        if let Err(error) = self.study.show(&[], &revisions, Some(&joint.name)) {
            message("warning", &format!("{error:#}"));
        }
    }
}

/// What is to be said of a revision that may not be the last.
fn so_far(revision: &Step) -> Verdict {
    match (revision.comparison.is_adequate(), revision.ranking.is_empty()) {
        (true, _) => Verdict::Adequate,
        (false, true) => Verdict::Unexplained,
        (false, false) => Verdict::MissingEffect,
    }
}
