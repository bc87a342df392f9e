//! Schema `tauscope/sweep/1`, numbers in full precision.

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::header::Header;
use super::settings::SettingsJson;
use crate::delay::Settings;
use crate::delay::sweep::{
    Agreement, Factor, Grid, LevelSummary, RunSummary, Sensitivity, Spread, SweptStep,
};
use crate::report::sweep::{ReportedSweep, value};

/// The document of `sweep --format json`.
#[derive(Debug, Serialize)]
pub(crate) struct SweepJson<'a> {
    #[serde(flatten)]
    header: Header,
    tolerance_samples: f64,
    combinations: usize,
    settings: Vec<RunJson>,
    joints: Vec<JointJson<'a>>,
    notes: &'a [String],
    failures: &'a [String],
}

/// A run, and how many combinations it represents.
#[derive(Debug, Serialize)]
struct RunJson {
    combinations: usize,
    #[serde(flatten)]
    settings: SettingsJson,
}

#[derive(Debug, Serialize)]
struct JointJson<'a> {
    joint: &'a str,
    steps: usize,
    accepted_by_any: usize,
    settled: usize,
    hanging_on: Map<String, Value>,
    agreeing_settings: Vec<usize>,
    settings: Vec<Option<SettingJson>>,
    levels: Map<String, Value>,
    /// The levels for each kind of step, where these differ.
    #[serde(skip_serializing_if = "Map::is_empty")]
    levels_by_transition: Map<String, Value>,
    decisions: Vec<StepJson<'a>>,
}

/// A run over a joint.
#[derive(Debug, Serialize)]
struct SettingJson {
    accepted: usize,
    median_delay_s: Option<f64>,
    disagreements: usize,
    agrees: Option<f64>,
    lag_mean_s: Option<f64>,
}

/// A step over all runs; delays in samples.
#[derive(Debug, Serialize)]
struct StepJson<'a> {
    trial: &'a str,
    i: usize,
    p: usize,
    time_s: f64,
    sample_period_s: f64,
    tried: usize,
    accepted: usize,
    delay_samples: Value,
    agreed: Value,
    settled: bool,
    delay_hangs_on: Option<Value>,
    verdict_hangs_on: Option<&'static str>,
    apart_samples: f64,
    delays: Vec<Option<f64>>,
}

impl<'a> SweepJson<'a> {
    /// Collects the delays of all joints over `grid`; `failures` are messages on joints,
    /// files and settings that failed.
    pub(crate) fn new(
        grid: &'a Grid,
        tolerance_samples: f64,
        joints: &[ReportedSweep<'a>],
        notes: &'a [String],
        failures: &'a [String],
    ) -> Self {
        let run = |(index, settings): (usize, &'a Settings)| {
            let combinations = grid.combinations().iter().filter(|one| one.run == index).count();
            RunJson { combinations, settings: settings.into() }
        };
        Self {
            header: Header::of("tauscope/sweep/1"),
            tolerance_samples,
            combinations: grid.combinations().len(),
            settings: grid.runs().iter().enumerate().map(run).collect(),
            joints: joints.iter().map(|joint| JointJson::new(grid, joint)).collect(),
            notes,
            failures,
        }
    }
}

impl<'a> JointJson<'a> {
    fn new(grid: &Grid, reported: &ReportedSweep<'a>) -> Self {
        let sweep = reported.sweep;
        let hanging = |factor: Factor| {
            let on = |step: &&SweptStep| {
                step.delay_depends_on.as_ref().is_some_and(|hanging| hanging.factor == factor)
            };
            (id(factor).to_owned(), sweep.steps.iter().filter(on).count().into())
        };
        let agreeing = reported.agreeing().into_iter().enumerate();
        let each = |levels: &[Vec<LevelSummary>]| -> Map<String, Value> {
            let levels = Factor::ALL.into_iter().zip(levels);
            let level = |(factor, levels): (Factor, &Vec<LevelSummary>)| {
                (id(factor).to_owned(), levels_json(grid, factor, levels))
            };
            levels.map(level).collect()
        };
        let kinds = sweep.kinds.iter();
        let kinds = kinds.map(|(kind, levels)| (kind.id().to_owned(), each(levels).into()));
        Self {
            joint: &reported.joint.name,
            steps: sweep.steps.len(),
            accepted_by_any: sweep.judged().count(),
            settled: sweep.judged().filter(|step| step.is_unanimous()).count(),
            hanging_on: Factor::ALL.into_iter().map(hanging).collect(),
            agreeing_settings: agreeing.filter_map(|(n, agrees)| agrees.then_some(n)).collect(),
            settings: sweep.runs.iter().map(|run| run.as_ref().map(SettingJson::new)).collect(),
            levels: each(&sweep.levels),
            levels_by_transition: kinds.collect(),
            decisions: sweep.steps.iter().map(|step| StepJson::new(grid, step)).collect(),
        }
    }
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

fn levels_json(grid: &Grid, factor: Factor, levels: &[LevelSummary]) -> Value {
    let one = |(level, summary): (usize, &LevelSummary)| {
        json!({
            "value": value(grid, factor, level),
            "accepted": summary.accepted,
            "median_delay_s": summary.median_s,
            "shift_samples": summary.shift_samples,
            "disagrees": summary.disagrees,
        })
    };
    levels.iter().enumerate().map(one).collect()
}

impl SettingJson {
    fn new(run: &RunSummary) -> Self {
        Self {
            accepted: run.accepted,
            median_delay_s: run.median_s,
            disagreements: run.disagreements,
            agrees: run.agrees,
            lag_mean_s: run.lag_s,
        }
    }
}

impl<'a> StepJson<'a> {
    fn new(grid: &Grid, step: &'a SweptStep) -> Self {
        Self {
            trial: &step.trial,
            i: step.number,
            p: step.sample,
            time_s: step.logged_time_s,
            sample_period_s: step.period_s,
            tried: step.tried,
            accepted: step.accepted,
            delay_samples: step.spread.as_ref().map(spread_json).into(),
            agreed: step.agreement.as_ref().map(agreement_json).into(),
            settled: step.is_unanimous(),
            delay_hangs_on: step.delay_depends_on.as_ref().map(|found| hanging_json(grid, found)),
            verdict_hangs_on: step.verdict_depends_on.map(id),
            apart_samples: step.apart,
            delays: step.delays.iter().map(|found| found.map(|found| found.delay)).collect(),
        }
    }
}

fn spread_json(spread: &Spread) -> Value {
    json!({
        "min": spread.min, "lower_quartile": spread.lower_quartile, "median": spread.median,
        "upper_quartile": spread.upper_quartile, "max": spread.max,
    })
}

fn agreement_json(agreement: &Agreement) -> Value {
    json!({
        "delay": agreement.delay, "low": agreement.low, "high": agreement.high,
        "combinations": agreement.combinations,
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
    let levels: Vec<Value> = found.levels.iter().enumerate().map(level).collect();
    json!({ "setting": id(found.factor), "gap_samples": found.gap, "levels": levels })
}
