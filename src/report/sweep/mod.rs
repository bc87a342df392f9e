//! How delays move with the settings, as text and JSON.

mod sets;
mod text;

pub(crate) use text::{
    StepsShown, depends_on, level_cell, settings_in_words, sweep_sentences, sweep_text,
};

use crate::delay::Settings;
use crate::delay::sweep::{Factor, Grid, JointSweep};
use crate::experiment::Joint;

/// Part of the steps, of those that most settings agree on, on which a setting must agree
/// to be named among those that do.
const AGREES: f64 = 0.9;

/// A joint as it was measured, and its delays over all settings.
#[derive(Clone, Copy, Debug)]
pub struct ReportedSweep<'a> {
    /// What was measured.
    pub joint: &'a Joint,
    /// What the settings make of it.
    pub sweep: &'a JointSweep,
}

impl ReportedSweep<'_> {
    /// For each run whether it agrees with most of the others on nine steps of ten.
    pub fn agreeing(&self) -> Vec<bool> {
        let runs = self.sweep.runs.iter();
        runs.map(|run| run.as_ref().and_then(|run| run.agrees) >= Some(AGREES)).collect()
    }
}

/// A run in words: the values of all settings that its method knows.
pub(crate) fn run_text(settings: &Settings) -> String {
    let low_pass = settings.low_pass;
    let low_pass = low_pass.map_or("no low-pass".to_owned(), |l| format!("{} Hz", l.cutoff_hz));
    let mut words =
        vec![settings.method.to_string(), low_pass, format!("α {}", settings.alpha_length())];
    let has_rows = !settings.method.spec().has_intervals;
    words.extend(has_rows.then(|| format!("β {}", settings.beta_length())));
    words.join(", ")
}

/// A value of a setting as an option takes it.
pub(super) fn value(grid: &Grid, factor: Factor, level: usize) -> String {
    let found = match factor {
        Factor::Method => grid.bases().get(level).map(|base| base.settings.method.to_string()),
        Factor::Passband => grid.passbands().get(level).map(|low_pass| {
            low_pass.map_or_else(|| "none".to_owned(), |low_pass| low_pass.cutoff_hz.to_string())
        }),
        Factor::Alpha => grid.alphas().get(level).map(ToString::to_string),
        Factor::Beta => grid.betas().get(level).map(ToString::to_string),
    };
    found.unwrap_or_default()
}

/// A value of a setting in words.
pub(crate) fn level_text(grid: &Grid, factor: Factor, level: usize) -> String {
    let value = value(grid, factor, level);
    match (factor, value.as_str()) {
        (Factor::Method, _) => value,
        (Factor::Passband, "none") => "no low-pass".to_owned(),
        (Factor::Passband, _) => format!("{value} Hz"),
        (Factor::Alpha | Factor::Beta, _) => format!("{factor} {value}"),
    }
}
