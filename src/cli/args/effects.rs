//! Which effects are tried.

use anyhow::{Context as _, anyhow};
use clap::Args;

use crate::effect::{Effect, REGISTRY, find_among};
use crate::explain::{Options, Tried};

/// Which effects are tried.
#[derive(Args, Debug)]
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
