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
use crate::cli::failure::Completion;
use crate::cli::run::{Start, Study, ended};

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
    let study = Study::begin("improve", data, output, (Some(target), args.model.kept()))?;
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
    let (improved, failures) = start.outcomes(&results)?;
    let improved: Vec<_> = improved.into_iter().map(|it| ended(it, interrupt)).collect();
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
    so_far: Mutex<Vec<Improvement>>,
}

impl<'a> Stage<'a> {
    fn new(study: &'a Study<'a>, start: &'a Start<'a>) -> Self {
        let none = |_| Improvement {
            revisions: Vec::new(),
            verdict: Verdict::Unexplained,
            attribution: Attribution::default(),
        };
        Self { study, start, so_far: Mutex::new(study.joints().iter().map(none).collect()) }
    }

    /// Shows one more revision of a joint. What goes wrong is reported, and is no reason to stop:
    /// the results do not depend on the viewer.
    fn show(&self, index: usize, revision: &Step) {
        if !self.study.stream.is_open() {
            return;
        }
        let joints = self.study.joints();
        let Ok(mut so_far) = self.so_far.lock() else { return };
        let Some((joint, own)) = joints.get(index).zip(so_far.get_mut(index)) else { return };
        own.revisions.push(revision.clone());
        own.verdict = verdict_so_far(revision);
        // Of the other joints as well: on them it depends which views there are.
        let all = joints.iter().zip(&*so_far).enumerate();
        let improved =
            all.filter_map(|(index, (joint, found))| self.start.improved(index, joint, found));
        let improved: Vec<_> = improved.collect();
        if let Err(error) = self.study.show(&[], &improved, Some(&joint.name)) {
            message("warning", &format!("{error:#}"));
        }
    }
}

/// What is to be said of a revision that may not be the last.
fn verdict_so_far(revision: &Step) -> Verdict {
    match (revision.comparison.is_adequate(), revision.ranking.is_empty()) {
        (true, _) => Verdict::Adequate,
        (false, true) => Verdict::Unexplained,
        (false, false) => Verdict::MissingEffect,
    }
}
