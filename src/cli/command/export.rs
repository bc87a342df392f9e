//! `tauscope export`: a model as source code or as an FMU.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow};
use clap::Args as ClapArgs;

use crate::cli::args::read_model;
use crate::cli::console::{Verbosity, message};
use crate::cli::failure::Completion;
use crate::cli::output::{OutputKind, Outputs, write_bytes};
use crate::experiment::{did_you_mean, nearest_name};
use crate::export::{Export, File, Language, Units, by_ending, endings};
use crate::model::{Component, Fitted, JointModel, ModelFile};

/// Write a joint's model as source code that stands alone, or as an FMU
///
/// The ending of FILE says what it is written in: `.c` or `.h` (C99, both files), `.py`
/// (NumPy), `.m` (MATLAB and GNU Octave), `.fmu` (FMI 3.0 for co-simulation, with sources
/// and, where there is a C compiler, the binary of this platform). Each has a step function,
/// a state, and parameters with their units, and simulates what `compare` does.
#[derive(ClapArgs, Debug)]
pub(crate) struct Args {
    /// The model file (TOML, schema `tauscope/model/1`)
    #[arg(value_name = "MODEL.toml")]
    model: PathBuf,

    /// The file to write; its functions are named after it
    #[arg(value_name = "FILE", required_unless_present = "output", conflicts_with = "output")]
    file: Option<PathBuf>,

    /// The file to write, given as an option
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// The joint, where the model file has several
    #[arg(long, value_name = "NAME")]
    joint: Option<String>,

    /// The label of a trial, or words of it, where effects act in some trials alone:
    /// `--trial H` has those of trials with `H` in their labels, `--trial none` has none
    #[arg(long, value_name = "LABEL")]
    trial: Option<String>,

    /// Unit of the input [default: that of the log which the model was fitted to]
    #[arg(long, value_name = "UNIT")]
    input_unit: Option<String>,

    /// Unit of the output: `rad`, `mrad`, `rev` or degrees; where gravity acts, any other unit is
    /// taken for degrees [default: that of the log, or degrees]
    #[arg(long, value_name = "UNIT")]
    output_unit: Option<String>,

    /// No notices
    #[arg(short, long)]
    quiet: bool,
}

pub(crate) fn run(args: &Args) -> anyhow::Result<Completion> {
    let target = args.file.as_deref().or(args.output.as_deref()).unwrap_or(Path::new(""));
    let (language, name) = language(target)?;
    let model = read_model(&args.model)?;
    let joint = joint(&model, args.joint.as_deref()).with_context(|| shown(&args.model))?;
    let paths = |file: &File| target.with_extension(file.ending);
    let planned: Vec<PathBuf> = planned(language, target);
    let outputs = Outputs::default().with(OutputKind::Other, &planned);
    outputs.check(std::slice::from_ref(&args.model))?;
    let export = exported(args, &model, joint)?;
    let files = language.files(&export, name).with_context(|| shown(target))?;
    for file in &files {
        let path = paths(file);
        write_bytes(&path, &file.content)?;
        Verbosity::from(args.quiet).say("model", shown(&path));
        if let Some(note) = &file.note {
            message("note", &format!("{}: {note}", shown(&path)));
        }
    }
    Ok(Completion::Whole)
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// The language of a file, and what it is called without its ending.
fn language(path: &Path) -> anyhow::Result<(Language, &str)> {
    let ending = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    let known = endings().iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(", ");
    let language = by_ending(ending)
        .ok_or_else(|| anyhow!("{}: its name must end in one of {known}", path.display()))?;
    Ok((language, path.file_stem().and_then(OsStr::to_str).unwrap_or_default()))
}

/// The files that will be written: a C header and its source go together.
fn planned(language: Language, path: &Path) -> Vec<PathBuf> {
    language.endings().iter().map(|ending| path.with_extension(ending)).collect()
}

/// The joint that is meant.
fn joint<'a>(model: &'a ModelFile, wanted: Option<&str>) -> anyhow::Result<&'a str> {
    let names: Vec<&str> = model.names().collect();
    let listed = || names.join(", ");
    match (wanted, names.as_slice()) {
        (None, [only]) => Ok(only),
        (None, []) => Err(anyhow!("it has no joint")),
        (None, _) => Err(anyhow!("it has several joints: `--joint` takes one of {}", listed())),
        (Some(wanted), names) => {
            names.iter().find(|name| **name == wanted).copied().ok_or_else(|| {
                let near = did_you_mean(nearest_name(wanted, names.iter().copied()));
                anyhow!("it has no joint `{wanted}`{near}")
            })
        }
    }
}

fn exported(args: &Args, model: &ModelFile, joint: &str) -> anyhow::Result<Export> {
    let of = model.joint(joint).ok_or_else(|| anyhow!("it has no joint `{joint}`"))?;
    let revision = model.revision(joint).unwrap_or_default();
    let name = args.model.file_name().unwrap_or_default().to_string_lossy();
    let origin = format!(
        "made by tauscope {} export from {name}, joint {joint}, revision {revision}",
        env!("CARGO_PKG_VERSION")
    );
    let fitted = model.fitted(joint);
    let known =
        |unit: fn(&Fitted) -> &Option<String>| fitted.and_then(|fitted| unit(fitted).clone());
    let input = args.input_unit.clone().or_else(|| known(|fitted| &fitted.input_unit));
    let output = args.output_unit.clone().or_else(|| known(|fitted| &fitted.output_unit));
    let units = Units { input, output };
    let place = || format!("{}: joint `{joint}`", args.model.display());
    let of = in_trial(of, args.trial.as_deref()).with_context(place)?;
    let caution = "when it was fitted, an error remained that no effect accounts for (verdict \
                   `unexplained`): its outputs may be far off";
    let caution = model.is_unexplained(joint).then(|| caution.to_owned());
    let origin: Vec<String> = std::iter::once(origin).chain(caution).collect();
    Export::new(joint, &of, units, &origin).with_context(place)
}

/// `model` in a trial of this label; as it is where it is the same in all.
fn in_trial<'m>(model: &'m JointModel, label: Option<&str>) -> anyhow::Result<Cow<'m, JointModel>> {
    if let Some(label) = label {
        return Ok(model.in_trial(label));
    }
    let effects = model.components().iter().map(Component::effect);
    for effect in effects {
        if let Some(of) = effect.within_trials() {
            let (id, word) = (effect.spec().id, of.word);
            return Err(anyhow!(
                "its effect `{id}` acts in trials with `{word}` in their label alone: say whether \
                 it is to act, `--trial {word}` or `--trial none`"
            ));
        }
    }
    Ok(Cow::Borrowed(model))
}
