//! `tauscope add`: one effect more in a model.

use crate::batch::Threads;
use crate::experiment::Joint;
use crate::explain::{Addition, Change, Improvement, Revision as Step, Verdict};
use crate::report::improve::{AddedJoint, add_json, add_text};
use crate::study::{Mode, add_to_joints};
use clap::Args as ClapArgs;

use crate::cli::args::{DataArgs, ModelFileArgs, ProtocolArgs, ResultArgs, find};
use crate::cli::failure::Completion;
use crate::cli::run::{Start, Study};

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
    let study = Study::begin("add", data, output, (Some(target), args.model.kept()))?;
    let start = Start::of(&study, &file, Some(target), Vec::new())?;
    args.model.check_target(&file, study.joints())?;
    let starts = |joint: &Joint| start.model(joint);
    let protocol = args.protocol.with(Mode::FitOrIntegrator);
    let added = study.work("fitting", |bar, others| {
        let watched = protocol.watched(bar).beside(others);
        add_to_joints(study.joints(), &study.estimates, starts, watched, effect, &Threads)
    })?;
    let effect = effect.spec().id;
    let p_values: Vec<_> = added.iter().flatten().flatten().map(|it| it.p_value).collect();
    let added = added.into_iter().map(|found| Some(found?.map(|it| improvement(effect, it))));
    let added: Vec<_> = added.collect();
    let (improved, failures) = start.outcomes(&added)?;
    // What the model still lacks was not looked for.
    let revised = start.revised(&improved, |_| None)?;
    study.record_revisions(output.recording.as_deref(), &improved)?;
    args.model.write(&file, &revised, study.verbosity())?;
    let joints = improved.into_iter().zip(p_values);
    let joints = joints.map(|(improved, p_value)| AddedJoint { improved, effect, p_value });
    let joints: Vec<_> = joints.collect();
    let text = || add_text(&joints);
    study.end(&failures, text, || add_json(&target.display().to_string(), &joints, &failures))
}

/// Both models as revisions. What the second one still lacks was not looked for.
fn improvement(effect: &'static str, added: Addition) -> Improvement {
    let Addition { before, after, attribution, .. } = added;
    let is_adequate = after.is_adequate();
    let verdict = if is_adequate { Verdict::Adequate } else { Verdict::MissingEffect };
    let steps = [(Change::Start, before), (Change::Added(effect), after)];
    let step = |(change, comparison)| Step { change, comparison, ranking: Vec::new() };
    Improvement { revisions: steps.map(step).into(), verdict, attribution }
}
