//! Settings of single joints, out of the file given with `--columns`.

use std::collections::BTreeMap;

use anyhow::anyhow;

use super::algorithm::{FIRST_LAST, INPUT, confidence, limits, low_pass, passband};
use super::number::{chosen, length, length_or_none, probability, threshold};
use crate::delay::Settings;
use crate::experiment::{Experiment, Joint, ReadOptions};

/// Changes settings to what a text says.
type Set = fn(&str, Settings) -> Result<Settings, String>;

/// The settings that a joint may have of its own, named like the options.
const SETTINGS: [(&str, Set); 13] = [
    ("alpha", |text, it| Ok(it.with_alpha(length(text)?))),
    ("beta", |text, it| Ok(it.with_beta(length(text)?))),
    ("passband", |text, it| {
        let order = it.low_pass.map_or(4, |usual| usual.order);
        let low_pass = low_pass(passband(text)?, order);
        Ok(Settings { low_pass, low_pass_required: true, ..it })
    }),
    ("min_delay", |text, it| Ok(it.with_min_delay(length_or_none(text)?))),
    ("max_delay", |text, it| Ok(it.with_max_delay(length(text)?))),
    ("output_limits", |text, it| Ok(Settings { output_limits: Some(limits(text)?), ..it })),
    ("min_slope_change", |text, it| Ok(Settings { min_slope_change: threshold(text)?, ..it })),
    ("max_sse", |text, it| Ok(Settings { max_sse: Some(threshold(text)?), ..it })),
    ("min_step", |text, it| Ok(Settings { min_step: threshold(text)?, ..it })),
    ("confidence", |text, it| Ok(Settings { confidence: confidence(text)?.number(), ..it })),
    ("interval", |text, it| Ok(Settings { interval: probability(text)?, ..it })),
    ("first_last", |text, it| Ok(Settings { first_last: chosen(FIRST_LAST, text)?, ..it })),
    ("input", |text, it| Ok(Settings { input: chosen(INPUT, text)?, ..it })),
];

/// The settings that single joints have of their own; they stand above the options, which are
/// for all joints.
#[derive(Debug, Default)]
pub(crate) struct OwnSettings {
    joints: BTreeMap<String, Vec<(Set, String)>>,
}

impl OwnSettings {
    /// Those of `options`.
    ///
    /// # Errors
    /// When a name or a value cannot be used.
    pub(crate) fn of(options: &ReadOptions) -> anyhow::Result<Self> {
        let mut own = Self::default();
        for (joint, settings) in &options.columns.estimate {
            for (name, text) in settings {
                let wrong =
                    |why: String| anyhow!("--columns: [joint.{joint}.estimate] {name}: {why}");
                let known = SETTINGS.iter().find(|(known, _)| known == name);
                let (_, set) = known.ok_or_else(|| {
                    let names = SETTINGS.map(|(name, _)| name).join(", ");
                    wrong(format!("expected one of {names}"))
                })?;
                set(text, Settings::default()).map_err(wrong)?;
                own.joints.entry(joint.clone()).or_default().push((*set, text.clone()));
            }
        }
        Ok(own)
    }

    /// What is asked for of `joint`, where `asked` is for all of them.
    pub(crate) fn of_joint(&self, joint: &Joint, asked: &Settings) -> Settings {
        let own = self.joints.get(&joint.name).map_or(&[][..], Vec::as_slice);
        let mut settings = asked.clone();
        for (set, text) in own {
            settings = set(text, settings.clone()).unwrap_or(settings);
        }
        settings.in_samples(&joint.trials)
    }

    /// A note on each joint that has settings and is in no log.
    pub(crate) fn notes(&self, experiment: &Experiment) -> Vec<String> {
        let is_there = |name: &String| experiment.joints.iter().any(|joint| &joint.name == name);
        let missing = self.joints.keys().filter(|name| !is_there(name));
        let note =
            |name: &String| format!("[joint.{name}.estimate]: the logs have no joint `{name}`");
        missing.map(note).collect()
    }
}
