//! `tauscope add`: one effect more in a model.

use crate::batch::Threads;
use crate::diagnosis::Comparison;
use crate::experiment::{Joint, Source};
use crate::explain::{Addition, Change, Revision as Step, Verdict};
use crate::model::ModelFile;
use crate::report::add_text;
use crate::report::{AddJson, AddedJoint, ComparedJoint, Finding, ImprovedJoint};
use crate::study::{Mode, add_to_joints};
use clap::Args as ClapArgs;

use crate::cli::args::{
    DataArgs, ModelFileArgs, ProtocolArgs, ResultArgs, find, name_of, note_missing,
};
use crate::cli::exit::Completion;
use crate::cli::output::check_recorded;
use crate::cli::run::{Session, Study, entry, outcomes, with_fit};

/// Add an effect to a model, and write its next revision
///
/// The model is fitted without the effect and with it, and the errors are printed. The
/// model file gets the fitted values, the effect, and an entry in its history.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// The effect, one of the catalogue or of the candidates of the model file
    #[arg(value_name = "EFFECT")]
    effect: String,

    #[command(flatten)]
    data: DataArgs,

    #[command(flatten)]
    model: ModelFileArgs,

    #[command(flatten)]
    protocol: ProtocolArgs,

    #[command(flatten)]
    output: ResultArgs,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let file = args.model.read()?;
    let effect = find(&args.effect, file.candidates())?;
    let target = args.model.target();
    check_recorded(
        args.output.recording.as_deref(),
        &[target],
        &[args.data.files(), args.model.kept()].concat(),
    )?;
    let stream = args.output.stream.open(args.output.run.verbosity())?;
    let session = Session::with_others("add", &args.data, &args.output.run, stream)?;
    let starts = |joint: &Joint| file.joint(&joint.name).cloned();
    let protocol = args.protocol.with(Mode::FitOrIntegrator);
    let study = Study::of(session, &args.output.delay_settings(), |begun| {
        let bar = begun.bar("fitting");
        add_to_joints(
            begun.joints,
            begun.estimates,
            starts,
            protocol.watched(&bar).beside(begun.others),
            effect,
            &Threads,
        )
    })?;
    note_missing(&file, &study.experiment().joints, study.verbosity());
    let name = name_of(Some(target));
    let added = |_, joint, addition| added(&file, &name, effect.spec().id, joint, addition);
    let (joints, failures) = outcomes(study.experiment(), &study.result, added)?;
    let mut revised = file.clone();
    for joint in &joints {
        revised = with_revision(&revised, joint, &study.experiment().sources)?;
    }
    if args.output.is_recorded() {
        let names: Vec<_> = joints.iter().map(revision_names).collect();
        let named = joints.iter().zip(&names);
        let models: Vec<_> = named.flat_map(|(joint, names)| as_models(joint, names)).collect();
        let revisions: Vec<[Step; 2]> = joints.iter().map(steps).collect();
        let grown = joints.iter().zip(&revisions).map(|(joint, steps)| grown(joint, steps));
        let path = args.output.recording.as_deref();
        study.record(path, &models, &grown.collect::<Vec<_>>())?;
    }
    args.model.write(&file, &revised, study.verbosity())?;
    let text = || add_text(&joints);
    study.end(&failures, text, || AddJson::new(target.display().to_string(), &joints, &failures))
}

fn added<'a>(
    file: &ModelFile,
    model: &'a str,
    effect: &'static str,
    joint: &'a Joint,
    addition: &'a Addition,
) -> AddedJoint<'a> {
    let revision = file.revision(&joint.name).unwrap_or(0) + 1;
    AddedJoint { joint, model, effect, revision, addition }
}

/// Names of both models, as `improve` gives them.
fn revision_names(added: &AddedJoint<'_>) -> [String; 2] {
    added.compared().map(|compared| format!("revision {}", compared.revision))
}

/// Both models under these names.
fn as_models<'a>(added: &AddedJoint<'a>, names: &'a [String; 2]) -> [ComparedJoint<'a>; 2] {
    let ([before, after], [first, second]) = (added.compared(), names);
    [ComparedJoint { model: first, ..before }, ComparedJoint { model: second, ..after }]
}

/// Both models as revisions.
fn steps(added: &AddedJoint<'_>) -> [Step; 2] {
    let step = |change, comparison: &Comparison| Step {
        change,
        comparison: comparison.clone(),
        ranking: Vec::new(),
    };
    let Addition { before, after, .. } = added.addition;
    [step(Change::Start, before), step(Change::Added(added.effect), after)]
}

fn grown<'a>(added: &AddedJoint<'a>, revisions: &'a [Step]) -> ImprovedJoint<'a> {
    let [_, compared] = added.compared();
    // What the model still lacks was not looked for.
    let is_adequate = compared.comparison.is_adequate();
    let verdict = if is_adequate { Verdict::Adequate } else { Verdict::MissingEffect };
    let before = Some(&added.addition.before);
    let attribution = Some(&added.addition.attribution);
    let (ranking, add_arguments, delays) = (&[][..], "", None);
    let finding =
        Finding { compared, verdict, ranking, add_arguments, before, attribution, delays };
    ImprovedJoint::of(finding, revisions)
}

fn with_revision(
    file: &ModelFile,
    added: &AddedJoint<'_>,
    sources: &[Source],
) -> anyhow::Result<ModelFile> {
    let Addition { before, after, .. } = added.addition;
    let entry = entry(added.revision, Some(added.effect), before, after);
    let file = file.revised(&added.joint.name, &after.fit.model, &entry)?;
    let [_, compared] = added.compared();
    // What the model still lacks was not looked for.
    with_fit(&file, &compared, Some((added.revision - 1, before)), None, sources)
}
