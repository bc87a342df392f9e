//! `tauscope explain`: what a model lacks.

use std::path::PathBuf;

use crate::batch::Threads;
use crate::experiment::Joint;
use crate::report::improve::{explain_json, explain_text};
use crate::study::{Mode, explain_joints};
use clap::Args as ClapArgs;

use crate::cli::args::{
    DataArgs, EffectArgs, ProtocolArgs, ResultArgs, add_arguments, fresh_name, read_model,
};
use crate::cli::failure::Completion;
use crate::cli::run::{Start, Study, as_it_is};

/// Say which physical effect a model lacks
///
/// The model is fitted. If a lack of fit is shown, every effect of the catalogue is
/// added to it in turn and fitted, and they are ranked by the error on data that were not
/// fitted. Without a model file each joint starts as a plain integrator.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    data: DataArgs,

    /// The model file (TOML, schema `tauscope/model/1`). Joints that are not in it start as
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
    let (data, output) = (&args.data, &args.output);
    let inputs = args.model.iter().cloned().collect();
    let study = Study::begin("explain", data, output, (None, inputs))?;
    let joints = study.joints();
    let given = args.model.as_ref().map(|model| model.display().to_string());
    let arguments = add_arguments(data, &given.unwrap_or_else(fresh_name), joints);
    let start = Start::of(&study, &file, args.model.as_deref(), arguments)?;
    let starts = |joint: &Joint| start.model(joint);
    let protocol = args.protocol.with(Mode::FitOrIntegrator);
    let explained = study.work("explaining", |bar, others| {
        let watched = protocol.watched(bar).beside(others);
        explain_joints(joints, &study.estimates, starts, watched, &options, &Threads)
    })?;
    let explained = explained.into_iter().map(|found| Some(found?.map(as_it_is)));
    let explained: Vec<_> = explained.collect();
    let (improved, failures) = start.outcomes(&explained)?;
    let findings: Vec<_> = improved.iter().map(|joint| joint.finding).collect();
    let models: Vec<_> = findings.iter().map(|finding| finding.compared).collect();
    study.record(output.recording.as_deref(), &models, &improved)?;
    let text = || explain_text(&findings);
    study.end(&failures, text, || explain_json(&findings, &failures))
}
