//! `tauscope compare`: a model beside the measurement.

use std::path::PathBuf;

use crate::batch::Threads;
use crate::delay::Settings;
use crate::diagnosis::Comparison;
use crate::experiment::Joint;
use crate::fit::{FitError, Horizon};
use crate::model::{JointModel, ModelFile};
use crate::report::{CompareJson, ComparedJoint, compare_table};
use crate::study::{Mode, compare_joints};
use clap::Args as ClapArgs;

use crate::cli::args::{DataArgs, ProtocolArgs, ResultArgs, read_model};
use crate::cli::exit::Completion;
use crate::cli::failure::{joint_left_out, nothing_usable, read_failures};
use crate::cli::output::check_outputs;
use crate::cli::run::{Session, Study};

/// Compare a model with the measurement
///
/// Without a model file each joint is compared with a plain integrator, whose gain and
/// delay are fitted.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    data: DataArgs,

    /// A model file (TOML, schema `tauscope/model/1`). May be repeated
    #[arg(short, long, value_name = "MODEL.toml", help_heading = "Model")]
    model: Vec<PathBuf>,

    /// Fit the free parameters of the model files, starting at their values
    #[arg(long, help_heading = "Model")]
    fit: bool,

    #[command(flatten)]
    protocol: ProtocolArgs,

    #[command(flatten)]
    output: ResultArgs,
}

/// A model by the name it has in the output.
struct Named {
    name: String,
    /// None: plain integrators.
    file: Option<ModelFile>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let models = models(&args.model)?;
    if let Some(path) = &args.output.recording {
        check_outputs(&[path.as_path()], &[args.data.files(), args.model.clone()].concat())?;
    }
    let stream = args.output.stream.open(args.output.run.verbosity())?;
    let session = Session::with_others("compare", &args.data, &args.output.run, stream)?;
    let study = Study::of(session, &Settings::default(), |begun| {
        let (joints, estimates, bar) = (begun.joints, begun.estimates, begun.bar("comparing"));
        let one = |named: &Named| {
            let starts = |joint: &Joint| named.starts(joint);
            compare_joints(
                joints,
                estimates,
                starts,
                args.protocol
                    .with(named.mode(args), Horizon::FreeRun)
                    .watched(&bar)
                    .beside(begun.others),
                &Threads,
            )
        };
        models.iter().map(one).collect::<Vec<_>>()
    })?;
    let mut failures = read_failures(study.experiment());
    let mut compared = Vec::new();
    for (named, results) in models.iter().zip(&study.result) {
        for (joint, result) in study.experiment().joints.iter().zip(results) {
            match named.compared(joint, result.as_ref()) {
                Ok(joint) => compared.push(joint),
                Err(failure) => failures.push(failure),
            }
        }
    }
    if let Some(first) = failures.first().filter(|_| compared.is_empty()) {
        return Err(nothing_usable(Some(first)));
    }
    study.record(args.output.recording.as_deref(), &compared, &[])?;
    let text = || compare_table(&compared);
    study.end(&failures, text, || CompareJson::new(&compared, &failures))
}

fn models(paths: &[PathBuf]) -> anyhow::Result<Vec<Named>> {
    if paths.is_empty() {
        return Ok(vec![Named { name: "integrator".to_owned(), file: None }]);
    }
    let named = |path: &PathBuf| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Named { name, file: Some(read_model(path)?) })
    };
    paths.iter().map(named).collect()
}

impl Named {
    /// The model of `joint` in the file; none without a file, where there is none to ask.
    fn starts(&self, joint: &Joint) -> Option<JointModel> {
        self.file.as_ref().and_then(|file| file.joint(&joint.name)).cloned()
    }

    /// A joint's result, or a message on why there is none.
    fn compared<'a>(
        &'a self,
        joint: &'a Joint,
        result: Option<&'a Result<Comparison, FitError>>,
    ) -> Result<ComparedJoint<'a>, String> {
        let name = &joint.name;
        let result =
            result.ok_or_else(|| format!("joint `{name}`: not in model `{}`", self.name))?;
        let comparison = result.as_ref().map_err(|error| joint_left_out(name, error))?;
        let revision = self.file.as_ref().and_then(|file| file.revision(name)).unwrap_or(0);
        Ok(ComparedJoint { joint, model: &self.name, revision, comparison })
    }

    fn mode(&self, args: &Args) -> Mode {
        match (&self.file, args.fit) {
            (None, _) => Mode::Integrator,
            (Some(_), true) => Mode::Fit,
            (Some(_), false) => Mode::AsItIs,
        }
    }
}
