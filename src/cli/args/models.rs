//! Which models, and by what rules they are judged: the file that `explain`, `add` and `improve` start
//! from, where it goes, and which effects are tried.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow, bail};
use clap::Args;

use super::data::DataArgs;
use crate::cli::console::{Host, Verbosity};
use crate::cli::output::{target_of, write_bytes};
use crate::cli::typed::quoted;
use crate::effect::{Effect, REGISTRY, find_among};
use crate::experiment::{Joint, has_word, nearest_name, read_text};
use crate::explain::{Options, Tried};
use crate::fit::{Horizon, Split};
use crate::model::{Component, JointModel, ModelError, ModelFile};
use crate::study::{Mode, Protocol};

/// The name of a model file where none is given.
const DEFAULT: &str = "model.toml";

/// Where a model comes from and where its next revision goes.
#[derive(Args, Debug)]
#[command(next_help_heading = "Which model, and how it is fitted")]
pub(crate) struct ModelFileArgs {
    /// The model file (TOML, schema `tauscope/model/1`). It is revised in place: values
    /// change, comments and whatever else was written by hand stay. If it does not exist, it is
    /// created; joints that are not in it start as plain integrators
    #[arg(short, long, value_name = "MODEL.toml")]
    model: Option<PathBuf>,

    /// Where the revised file goes instead [default: the model file, or a new model.toml]
    #[arg(short, long, value_name = "FILE.toml")]
    write: Option<PathBuf>,
}

impl ModelFileArgs {
    /// The model file as it is; an empty one where there is none.
    pub(crate) fn read(&self) -> anyhow::Result<ModelFile> {
        match &self.model {
            Some(path) if path.exists() || self.write.is_some() => Ok(read_model(path)?),
            Some(path) => Ok(ModelFile::new(path)),
            None if self.write.is_none() && Path::new(DEFAULT).exists() => bail!(
                "{DEFAULT} exists already: `--model {DEFAULT}` continues with it, `--write FILE` \
                 starts another"
            ),
            None => Ok(ModelFile::new(self.target())),
        }
    }

    /// Whether the revised file is to go elsewhere than where it came from.
    pub(crate) fn is_written_elsewhere(&self) -> bool {
        self.write.is_some()
    }

    /// The model file, where it is to stay as it is.
    pub(crate) fn kept(&self) -> Vec<PathBuf> {
        let is_other = |model: &&PathBuf| target_of(model) != target_of(self.target());
        self.model.iter().filter(is_other).cloned().collect()
    }

    /// Where the revised file goes.
    pub(crate) fn target(&self) -> &Path {
        self.write.as_ref().or(self.model.as_ref()).map_or(Path::new(DEFAULT), PathBuf::as_path)
    }

    /// Refuses to replace a file that has models of joints which the revised one will not have.
    pub(crate) fn check_target(&self, read: &ModelFile, joints: &[Joint]) -> anyhow::Result<()> {
        let target = self.target();
        // What is no model is replaced as by every command.
        let Some(there) = target.is_file().then(|| read_model(target)).and_then(Result::ok) else {
            return Ok(());
        };
        let stays = |name: &&str| {
            read.joint(name).is_some() || joints.iter().any(|joint| joint.name == *name)
        };
        let lost: Vec<&str> = there.names().filter(|name| !stays(name)).collect();
        if lost.is_empty() {
            return Ok(());
        }
        let (name, lost) = (target.display(), lost.join(", "));
        bail!(
            "{name}: it has models of {lost}, which would be lost; `--model {name}` adds to it, \
             `--write FILE` starts another"
        )
    }

    /// Writes `revised` unless it is what was `read`.
    pub(crate) fn write(
        &self,
        read: &ModelFile,
        revised: &ModelFile,
        verbosity: Verbosity,
    ) -> anyhow::Result<()> {
        let target = self.target();
        let is_model =
            |path: &PathBuf| self.model.as_ref().is_some_and(|m| target_of(m) == target_of(path));
        let is_in_place = self.write.as_ref().is_none_or(is_model);
        if is_in_place {
            check_unchanged(target, read.text())?;
        }
        if is_in_place && read.text() == revised.text() {
            return Ok(());
        }
        write_bytes(target, revised.text())?;
        verbosity.say("model", target.display().to_string());
        Ok(())
    }
}

/// Reads a model file, which may name the effects of the program in whose place this works.
pub(crate) fn read_model(path: &Path) -> Result<ModelFile, ModelError> {
    let others = Host::current().map(|host| host.effects()).unwrap_or_default();
    ModelFile::read_with(path, &others)
}

/// Refuses to replace a file that somebody has edited since it was read.
fn check_unchanged(path: &Path, read: &str) -> anyhow::Result<()> {
    let name = path.display();
    let now = match read_text(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
        now => now.with_context(|| format!("{name}: cannot be read"))?,
    };
    if now != read {
        bail!(
            "{name}: it was changed by another program meanwhile and is not replaced; run the \
               command again"
        );
    }
    Ok(())
}

/// The name of a model in the output: that of its file.
pub(crate) fn name_of(path: Option<&Path>) -> String {
    let stem = path.and_then(Path::file_stem);
    stem.map_or_else(|| "integrator".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// The name of a model file that is not there yet.
pub(crate) fn fresh_name() -> String {
    let numbered = (2..).map(|number| format!("model-{number}.toml"));
    let mut names = std::iter::once(DEFAULT.to_owned()).chain(numbered);
    names.find(|name| !Path::new(name).exists()).unwrap_or_else(|| DEFAULT.to_owned())
}

/// Refuses a log in other units than the models of `file` were fitted in, and says which joints of it a
/// file that has some does not have.
pub(crate) fn check_models(
    file: &ModelFile,
    joints: &[Joint],
    verbosity: Verbosity,
) -> anyhow::Result<()> {
    if file.names().next().is_none() {
        return Ok(());
    }
    check_known(file, joints, verbosity)?;
    for joint in joints.iter().filter(|joint| file.joint(&joint.name).is_none()) {
        let name = &joint.name;
        // A name of the file that the log does not have may be a slip of the pen.
        let is_in_log = |name: &str| joints.iter().any(|joint| joint.name == name);
        let near = nearest_name(name, file.names().filter(|name| !is_in_log(name)));
        let near = near.map_or_else(String::new, |near| format!(", which has `{near}`"));
        let missing = format!(
            "joint `{name}`: not in the model file{near}; it starts as a plain \
             integrator"
        );
        verbosity.say("note", missing);
    }
    Ok(())
}

/// Refuses a log in other units than the models of `file` were fitted in, and says which effects do
/// nothing as no trial is of their condition, or their signal was not measured.
pub(crate) fn check_known(
    file: &ModelFile,
    joints: &[Joint],
    verbosity: Verbosity,
) -> anyhow::Result<()> {
    for joint in joints {
        file.check_units(joint)?;
    }
    for joint in joints {
        let name = &joint.name;
        let model = file.joint(name).into_iter();
        for effect in model.flat_map(JointModel::components).map(Component::effect) {
            let is_measured =
                |signal: &&str| joint.covariates.iter().any(|own| own.name == *signal);
            let is_there =
                |word: &str| joint.trials.iter().any(|trial| has_word(trial.label(), word));
            let signal = effect.measured_signal().filter(|signal| !is_measured(signal));
            let signal = signal.map(|signal| format!("the log has no column `{name}.{signal}`"));
            let word = effect.within_trials().map(|of| of.word).filter(|word| !is_there(word));
            let word = word.map(|word| format!("no trial has `{word}` in its label"));
            for none in signal.into_iter().chain(word) {
                let id = effect.spec().id;
                verbosity.say("note", format!("joint `{name}`: {none}: `{id}` does nothing"));
            }
        }
    }
    Ok(())
}

/// Which effects are tried.
#[derive(Args, Debug)]
#[command(next_help_heading = "Which model, and how it is fitted")]
pub(crate) struct EffectArgs {
    /// Effects that are tried, separated by commas [default: the catalogue and the
    /// candidates of the model file]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    effects: Vec<String>,
}

impl EffectArgs {
    /// How models are explained with these effects and those of `own`, which are tried and shown
    /// whether or not anything is missing. What differs between trials is tried, too, where no list
    /// was given.
    pub(crate) fn options(&self, own: &[&'static dyn Effect]) -> anyhow::Result<Options> {
        let tries_conditions = self.effects.is_empty();
        let are_asked_for = !self.effects.is_empty() || !own.is_empty();
        let tried = if are_asked_for { Tried::Always } else { Tried::WhereLacking };
        let effects = self.effects(own)?;
        Ok(Options { effects, tried, tries_conditions, ..Options::default() })
    }

    /// The effects of the list; all of the catalogue and of `own` without one.
    fn effects(&self, own: &[&'static dyn Effect]) -> anyhow::Result<Vec<&'static dyn Effect>> {
        if self.effects.is_empty() {
            return Ok(REGISTRY.iter().chain(own).copied().collect());
        }
        let mut effects: Vec<&'static dyn Effect> = Vec::new();
        for id in &self.effects {
            let effect = find(id.trim(), own).context("--effects")?;
            if effects.iter().all(|other| other.spec().id != effect.spec().id) {
                effects.push(effect);
            }
        }
        Ok(effects)
    }
}

/// The effect `id`, of the catalogue or of `own`.
pub(crate) fn find(id: &str, own: &[&'static dyn Effect]) -> anyhow::Result<&'static dyn Effect> {
    let lists = || anyhow!("`tauscope effects` lists the catalogue");
    find_among(id, own).map_err(|unknown| lists().context(unknown))
}

/// By what rules models are judged.
#[derive(Args, Debug)]
#[command(next_help_heading = "Which model, and how it is fitted")]
pub(crate) struct ProtocolArgs {
    /// How long a simulation runs before its angle is set to the measured one: `free`
    /// (never), `steps` (at every step of the input, in long holds every 2 s), seconds, or
    /// `auto`: free where the output follows its input, as a speed or a pressure does, else steps,
    /// where an error counts where it is made [default: auto]
    #[arg(long, value_name = "auto|free|steps|SECONDS", value_parser = horizon)]
    horizon: Option<Horizon>,

    /// Share of each trial's time that is for training; `blocks`: every third block of four runs
    /// is for validation; or `trials`: every third trial is [default: trials from six on, else
    /// blocks]
    #[arg(long, value_name = "SHARE|blocks|trials", value_parser = split)]
    split: Option<Split>,
}

impl ProtocolArgs {
    /// The rules, with this mode.
    pub(crate) fn with(&self, mode: Mode) -> Protocol {
        Protocol { mode, split: self.split, horizon: self.horizon.unwrap_or(Horizon::Auto) }
    }
}

/// What follows the effect in the command that adds it to the model of a joint, for each of
/// `joints`; the model is in the file `model`.
pub(crate) fn add_arguments(data: &DataArgs, model: &str, joints: &[Joint]) -> Vec<String> {
    let of_joint = |joint: &Joint| {
        let one_of_several = (joints.len() > 1).then_some(joint.name.as_str());
        let mut words = data.words(one_of_several, &["horizon", "split"]);
        words.extend(["--model".to_owned(), model.to_owned()]);
        quoted(&words)
    };
    joints.iter().map(of_joint).collect()
}

fn horizon(text: &str) -> Result<Horizon, String> {
    match text {
        "auto" => Ok(Horizon::Auto),
        "free" => Ok(Horizon::FreeRun),
        "steps" => Ok(Horizon::Steps),
        _ => {
            let seconds = text.parse().ok().filter(|s: &f64| s.is_finite() && *s > 0.0);
            seconds
                .map(Horizon::Seconds)
                .ok_or_else(|| "expected auto, free, steps, or seconds".to_owned())
        }
    }
}

fn split(text: &str) -> Result<Split, String> {
    match text {
        "blocks" => return Ok(Split::Blocks),
        "trials" => return Ok(Split::Trials),
        _ => {}
    }
    let share = text.parse().ok().filter(|share: &f64| *share > 0.0 && *share <= 1.0);
    share
        .map(Split::Time)
        .ok_or_else(|| "expected a share above 0 and up to 1, blocks, or trials".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_was_edited_meanwhile_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("boom.toml");
        assert!(check_unchanged(&path, "").is_ok(), "there is none yet");
        std::fs::write(&path, "one").unwrap();
        assert!(check_unchanged(&path, "one").is_ok());
        for read in ["", "another"] {
            let refused = check_unchanged(&path, read).unwrap_err().to_string();
            assert!(refused.contains("boom.toml") && refused.contains("changed"), "{refused}");
        }
    }
}
