//! Schema `tauscope/sweep/1`, numbers in full precision.

use serde_json::{Map, Value, json};

use super::document::{document, joined, without_empty};
use super::settings::settings_json;
use crate::delay::Settings;
use crate::delay::sweep::{Factor, Grid, LevelSummary, Sensitivity, SweptStep};
use crate::report::sweep::{ReportedSweep, value};

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
