//! `tauscope improve`: explain and add until nothing significant is left.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use crate::batch::{Mode, improve_joints};
use crate::experiment::Joint;
use crate::explain::{Change, Improvement, MAX_EFFECTS, Options, Revision as Step, Verdict};
use crate::fit::Horizon;
use crate::model::{ModelFile, Revision};
use crate::report::{
    ComparedJoint, Finding, ImproveJson, ImprovedJoint, gone, improve_text, revision_line,
};
use clap::Args as ClapArgs;

use super::data::DataArgs;
use super::fitting::{Begun, EffectArgs, ProtocolArgs, ResultArgs};
use super::fitting::{outcomes, print, quoted, study};
use super::folder::{Each, FolderArgs};
use super::interrupt::Interrupt;
use super::model_file::{ModelFileArgs, name_of, note_missing};
use super::output::check_outputs;
use super::progress::Verbosity;
use super::{Completion, message};

/// Add to a model what it lacks, effect by effect
///
/// After each effect, those that were added before and have become useless are removed
/// again; effects that the model file had stay. It ends when no lack of fit is shown, or
/// when no effect accounts for it. Ctrl-C ends it after the revision at hand.
#[derive(ClapArgs, Debug)]
pub(super) struct Args {
    #[command(flatten)]
    data: DataArgs,

    #[command(flatten)]
    model: ModelFileArgs,

    #[command(flatten)]
    effects: EffectArgs,

    /// How many effects are added at most
    #[arg(long, value_name = "N", default_value_t = MAX_EFFECTS, help_heading = "Model")]
    max_effects: usize,

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
        format: args.output.format,
        threads: args.output.threads(),
        verbosity: args.output.verbosity(),
    })
}

pub(super) fn run(args: &Args) -> anyhow::Result<Completion> {
    if args.folder.is_asked_for() {
        return each_log(args);
    }
    let file = args.model.read()?;
    let effects = args.effects.effects(file.candidates())?;
    let options = Options { effects, max_effects: args.max_effects };
    let target = args.model.target();
    let recording = args.output.recording.as_deref();
    let outputs: Vec<_> = std::iter::once(target).chain(recording).collect();
    check_outputs(&outputs, &args.data.files())?;
    let verbosity = args.output.verbosity();
    let stream = args.output.stream.open(verbosity)?.expecting_revisions()?;
    let interrupt = Interrupt::watch(STOPPING);
    let name = name_of(Some(target));
    let protocol = args.protocol.with(Mode::FitOrIntegrator, Horizon::Steps);
    let study = study(&args.data, &args.output, ("improving", stream), |begun, bar| {
        let (joints, estimates) = (begun.joints, begun.estimates);
        let progress = Progress::new(&file, joints, verbosity, Some(interrupt));
        let arguments = args.all_arguments(joints);
        let stage = Stage::new(begun, &file, &name, &arguments);
        let starts = |joint: &Joint| file.joint(&joint.name).cloned();
        let done = |index, revision: &Step| {
            stage.show(index, revision);
            progress.done(index, revision)
        };
        let improved =
            improve_joints(joints, estimates, starts, protocol.watched(bar), &options, done);
        (improved, progress.stopped())
    })?;
    let joints = &study.experiment.joints;
    note_missing(&file, joints, verbosity);
    let (results, stopped) = &study.result;
    let arguments = args.all_arguments(joints);
    let improved = |index: usize, joint, improvement| {
        let stopped = stopped.get(index).copied().unwrap_or(false);
        let add_arguments = arguments.get(index).map_or("", String::as_str);
        let mut improved = improved(&file, &name, joint, improvement, add_arguments)?;
        improved.interrupted = stopped && improved.finding.verdict != Verdict::Adequate;
        Some(improved)
    };
    let (improved, failures) = outcomes(&study.experiment, results, improved)?;
    let improved: Vec<_> = improved.into_iter().flatten().collect();
    if args.output.is_recorded() {
        let names = revision_names(&improved);
        let models: Vec<_> = improved.iter().flat_map(|joint| models(joint, &names)).collect();
        study.record(recording, &models, &improved, verbosity)?;
    }
    args.model.write(&file, &revised(&file, &improved)?, verbosity)?;
    let text = || improve_text(&improved, &args.protocol.horizon(Horizon::Steps));
    let completion = print(args.output.format, &failures, text, |out| {
        serde_json::to_writer(out, &ImproveJson::new(&improved, &failures))
    })?;
    let is_cut_short = improved.iter().any(|joint| joint.interrupted);
    let completion = if is_cut_short { Completion::Partial } else { completion };
    study.close(completion, verbosity)
}

/// What is said when somebody presses Ctrl-C.
const STOPPING: &str = "after this revision; Ctrl-C again ends at once, without results";

impl Args {
    /// What stands behind the effect in the command that adds one more, for each joint.
    fn all_arguments(&self, joints: &[Joint]) -> Vec<String> {
        joints.iter().map(|joint| self.add_arguments(joints, joint)).collect()
    }

    /// What stands behind the effect in the command that adds one more to `joint`.
    fn add_arguments(&self, joints: &[Joint], joint: &Joint) -> String {
        let one_of_several = (joints.len() > 1).then_some(joint.name.as_str());
        let mut words = self.data.typed(one_of_several);
        words.extend(["--model".to_owned(), self.model.target().display().to_string()]);
        words.extend(self.protocol.typed());
        quoted(&words)
    }
}

/// Which revisions there are so far, told as they come.
pub(super) struct Progress<'a> {
    joints: &'a [Joint],
    /// Per joint, the number of its next revision, and whether it was stopped.
    next: Vec<(AtomicU32, AtomicBool)>,
    verbosity: Verbosity,
    /// Who may stop it.
    interrupt: Option<Interrupt>,
}

impl<'a> Progress<'a> {
    pub(super) fn new(
        file: &ModelFile,
        joints: &'a [Joint],
        verbosity: Verbosity,
        interrupt: Option<Interrupt>,
    ) -> Self {
        let first = |joint: &Joint| file.revision(&joint.name).unwrap_or(0);
        let next = joints.iter().map(|joint| (first(joint).into(), false.into())).collect();
        Self { joints, next, verbosity, interrupt }
    }

    /// Tells of a revision; whether to go on.
    pub(super) fn done(&self, index: usize, revision: &Step) -> bool {
        let Some((joint, (next, stopped))) = self.joints.get(index).zip(self.next.get(index))
        else {
            return true;
        };
        let number = next.fetch_add(1, Ordering::Relaxed);
        if self.verbosity == Verbosity::Normal {
            message("improving", &revision_line(joint, number, revision));
        }
        let stops = self.interrupt.is_some_and(Interrupt::was_pressed);
        stopped.store(stops, Ordering::Relaxed);
        !stops
    }

    /// Which joints were stopped.
    fn stopped(&self) -> Vec<bool> {
        self.next.iter().map(|(_, stopped)| stopped.load(Ordering::Relaxed)).collect()
    }
}

/// The revisions so far, shown to whoever looks on.
struct Stage<'a> {
    begun: Begun<'a>,
    file: &'a ModelFile,
    name: &'a str,
    arguments: &'a [String],
    /// Per joint.
    steps: Vec<Mutex<Vec<Step>>>,
}

impl<'a> Stage<'a> {
    fn new(begun: Begun<'a>, file: &'a ModelFile, name: &'a str, arguments: &'a [String]) -> Self {
        let steps = begun.joints.iter().map(|_| Mutex::default()).collect();
        Self { begun, file, name, arguments, steps }
    }

    /// Shows one more revision of a joint. What goes wrong is told, and is no reason to stop:
    /// the results do not hang on the viewer.
    fn show(&self, index: usize, revision: &Step) {
        if !self.begun.is_shown() {
            return;
        }
        let of_joint = self.begun.joints.get(index).zip(self.steps.get(index));
        let Some((joint, steps)) = of_joint else { return };
        let Ok(mut steps) = steps.lock() else { return };
        steps.push(revision.clone());
        let improvement = Improvement { revisions: steps.clone(), verdict: so_far(revision) };
        let arguments = self.arguments.get(index).map_or("", String::as_str);
        let improved = improved(self.file, self.name, joint, &improvement, arguments);
        let revisions: Vec<_> = improved.into_iter().collect();
        if let Err(error) = self.begun.show(&[], &revisions, Some(&joint.name)) {
            message("warning", &format!("{error:#}"));
        }
    }
}

/// What is to be said of a revision that may not be the last.
fn so_far(revision: &Step) -> Verdict {
    let lack_of_fit = revision.comparison.lack_of_fit;
    match (lack_of_fit.is_none_or(|test| test.adequate), revision.ranking.is_empty()) {
        (true, _) => Verdict::Adequate,
        (false, true) => Verdict::Unexplained,
        (false, false) => Verdict::MissingEffect,
    }
}

/// What is to be said of a joint that was improved.
pub(super) fn improved<'a>(
    file: &ModelFile,
    model: &'a str,
    joint: &'a Joint,
    improvement: &'a Improvement,
    add_arguments: &'a str,
) -> Option<ImprovedJoint<'a>> {
    let Improvement { revisions, verdict } = improvement;
    let last = revisions.last()?;
    let first_revision = file.revision(&joint.name).unwrap_or(0);
    let revision = (first_revision..).zip(revisions).last()?.0;
    let compared = ComparedJoint { joint, model, revision, comparison: &last.comparison };
    let finding = Finding { compared, verdict: *verdict, ranking: &last.ranking, add_arguments };
    Some(ImprovedJoint { finding, revisions, first_revision, interrupted: false })
}

/// `file` with all revisions of all joints. A joint that has no new one stays as it is.
pub(super) fn revised(
    file: &ModelFile,
    improved: &[ImprovedJoint<'_>],
) -> anyhow::Result<ModelFile> {
    let mut file = file.clone();
    for joint in improved {
        let name = &joint.finding.compared.joint.name;
        let pairs = (joint.first_revision + 1..).zip(joint.revisions.windows(2));
        for (number, pair) in pairs {
            let [before, after] = pair else { continue };
            let model = &after.comparison.fit.model;
            file = file.revised(name, model, &entry(number, before, after))?;
        }
        if file.joint(name).is_none() {
            file = file.refitted(name, &joint.finding.compared.comparison.fit.model)?;
        }
    }
    Ok(file)
}

/// What the history says of `after`.
fn entry(revision: u32, before: &Step, after: &Step) -> Revision {
    let model = &after.comparison.fit.model;
    let removed = gone(&before.comparison.fit.model, model);
    let added = match after.change {
        Change::Added(id) | Change::Replaced { new: id, .. } => Some(id.to_owned()),
        Change::Start | Change::Removed(_) => None,
    };
    Revision {
        revision,
        added,
        removed: removed.first().map(|id| (*id).to_owned()),
        validation_rmse: after.comparison.validation.map(|error| error.rmse),
    }
}

/// `revision 0` and so on, to the last number there is.
pub(super) fn revision_names(improved: &[ImprovedJoint<'_>]) -> Vec<String> {
    let last = improved.iter().map(|joint| joint.finding.compared.revision).max().unwrap_or(0);
    (0..=last).map(|number| format!("revision {number}")).collect()
}

/// The revisions of a joint, each as a model.
pub(super) fn models<'a>(
    improved: &ImprovedJoint<'a>,
    names: &'a [String],
) -> Vec<ComparedJoint<'a>> {
    let joint = improved.finding.compared.joint;
    let numbered = (improved.first_revision..).zip(improved.revisions);
    let named = (0..).zip(names).map(|(number, name)| (number, name.as_str()));
    let compared = |(number, revision): (u32, &'a Step)| {
        let model = named.clone().find(|(own, _)| *own == number)?.1;
        let comparison = &revision.comparison;
        Some(ComparedJoint { joint, model, revision: number, comparison })
    };
    numbered.filter_map(compared).collect()
}
