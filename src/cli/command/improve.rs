//! `tauscope improve`: explain and add until nothing significant is left.

use std::sync::Mutex;

use crate::batch::Threads;
use crate::experiment::Joint;
use crate::explain::{Attribution, Improvement, MAX_EFFECTS, Options, Revision as Step, Verdict};
use crate::model::ModelFile;
use crate::report::{ImproveJson, improve_text};
use crate::study::{Mode, OfJoints, improve_joints};
use clap::Args as ClapArgs;

use crate::cli::args::{
    DataArgs, EffectArgs, ModelFileArgs, ProtocolArgs, ResultArgs, name_of, note_missing,
};
use crate::cli::console::{Interrupt, STOPPING, message};
use crate::cli::each_log::{Each, FolderArgs};
use crate::cli::exit::Completion;
use crate::cli::output::check_recorded;
use crate::cli::run::{
    Progress, Session, Study, StudyContext, add_arguments, estimate_at, improved, models, outcomes,
    revised, revision_names,
};

/// Add to a model what it lacks, effect by effect
///
/// After each effect, those that were added before and have become useless are removed
/// again; effects that the model file had stay. It ends when no lack of fit is shown, or
/// when no effect accounts for it. Ctrl-C ends it after the revision at hand.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    data: DataArgs,

    #[command(flatten)]
    model: ModelFileArgs,

    #[command(flatten)]
    effects: EffectArgs,

    /// How many effects are added at most
    #[arg(long, value_name = "N", default_value_t = MAX_EFFECTS)]
    max_effects: usize,

    /// Keep effects that are significant and have no practical consequence: without them
    /// the error grows by less than 1 % of the first
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
fn each_log(args: &Args, program: &clap::Command) -> anyhow::Result<Completion> {
    args.folder.run(&Each {
        program,
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

pub(crate) fn run(args: &Args, program: &clap::Command) -> anyhow::Result<Completion> {
    if args.folder.is_asked_for() {
        return each_log(args, program);
    }
    let file = args.model.read()?;
    let options = args.options(&file)?;
    let target = args.model.target();
    check_recorded(
        args.output.recording.as_deref(),
        &[target],
        &[args.data.files(), args.model.kept()].concat(),
    )?;
    let stream = args.output.stream.open(args.output.run.verbosity())?.expecting_revisions()?;
    let interrupt = Interrupt::watch(STOPPING);
    let session = Session::with_others("improve", &args.data, &args.output.run, stream)?;
    let name = name_of(Some(target));
    let protocol = args.protocol.with(Mode::FitOrIntegrator);
    let study = Study::of(session, &args.output.delay_settings(), |context| {
        let (joints, estimates, bar) =
            (context.joints, context.estimates, context.bar("improving"));
        let progress = Progress::new(&file, joints, context.verbosity(), Some(interrupt));
        let arguments = args.add_arguments(joints);
        let stage = Stage::new(context, &file, &name, &arguments);
        let starts = |joint: &Joint| file.joint(&joint.name).cloned();
        let done = |index, revision: &Step| {
            stage.show(index, revision);
            progress.done(index, revision)
        };
        let improved = improve_joints(
            joints,
            estimates,
            starts,
            protocol.watched(&bar).beside(context.others),
            &options,
            done,
            &Threads,
        );
        (improved, progress.stopped())
    })?;
    args.end(&study, (&file, &name))
}

impl Args {
    /// Says and writes what came of each joint.
    fn end(
        &self,
        study: &Study<'_, (OfJoints<Improvement>, Vec<bool>)>,
        (file, name): (&ModelFile, &str),
    ) -> anyhow::Result<Completion> {
        let joints = &study.experiment().joints;
        note_missing(file, joints, study.verbosity());
        let ((results, stopped), arguments) = (&study.result, self.add_arguments(joints));
        let improved = |index: usize, joint, improvement| {
            let stopped = stopped.get(index).is_some_and(|stopped| *stopped);
            let add_arguments = arguments.get(index)?;
            let found = (improvement, estimate_at(&study.estimates, index));
            let improved = improved(file, name, joint, found, add_arguments)?;
            Some(if stopped { improved.stopped() } else { improved })
        };
        let (improved, failures) = outcomes(study.experiment(), results, improved)?;
        let improved: Vec<_> = improved.into_iter().flatten().collect();
        if self.output.is_recorded() {
            let names = revision_names(&improved);
            let models: Vec<_> = improved.iter().flat_map(|joint| models(joint, &names)).collect();
            study.record(self.output.recording.as_deref(), &models, &improved)?;
        }
        self.model.write(
            file,
            &revised(file, &improved, &study.experiment().sources)?,
            study.verbosity(),
        )?;
        let text = || improve_text(&improved);
        let completion = study.end(&failures, text, || ImproveJson::new(&improved, &failures))?;
        let is_whole = improved.iter().all(|joint| !joint.interrupted);
        Ok(if is_whole { completion } else { Completion::Partial })
    }

    fn options(&self, file: &ModelFile) -> anyhow::Result<Options> {
        Ok(Options {
            max_effects: self.max_effects,
            keeps_refinements: self.refine,
            keeps_series: self.output.is_recorded(),
            ..self.effects.options(file.candidates())?
        })
    }

    /// What follows the effect in the command that adds one more, for each joint.
    fn add_arguments(&self, joints: &[Joint]) -> Vec<String> {
        let model = self.model.target().display().to_string();
        add_arguments(&self.data, &self.protocol, &model, joints)
    }
}

/// The revisions so far, shown to whoever looks on.
struct Stage<'a> {
    context: StudyContext<'a>,
    file: &'a ModelFile,
    name: &'a str,
    arguments: &'a [String],
    /// Per joint.
    steps: Vec<Mutex<Vec<Step>>>,
}

impl<'a> Stage<'a> {
    fn new(
        context: StudyContext<'a>,
        file: &'a ModelFile,
        name: &'a str,
        arguments: &'a [String],
    ) -> Self {
        let steps = context.joints.iter().map(|_| Mutex::default()).collect();
        Self { context, file, name, arguments, steps }
    }

    /// Shows one more revision of a joint. What goes wrong is reported, and is no reason to stop:
    /// the results do not depend on the viewer.
    fn show(&self, index: usize, revision: &Step) {
        if !self.context.is_shown() {
            return;
        }
        let of_joint = self.context.joints.get(index).zip(self.steps.get(index));
        let Some((joint, steps)) = of_joint else { return };
        let Ok(mut steps) = steps.lock() else { return };
        steps.push(revision.clone());
        let (revisions, attribution) = (steps.clone(), Attribution::default());
        let improvement = Improvement { revisions, verdict: so_far(revision), attribution };
        let arguments = self.arguments.get(index).map_or("", String::as_str);
        let delays = estimate_at(self.context.estimates, index);
        let improved = improved(self.file, self.name, joint, (&improvement, delays), arguments);
        let revisions: Vec<_> = improved.into_iter().collect();
        if let Err(error) = self.context.show(&[], &revisions, Some(&joint.name)) {
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
