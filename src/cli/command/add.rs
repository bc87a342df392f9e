//! `tauscope add`: one effect more in a model.

use crate::batch::Threads;
use crate::experiment::Joint;
use crate::explain::{Addition, Change, Improvement, Revision as Step, Verdict};
use crate::report::ImprovedJoint;
use crate::report::add::{AddedJoint, add_json, add_text};
use crate::study::{Mode, add_to_joints};
use clap::Args as ClapArgs;

use crate::cli::args::{DataArgs, ModelFileArgs, ProtocolArgs, ResultArgs, find};
use crate::cli::exit::Completion;
use crate::cli::failure::outcomes;
use crate::cli::run::{Shown, Start, Study};

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
    let (data, output) = (&args.data, &args.output);
    let study =
        Study::begin(("add", Shown::AtTheEnd), data, output, (Some(target), args.model.kept()))?;
    let start = Start::of(&study, &file, Some(target), Vec::new())?;
    args.model.check_target(&file, study.joints())?;
    let starts = |joint: &Joint| start.model(joint);
    let protocol = args.protocol.with(Mode::FitOrIntegrator);
    let added = study.work("fitting", |bar, others| {
        let watched = protocol.watched(bar).beside(others);
        add_to_joints(study.joints(), &study.estimates, starts, watched, effect, &Threads)
    })?;
    let (model, effect) = (start.name.as_str(), effect.spec().id);
    let (joints, failures) = outcomes(&study.experiment, &added, |_, joint, addition| {
        let revision = start.revision(joint) + 1;
        AddedJoint { joint, model, effect, revision, addition }
    })?;
    let improvements: Vec<Improvement> = joints.iter().map(improvement).collect();
    let improved = joints.iter().zip(&improvements).enumerate();
    let improved: Vec<ImprovedJoint<'_>> = improved
        .filter_map(|(index, (added, found))| start.improved(index, added.joint, found))
        .collect();
    // What the model still lacks was not looked for.
    let revised = start.revised(&improved, |_| None)?;
    study.record_revisions(output.recording.as_deref(), &improved)?;
    args.model.write(&file, &revised, study.verbosity())?;
    let text = || add_text(&joints);
    study.end(&failures, text, || add_json(&target.display().to_string(), &joints, &failures))
}

/// Both models as revisions. What the second one still lacks was not looked for.
fn improvement(added: &AddedJoint<'_>) -> Improvement {
    let Addition { before, after, attribution, .. } = added.addition;
    let steps = [(Change::Start, before), (Change::Added(added.effect), after)];
    let step = |(change, comparison): (Change, &_)| {
        let comparison = Clone::clone(comparison);
        Step { change, comparison, ranking: Vec::new() }
    };
    let is_adequate = after.is_adequate();
    let verdict = if is_adequate { Verdict::Adequate } else { Verdict::MissingEffect };
    let (revisions, attribution) = (steps.map(step).into(), attribution.clone());
    Improvement { revisions, verdict, attribution }
}
