//! How delays move with the settings, as text and as schema `tauscope/sweep/1`.

pub(crate) mod text;

use serde_json::{Map, Value, json};

use super::json::{document, joined, without_empty};
use super::settings::settings_json;
use crate::delay::Settings;
use crate::delay::sweep::{Factor, Grid, JointSweep, LevelSummary, Sensitivity, SweptStep};
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
fn value(grid: &Grid, factor: Factor, level: usize) -> String {
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

/// The document of `sweep --format json`: the delays of all joints over `grid`; `failures` are
/// messages on joints, files and settings that failed.
pub(crate) fn sweep_json(
    grid: &Grid,
    tolerance_samples: f64,
    joints: &[ReportedSweep<'_>],
    notes: &[String],
    failures: &[String],
) -> Value {
    let run = |(index, settings): (usize, &Settings)| {
        let combinations = grid.combinations().iter().filter(|one| one.run == index).count();
        joined([json!({ "combinations": combinations }), settings_json(settings)])
    };
    let facts = json!({
        "tolerance_samples": tolerance_samples,
        "combinations": grid.combinations().len(),
        "settings": grid.runs().iter().enumerate().map(run).collect::<Value>(),
        "joints": joints.iter().map(|joint| joint_json(grid, joint)).collect::<Value>(),
        "notes": notes,
        "failures": failures,
    });
    document("tauscope/sweep/1", facts)
}

fn joint_json(grid: &Grid, reported: &ReportedSweep<'_>) -> Value {
    let sweep = reported.sweep;
    let hanging = |factor: Factor| {
        let on = |step: &&SweptStep| {
            step.delay_depends_on.as_ref().is_some_and(|hanging| hanging.factor == factor)
        };
        (id(factor).to_owned(), sweep.steps.iter().filter(on).count().into())
    };
    let kinds = sweep.kinds.iter();
    let kinds = kinds.map(|(kind, levels)| (kind.id().to_owned(), levels_json(grid, levels)));
    let agreeing = reported.agreeing().into_iter().enumerate();
    let agreeing = agreeing.filter_map(|(run, agrees)| agrees.then_some(run));
    let facts = json!({
        "joint": reported.joint.name,
        "steps": sweep.steps.len(),
        "accepted_by_any": sweep.judged().count(),
        "settled": sweep.judged().filter(|step| step.is_unanimous()).count(),
        "hanging_on": Factor::ALL.into_iter().map(hanging).collect::<Map<_, _>>(),
        "agreeing_settings": agreeing.collect::<Vec<_>>(),
        "settings": sweep.runs,
        "levels": levels_json(grid, &sweep.levels),
        "levels_by_transition": kinds.collect::<Map<_, _>>(),
        "decisions": sweep.steps.iter().map(|step| step_json(grid, step)).collect::<Value>(),
    });
    without_empty(facts, &["levels_by_transition"])
}

/// The name of a factor as a key.
fn id(factor: Factor) -> &'static str {
    match factor {
        Factor::Method => "method",
        Factor::Passband => "passband",
        Factor::Alpha => "alpha",
        Factor::Beta => "beta",
    }
}

/// What each value of each setting does.
fn levels_json(grid: &Grid, levels: &[Vec<LevelSummary>]) -> Value {
    let of_factor = |(factor, levels): (Factor, &Vec<LevelSummary>)| {
        let one = |(level, summary): (usize, &LevelSummary)| {
            json!({
                "value": value(grid, factor, level),
                "accepted": summary.accepted,
                "median_delay_s": summary.median_s,
                "shift_samples": summary.shift_samples,
                "disagrees": summary.disagrees,
            })
        };
        (id(factor), levels.iter().enumerate().map(one).collect::<Value>())
    };
    Factor::ALL.into_iter().zip(levels).map(of_factor).collect()
}

/// A step over all runs; delays in samples.
fn step_json(grid: &Grid, step: &SweptStep) -> Value {
    let delays = step.delays.iter().map(|found| found.map(|found| found.delay));
    json!({
        "trial": step.trial,
        "i": step.number,
        "p": step.sample,
        "time_s": step.logged_time_s,
        "sample_period_s": step.period_s,
        "tried": step.tried,
        "accepted": step.accepted,
        "delay_samples": step.spread,
        "agreed": step.agreement,
        "settled": step.is_unanimous(),
        "delay_hangs_on": step.delay_depends_on.as_ref().map(|found| hanging_json(grid, found)),
        "verdict_hangs_on": step.verdict_depends_on.map(id),
        "apart_samples": step.apart,
        "delays": delays.collect::<Vec<_>>(),
    })
}

fn hanging_json(grid: &Grid, found: &Sensitivity) -> Value {
    let level = |(level, seen): (usize, &Option<(f64, f64)>)| {
        json!({
            "value": value(grid, found.factor, level),
            "median_delay": seen.map(|seen| seen.0),
            "agree": seen.map(|seen| seen.1),
        })
    };
    let levels: Value = found.levels.iter().enumerate().map(level).collect();
    json!({ "setting": id(found.factor), "gap_samples": found.gap, "levels": levels })
}
