//! `tauscope explain`: what a model lacks.

use std::path::PathBuf;

use crate::batch::Threads;
use crate::diagnosis::Comparison;
use crate::experiment::Joint;
use crate::explain::{Change, Explanation, Revision};
use crate::model::ModelFile;
use crate::report::{ComparedJoint, ExplainJson, Finding, ImprovedJoint, explain_text};
use crate::study::{JointEstimate, Mode, OfJoints, compare_joints, explain_joints};
use clap::Args as ClapArgs;

use crate::cli::args::{
    DataArgs, EffectArgs, ProtocolArgs, ResultArgs, fresh_name, name_of, note_missing, read_model,
};
use crate::cli::exit::Completion;
use crate::cli::output::check_recorded;
use crate::cli::run::{Session, Study, StudyContext, add_arguments, estimate_at, outcomes};

/// Say which physical effect a model lacks
///
/// The model is fitted. If its misfit is more than noise, every effect of the catalogue is
/// added to it in turn and fitted, and they are ranked by the error on data that were not
/// fitted. Without a model file each joint starts as a plain integrator.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    data: DataArgs,

    /// The model file (TOML, schema `tauscope/model/1`). Joints that it has not start as
    /// plain integrators; its candidates are tried, too
    #[arg(short, long, value_name = "MODEL.toml")]
    model: Option<PathBuf>,

    #[command(flatten)]
    effects: EffectArgs,

    #[command(flatten)]
    protocol: ProtocolArgs,

    #[command(flatten)]
    output: ResultArgs,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let file = args.model.as_deref().map(read_model).transpose()?.unwrap_or_default();
    let options = args.effects.options(file.candidates())?;
    let inputs: Vec<_> = args.data.files().into_iter().chain(args.model.clone()).collect();
    check_recorded(args.output.recording.as_deref(), &[], &inputs)?;
    let stream = args.output.stream.open(args.output.run.verbosity())?;
    let session = Session::with_others("explain", &args.data, &args.output.run, stream)?;
    let starts = |joint: &Joint| file.joint(&joint.name).cloned();
    let protocol = args.protocol.with(Mode::FitOrIntegrator);
    let study = Study::of(session, &args.output.delay_settings(), |context| {
        let (joints, estimates, bar) =
            (context.joints, context.estimates, context.bar("explaining"));
        let watched = protocol.watched(&bar).beside(context.others);
        let explained = explain_joints(joints, estimates, starts, watched, &options, &Threads);
        let bests = args.output.is_recorded().then(|| args.bests(context, &explained));
        (explained, bests.unwrap_or_default())
    })?;
    let joints = &study.experiment().joints;
    note_missing(&file, joints, study.verbosity());
    let arguments = args.add_arguments(joints);
    let name = name_of(args.model.as_deref());
    let finding = |index: usize, joint, explanation| {
        let delays = estimate_at(&study.estimates, index);
        let arguments = arguments.get(index).map_or("", String::as_str);
        finding(&file, &name, joint, (explanation, delays), arguments)
    };
    let (explained, bests) = &study.result;
    let (findings, failures) = outcomes(study.experiment(), explained, finding)?;
    if args.output.is_recorded() {
        let bests = joints.iter().zip(bests).filter_map(|(joint, best)| {
            let (model, comparison) = best.as_ref()?;
            Some(ComparedJoint { joint, model, revision: 0, comparison })
        });
        let models: Vec<_> = findings.iter().map(|f| f.compared).chain(bests).collect();
        let revisions: Vec<[Revision; 1]> = findings.iter().map(as_revision).collect();
        let revisions = findings.iter().zip(&revisions);
        let revisions: Vec<_> = revisions.map(|(f, one)| ImprovedJoint::of(*f, one)).collect();
        study.record(args.output.recording.as_deref(), &models, &revisions)?;
    }
    let text = || explain_text(&findings);
    study.end(&failures, text, || ExplainJson::new(&findings, &failures))
}

fn finding<'a>(
    file: &ModelFile,
    model: &'a str,
    joint: &'a Joint,
    (explanation, delays): (&'a Explanation, Option<&'a JointEstimate>),
    add_arguments: &'a str,
) -> Finding<'a> {
    let revision = file.revision(&joint.name).unwrap_or(0);
    let Explanation { base, verdict, ranking, attribution } = explanation;
    let attribution = Some(attribution);
    let compared = ComparedJoint { joint, model, revision, comparison: base };
    let (verdict, before) = (*verdict, None);
    Finding { compared, verdict, ranking, add_arguments, before, attribution, delays }
}

/// The model as the only one of its revisions.
fn as_revision(finding: &Finding<'_>) -> [Revision; 1] {
    let (comparison, ranking) = (finding.compared.comparison.clone(), finding.ranking.to_vec());
    [Revision { change: Change::Start, comparison, ranking }]
}

impl Args {
    /// What follows the effect in the command that adds it, for each joint.
    fn add_arguments(&self, joints: &[Joint]) -> Vec<String> {
        let given = self.model.as_ref().map(|model| model.display().to_string());
        add_arguments(&self.data, &self.protocol, &given.unwrap_or_else(fresh_name), joints)
    }

    /// The best candidate of each joint beside the measurement, and its name.
    fn bests(
        &self,
        context: StudyContext<'_>,
        explained: &OfJoints<Explanation>,
    ) -> Vec<Option<(String, Comparison)>> {
        let joints = context.joints;
        let best = |joint: &Joint| {
            let index = joints.iter().position(|other| other.name == joint.name)?;
            explained.get(index)?.as_ref()?.as_ref().ok()?.proposed()
        };
        let model = |joint: &Joint| Some(best(joint)?.fit.model.clone());
        let protocol = self.protocol.with(Mode::AsItIs);
        let watched = protocol.watched(&()).beside(context.others);
        let compared = compare_joints(joints, context.estimates, model, watched, &Threads);
        let named = |(joint, compared): (&Joint, Option<Result<Comparison, _>>)| {
            Some((format!("with {}", best(joint)?.name()), compared?.ok()?))
        };
        joints.iter().zip(compared).map(named).collect()
    }
}
