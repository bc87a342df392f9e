//! How delays move with the settings, as schema `tauscope/sweep/1` and as text: a sentence for each joint,
//! what each value of a setting does, and the steps to look at.

use serde_json::{Map, Value, json};

use super::json::{document, joined, without_empty};
use super::settings::settings_json;
use crate::delay::Settings;
use crate::delay::sweep::{Factor, Grid, JointSweep, LevelSummary, Sensitivity, SweptStep};
use crate::experiment::Joint;
use crate::report::TextTable;
use crate::wording::{percent, rounded, wrapped};

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

/// How many of the steps that depend on a setting are shown where not all are asked for, and how many
/// of one joint: where all its steps depend on the method the first ones show it.
pub(crate) const WORST: [usize; 2] = [10, 3];

/// The text of `sweep`.
pub(crate) fn sweep_text(
    grid: &Grid,
    tolerance: f64,
    joints: &[ReportedSweep<'_>],
    shown: [usize; 2],
) -> String {
    // A joint in sentences each.
    let paragraphs = joints.iter().map(|reported| {
        let sentences = sweep_sentences(grid, reported).join(" ");
        wrapped(&format!("{}: {sentences}", reported.joint.name))
    });
    let note = format!(
        "{} combinations of settings. Two delays agree if they differ by no more than {} samples \
         beyond the resolution of each: ± β/2, or its interval.",
        grid.combinations().len(),
        rounded(tolerance)
    );
    let of_values = "Median delay with each value of a setting, and the percentage of its delays \
                     that differ from the majority:";
    [
        paragraphs.collect::<Vec<_>>().join("\n"),
        format!("{}\n{}", wrapped(of_values), levels_table(grid, joints)),
        steps_part(grid, joints, shown),
        wrapped(&note),
    ]
    .join("\n\n")
        + "\n"
}

/// How many delays are the same, what the others depend on, and which settings agree.
pub(crate) fn sweep_sentences(grid: &Grid, reported: &ReportedSweep<'_>) -> Vec<String> {
    let judged = reported.sweep.judged().count();
    if judged == 0 {
        return vec!["no step is accepted with any of the settings.".to_owned()];
    }
    let settled = reported.sweep.judged().filter(|step| step.is_unanimous()).count();
    let mut sentences = vec![match judged - settled {
        0 => format!("all {judged} delays are the same whatever the settings."),
        _ => format!(
            "{settled} of {judged} delays are the same whatever the settings. {}.",
            on_what(reported)
        ),
    }];
    if settled < judged {
        sentences.push(who_agrees(grid, reported));
    }
    sentences.extend(lag_sentence(grid, reported));
    sentences
}

/// On which settings how many delays depend.
fn on_what(reported: &ReportedSweep<'_>) -> String {
    let hanging = reported.sweep.sensitive();
    let (moved, accepted_by_some): (Vec<_>, Vec<_>) =
        hanging.into_iter().partition(|step| step.disagreeing() > 0);
    let on = |factor: Option<Factor>| {
        let own = |step: &&&SweptStep| step.delay_depends_on.as_ref().map(|on| on.factor) == factor;
        moved.iter().filter(own).count()
    };
    let known = Factor::ALL.map(|factor| (on(Some(factor)), named(factor)));
    let mut parts: Vec<_> = known.into_iter().collect();
    parts.push((on(None), "several settings at once".to_owned()));
    parts.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
    parts.retain(|(count, _)| *count > 0);
    let part = |(index, (count, what)): (usize, &(usize, String))| match (index, count) {
        (0, 1) => format!("1 depends on {what}"),
        (0, _) => format!("{count} depend on {what}"),
        _ => format!("{count} on {what}"),
    };
    let mut parts: Vec<String> = parts.iter().enumerate().map(part).collect();
    match accepted_by_some.len() {
        0 => {}
        1 => parts.push("1 is accepted by some settings only".to_owned()),
        count => parts.push(format!("{count} are accepted by some settings only")),
    }
    parts.join(", ")
}

fn named(factor: Factor) -> String {
    match factor {
        Factor::Method | Factor::Passband => format!("the {factor}"),
        Factor::Alpha | Factor::Beta => factor.to_string(),
    }
}

/// How many settings agree with each other.
fn who_agrees(grid: &Grid, reported: &ReportedSweep<'_>) -> String {
    let agreeing = reported.agreeing();
    let agrees = grid.combinations().iter().filter(|one| agreeing.get(one.run) == Some(&true));
    let (agree, all) = (agrees.count(), grid.combinations().len());
    format!("{agree} of {all} combinations of settings agree on nine steps of ten.")
}

/// Where a lag was found that other methods take for delay.
fn lag_sentence(grid: &Grid, reported: &ReportedSweep<'_>) -> Option<String> {
    let periods = reported.joint.trials.iter().map(|trial| trial.period().seconds());
    let longest = periods.fold(0.0, f64::max);
    let of_run = |(index, run): (usize, &Option<crate::delay::sweep::RunSummary>)| {
        let lag_s = run.as_ref()?.lag_s?;
        let settings = grid.runs().get(index)?;
        // Less than a sample is no lag that another method could take for delay.
        (lag_s >= longest).then_some((settings, lag_s))
    };
    let mut lags = reported.sweep.runs.iter().enumerate().filter_map(of_run);
    let (settings, seconds) = lags.next()?;
    let others = grid.bases().len() > 1;
    others.then(|| {
        format!(
            "`{}` finds a lag of {} s, which the other methods count as delay: they agree, but \
             all are too late by about the lag.",
            settings.method,
            rounded(seconds)
        )
    })
}

/// What each value of a setting does to each joint.
fn levels_table(grid: &Grid, joints: &[ReportedSweep<'_>]) -> TextTable {
    let columns: Vec<(String, &[Vec<LevelSummary>])> = joints.iter().flat_map(columns).collect();
    let names = columns.iter().map(|(name, _)| name.clone());
    let header: Vec<String> = std::iter::once("setting".to_owned()).chain(names).collect();
    let mut rows = Vec::new();
    for (index, factor) in Factor::ALL.into_iter().enumerate() {
        let varied = grid.levels(factor) > 1;
        for level in (0..grid.levels(factor)).filter(|_| varied) {
            let of_column = |(_, levels): &(String, &[Vec<LevelSummary>])| {
                let summary = levels.get(index).and_then(|levels| levels.get(level));
                summary.map_or_else(|| "-".to_owned(), level_cell)
            };
            let name = level_text(grid, factor, level);
            rows.push(std::iter::once(name).chain(columns.iter().map(of_column)).collect());
        }
    }
    TextTable { numbers: (1..header.len()).collect(), header, rows }
}

/// The columns of a joint: one, or one for each kind of step where these differ.
fn columns<'a>(reported: &ReportedSweep<'a>) -> Vec<(String, &'a [Vec<LevelSummary>])> {
    let (name, sweep) = (&reported.joint.name, reported.sweep);
    if sweep.kinds.is_empty() {
        return vec![(name.clone(), &sweep.levels)];
    }
    let kinds = sweep.kinds.iter();
    kinds.map(|(kind, levels)| (format!("{name}, {kind}"), levels.as_slice())).collect()
}

/// The median delay, and the part of delays that are not what most say.
pub(crate) fn level_cell(summary: &LevelSummary) -> String {
    match (summary.median_s, summary.disagrees) {
        (Some(seconds), Some(part)) => format!("{seconds:.3} s {:>5}", percent(part)),
        _ => "-".to_owned(),
    }
}

/// The steps that depend on a setting, worst first.
fn steps_part(grid: &Grid, joints: &[ReportedSweep<'_>], [most, of_one]: [usize; 2]) -> String {
    let all: usize = joints.iter().map(|joint| joint.sweep.sensitive().len()).sum();
    let mut steps: Vec<(&str, &SweptStep)> = Vec::new();
    for ReportedSweep { joint, sweep } in joints {
        let worst = sweep.sensitive().into_iter().take(of_one);
        steps.extend(worst.map(|step| (joint.name.as_str(), step)));
    }
    // As in each joint; the sort is stable, so that joints keep their order.
    steps.sort_by(|(_, a), (_, b)| b.apart.total_cmp(&a.apart));
    if all == 0 {
        return "No step depends on a setting.".to_owned();
    }
    steps.truncate(most);
    let header = ["look at", "trial", "step", "at", "most say", "agree", "range", "depends on"];
    let mut table = TextTable::new(header, &[2, 3, 4, 5]);
    for (name, step) in &steps {
        table.row(step_cells(grid, name, step));
    }
    let more = match all - steps.len() {
        0 => String::new(),
        more => format!("\n{more} more steps depend on a setting: `--steps` shows all."),
    };
    format!("{table}{more}")
}

fn step_cells(grid: &Grid, name: &str, step: &SweptStep) -> [String; 8] {
    let seconds = |samples: f64| format!("{:.3} s", samples * step.period_s);
    let dash = || "-".to_owned();
    let agree = |part: usize| percent(part as f64 / step.tried.max(1) as f64);
    [
        name.to_owned(),
        step.trial.clone(),
        step.number.to_string(),
        format!("{:.2} s", step.time_s),
        step.agreement.map_or_else(dash, |agreed| seconds(agreed.delay)),
        step.agreement.map_or_else(dash, |agreed| agree(agreed.combinations)),
        step.spread.map_or_else(dash, |all| {
            format!("{:.3} … {}", all.min * step.period_s, seconds(all.max))
        }),
        depends_on(grid, step),
    ]
}

/// On what a step depends, and what the odd values of that setting say.
pub(crate) fn depends_on(grid: &Grid, step: &SweptStep) -> String {
    let delay = step.delay_depends_on.as_ref().map(|found| odd_levels(grid, found, step.period_s));
    let accepted = percent(step.accepted as f64 / step.tried.max(1) as f64);
    let verdict = step.verdict_depends_on.map(|factor| format!("{factor}, {accepted} accept it"));
    let several = (step.disagreeing() > 0 && delay.is_none()).then(|| "several at once".to_owned());
    [delay, several, verdict].into_iter().flatten().collect::<Vec<_>>().join("; ")
}

/// The setting, with those of its values that mostly disagree, or the one that most does.
fn odd_levels(grid: &Grid, found: &Sensitivity, period_s: f64) -> String {
    /// Values that are shown.
    const SHOWN: usize = 2;
    let name = |level: usize| level_text(grid, found.factor, level);
    let known = found.levels.iter().enumerate();
    let known = known.filter_map(|(level, seen)| seen.map(|(delay, agree)| (level, delay, agree)));
    let known: Vec<(usize, f64, f64)> = known.collect();
    let odd = known.iter().filter(|(_, _, agree)| *agree < 0.5);
    let odd =
        odd.map(|(level, delay, _)| format!("{} says {:.3} s", name(*level), delay * period_s));
    let mut odd: Vec<String> = odd.collect();
    if odd.is_empty() {
        let most = known.iter().min_by(|a, b| a.2.total_cmp(&b.2));
        odd.extend(most.map(|(level, ..)| format!("{} at times", name(*level))));
    }
    if odd.len() > SHOWN {
        odd.truncate(SHOWN);
        odd.push("…".to_owned());
    }
    let odd = odd.join(", ");
    match found.factor {
        Factor::Method | Factor::Passband => format!("{}: {odd}", found.factor),
        Factor::Alpha | Factor::Beta => odd,
    }
}
