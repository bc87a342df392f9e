//! `tauscope compare`: a model beside the measurement.

use std::path::{Path, PathBuf};

use clap::Args as ClapArgs;

use crate::batch::Threads;
use crate::cli::args::{DataArgs, ProtocolArgs, ResultArgs, check_known, read_model};
use crate::cli::failure::{Completion, joint_left_out, nothing_usable, read_failures};
use crate::cli::run::Study;
use crate::diagnosis::Comparison;
use crate::experiment::{Joint, listed};
use crate::fit::FitError;
use crate::model::{JointModel, ModelFile};
use crate::report::ComparedJoint;
use crate::report::compare::{compare_json, compare_text};
use crate::study::{Mode, compare_joints};

/// Compare a model with the measurement
///
/// Without a model file each joint is compared with a plain integrator, whose gain and
/// delay are fitted.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    #[command(flatten)]
    data: DataArgs,

    /// A model file (TOML, schema `tauscope/model/1`). May be repeated
    #[arg(short, long, value_name = "MODEL.toml")]
    model: Vec<PathBuf>,

    /// A model to compare the first one with: its errors beside the first one's, where each is
    /// better, and whether the difference is more than chance. The same is said of further
    /// `--model` files. May be repeated
    #[arg(long, value_name = "MODEL.toml")]
    against: Vec<PathBuf>,

    /// Fit the free parameters of the model files, starting at their values
    #[arg(long)]
    fit: bool,

    #[command(flatten)]
    protocol: ProtocolArgs,

    #[command(flatten)]
    output: ResultArgs,
}

/// A model by the name it has in the output.
struct Named<'a> {
    name: String,
    /// Where it is, and what it holds; none: plain integrators.
    file: Option<(&'a Path, ModelFile)>,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let models = models(&args.model, &args.against)?;
    let inputs = [args.model.as_slice(), &args.against].concat();
    let study = Study::begin("compare", &args.data, &args.output, (None, inputs))?;
    for (_, file) in models.iter().filter_map(|named| named.file.as_ref()) {
        check_known(file, study.joints(), study.verbosity())?;
    }
    let results = study.work("comparing", |bar, others| {
        let one = |named: &Named<'_>| {
            let starts = |joint: &Joint| named.starts(joint);
            let watched = args.protocol.with(named.mode(args)).watched(bar).beside(others);
            compare_joints(study.joints(), &study.estimates, starts, watched, &Threads)
        };
        models.iter().map(one).collect::<Vec<_>>()
    })?;
    let mut failures = read_failures(&study.experiment);
    let mut compared = Vec::new();
    for (named, results) in models.iter().zip(&results) {
        for (joint, result) in study.joints().iter().zip(results) {
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
    let text = || compare_text(&compared);
    study.end(&failures, text, || compare_json(&compared, &failures))
}

/// The models that are named, the one that the others are compared with first.
fn models<'a>(paths: &'a [PathBuf], against: &'a [PathBuf]) -> anyhow::Result<Vec<Named<'a>>> {
    let mut models = Vec::new();
    if paths.is_empty() {
        models.push(Named { name: "integrator".to_owned(), file: None });
    }
    for path in paths.iter().chain(against) {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        // Two files of one name in two folders are two models.
        let numbered = (2..).map(|number| format!("{stem} {number}"));
        let mut names = std::iter::once(stem.clone()).chain(numbered);
        let is_free = |name: &String| models.iter().all(|known: &Named<'_>| known.name != *name);
        let name = names.find(is_free).unwrap_or(stem.clone());
        models.push(Named { name, file: Some((path, read_model(path)?)) });
    }
    Ok(models)
}

impl Named<'_> {
    /// The model of `joint` in the file; none without a file, where there is none to ask.
    fn starts(&self, joint: &Joint) -> Option<JointModel> {
        self.file.as_ref().and_then(|(_, file)| file.joint(&joint.name)).cloned()
    }

    /// A joint's result, or a message on why there is none.
    fn compared<'a>(
        &'a self,
        joint: &'a Joint,
        result: Option<&'a Result<Comparison, FitError>>,
    ) -> Result<ComparedJoint<'a>, String> {
        let name = &joint.name;
        let result = result.ok_or_else(|| self.lacks(name))?;
        let comparison = result.as_ref().map_err(|error| joint_left_out(name, error))?;
        let revision = self.file.as_ref().and_then(|(_, file)| file.revision(name)).unwrap_or(0);
        Ok(ComparedJoint { joint, model: &self.name, revision, comparison })
    }

    /// That the file has no model of `joint`, and of which joints it has.
    fn lacks(&self, joint: &str) -> String {
        let file = self.file.as_ref();
        let path = file.map(|(path, _)| path.display().to_string()).unwrap_or_default();
        let names: Vec<&str> = file.iter().flat_map(|(_, file)| file.names()).collect();
        format!("joint `{joint}`: {path} has no model of it, but of {}", listed(names.into_iter()))
    }

    fn mode(&self, args: &Args) -> Mode {
        match (&self.file, args.fit) {
            (None, _) => Mode::Integrator,
            (Some(_), true) => Mode::Fit,
            (Some(_), false) => Mode::AsItIs,
        }
    }
}
