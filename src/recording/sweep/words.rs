//! A joint in words; the setting and the step under the cursor; the steps to look at; and what a program
//! reads: a row per setting, and a row per step.

use std::fmt::Write as _;

use serde_json::Value;

use super::swept::{Opinion, Swept};
use crate::delay::Settings;
use crate::delay::sweep::{Factor, RunSummary, SweptStep};
use crate::recording::chunk::{Chunks, columns, lists};
use crate::recording::error::RecordError;
use crate::recording::markdown::plain;
use crate::recording::paths;
use crate::report::Kind::{self, Real, Text, Whole};
use crate::report::sweep::{depends_on, level_cell, level_text, sweep_sentences};
use crate::units::Length;
use crate::wording::{capitalized, number};

/// Adds all words below `root`.
pub(super) fn add(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    chunks.page(paths::FOUND, found(swept).unwrap_or_default())?;
    let settings = (0..swept.names.len()).map(|run| setting(swept, run).unwrap_or_default());
    chunks.pages(paths::HERE, swept.settings(), settings)?;
    let steps = swept.steps.iter().map(|(step, _)| one_step(swept, step).unwrap_or_default());
    chunks.pages(paths::HERE, swept.index.clone(), steps)?;
    // A line for each step that is sensitive to a setting, in the order of the record.
    let sensitive: Vec<usize> = (0..swept.steps.len())
        .filter(|place| {
            let (step, _) = swept.steps[*place];
            step.accepted > 0 && !step.is_unanimous()
        })
        .collect();
    // All of them are there from the first setting on.
    let index = swept.index.rows(&sensitive).all_at("setting", Some(1));
    let lines = sensitive.iter().map(|place| (None, line(swept, swept.steps[*place].0)));
    chunks.lines(paths::SENSITIVE_LOG, index, lines)
}

/// A step, and what it is sensitive to.
fn line(swept: &Swept<'_>, step: &SweptStep) -> String {
    let agreed = step.agreement.map_or(0.0, |agreed| agreed.delay * step.period_s);
    let (number, on) = (step.number, depends_on(swept.grid, step));
    format!("step {number} at {:.2} s: {on}; most say {agreed:.3} s", step.time_s)
}

type Written = Result<String, std::fmt::Error>;

/// What the settings make of the joint.
fn found(swept: &Swept<'_>) -> Written {
    let mut page = String::new();
    writeln!(page, "## {}\n", plain(&swept.reported.joint.name))?;
    for (place, sentence) in sweep_sentences(swept.grid, &swept.reported).iter().enumerate() {
        let mark = if place == 0 { "**" } else { "" };
        writeln!(page, "{mark}{}{mark}\n", plain(&capitalized(sentence)))?;
    }
    writeln!(page, "| setting | median delay, part that differs from most |\n|---|---|")?;
    for (factor, levels) in Factor::ALL.into_iter().zip(&swept.reported.sweep.levels) {
        for (level, summary) in levels.iter().enumerate().filter(|_| levels.len() > 1) {
            let name = level_text(swept.grid, factor, level);
            writeln!(page, "| {} | {} |", plain(&name), level_cell(summary))?;
        }
    }
    writeln!(page, "\n{HOW_TO_READ}")?;
    Ok(page)
}

const HOW_TO_READ: &str = "\
*Each column of the lowest picture is a step, each row a combination of settings, by method, \
low-pass, α and β from top to bottom. A row with much orange or blue is a setting that differs; \
such a column is a delay that is sensitive to a setting. Right and left arrow go from setting to setting; \
on the timeline `segment` from step to step.*";

/// A run in numbers.
fn setting(swept: &Swept<'_>, run: usize) -> Written {
    let mut page = String::new();
    let name = swept.names.get(run).map_or("", String::as_str);
    writeln!(page, "## {name}\n")?;
    writeln!(page, "| setting {} of {} | |\n|---|---|", run + 1, swept.names.len())?;
    let votes = swept.votes.get(run).copied().unwrap_or(0);
    writeln!(page, "| combinations that it represents | {votes} |")?;
    let Some(summary) = swept.reported.sweep.runs.get(run).and_then(Option::as_ref) else {
        writeln!(page, "| | **it cannot be used on this record** |")?;
        return Ok(page);
    };
    let steps = swept.steps.len();
    writeln!(page, "| steps accepted | {} of {steps} |", summary.accepted)?;
    let median = summary.median_s.map_or("-".to_owned(), |s| format!("{} s", number(s)));
    writeln!(page, "| median delay | {median} |")?;
    writeln!(page, "| delays that differ from most | {} |", summary.disagreements)?;
    if let Some(lag_s) = summary.lag_s {
        writeln!(page, "| lag, apart from the delays | {} s |", number(lag_s))?;
    }
    let differs: Vec<String> =
        swept.steps.iter().filter_map(|(step, _)| differing(step, run)).collect();
    if !differs.is_empty() {
        writeln!(page, "\nIt differs on step {}.", listed(&differs))?;
    }
    Ok(page)
}

/// A step on which a run differs, and what it says.
fn differing(step: &SweptStep, run: usize) -> Option<String> {
    let delay = Swept::delay(step, run)? * step.period_s;
    match Swept::cell(step, run).opinion {
        Opinion::Longer | Opinion::Shorter => Some(format!("{} ({delay:.3} s)", step.number)),
        Opinion::Same | Opinion::Silent => None,
    }
}

/// The first of `texts`, and how many more there are.
fn listed(texts: &[String]) -> String {
    /// Texts that are said.
    const SAID: usize = 12;
    let said = texts.get(..SAID).unwrap_or(texts).join(", ");
    match texts.len().saturating_sub(SAID) {
        0 => said,
        more => format!("{said} and {more} more"),
    }
}

/// A step in numbers.
fn one_step(swept: &Swept<'_>, step: &SweptStep) -> Written {
    let mut page = String::new();
    let seconds = |samples: f64| format!("{:.3} s", samples * step.period_s);
    let (number, trial) = (step.number, plain(&step.trial));
    writeln!(page, "## Step {number} of trial {trial}, at {:.2} s\n", step.time_s)?;
    writeln!(page, "| p = {} | |\n|---|---|", step.sample)?;
    writeln!(page, "| settings that accept it | {} of {} |", step.accepted, step.tried)?;
    if let (Some(agreed), Some(spread)) = (step.agreement, step.spread) {
        let votes = agreed.combinations;
        writeln!(page, "| most say | **{}**, {votes} of them |", seconds(agreed.delay))?;
        writeln!(page, "| range of all | {} to {} |", seconds(spread.min), seconds(spread.max))?;
    }
    let on = depends_on(swept.grid, step);
    let on = if on.is_empty() { "no setting".to_owned() } else { on };
    writeln!(page, "| sensitive to | {} |", plain(&on))?;
    let Some(hanging) = &step.delay_depends_on else { return Ok(page) };
    writeln!(page, "\n| {} | median delay | agree with most |\n|---|---|---|", hanging.factor)?;
    for (level, found) in hanging.levels.iter().enumerate() {
        let name = level_text(swept.grid, hanging.factor, level);
        let (delay, agree) = found.map_or(("-".to_owned(), "-".to_owned()), |(delay, agree)| {
            (seconds(delay), format!("{:.0} %", 100.0 * agree))
        });
        writeln!(page, "| {} | {delay} | {agree} |", plain(&name))?;
    }
    Ok(page)
}

/// Settings, what they made of the record, and how many combinations they represent.
type Run<'s> = (&'s Settings, Option<&'s RunSummary>, usize);

type OfRun = fn(&Run<'_>) -> Value;
type OfStep = fn(&&SweptStep) -> Value;

/// A row per run.
#[rustfmt::skip]
const SETTING: &[(&str, Kind, OfRun)] = &[
    ("method", Text, |(run, ..)| run.method.to_string().into()),
    ("passband_hz", Real, |(run, ..)| run.low_pass.map(|low_pass| low_pass.cutoff_hz).into()),
    ("alpha", Whole, |(run, ..)| samples(run.alpha_length()).into()),
    ("beta", Whole, |(run, ..)| samples(run.beta_length()).filter(|_| !run.method.spec().has_intervals).into()),
    ("combinations", Whole, |(.., combinations)| (*combinations).into()),
    ("accepted", Whole, |(_, found, _)| found.map(|run| run.accepted).into()),
    ("disagreements", Whole, |(_, found, _)| found.map(|run| run.disagreements).into()),
    ("median_delay_s", Real, |(_, found, _)| found.and_then(|run| run.median_s).into()),
    ("agrees", Real, |(_, found, _)| found.and_then(|run| run.agrees).into()),
    ("lag_mean_s", Real, |(_, found, _)| found.and_then(|run| run.lag_s).into()),
];

/// A row per step.
#[rustfmt::skip]
const STEP: &[(&str, Kind, OfStep)] = &[
    ("trial", Text, |step| step.trial.as_str().into()),
    ("i", Whole, |step| step.number.into()),
    ("p", Whole, |step| step.sample.into()),
    ("tried", Whole, |step| step.tried.into()),
    ("accepted", Whole, |step| step.accepted.into()),
    ("agree", Whole, |step| (step.accepted - step.disagreeing()).into()),
    ("agreed", Real, |step| step.agreement.map(|agreed| agreed.delay).into()),
    ("agreed_low", Real, |step| step.agreement.map(|agreed| agreed.low).into()),
    ("agreed_high", Real, |step| step.agreement.map(|agreed| agreed.high).into()),
    ("min", Real, |step| step.spread.map(|all| all.min).into()),
    ("max", Real, |step| step.spread.map(|all| all.max).into()),
    ("delay_hangs_on", Text, |step| step.delay_depends_on.as_ref().map(|on| on.factor.to_string()).into()),
    ("verdict_hangs_on", Text, |step| step.verdict_depends_on.map(|on| on.to_string()).into()),
];

/// A number of samples; none of what is in seconds.
fn samples(length: Length) -> Option<usize> {
    match length {
        Length::Samples(samples) => Some(samples),
        Length::Seconds(_) => None,
    }
}

/// Adds `/sweep/setting` and `/sweep/step` below `root`.
pub(super) fn add_numbers(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    let runs = swept.grid.runs().iter().zip(&swept.reported.sweep.runs).zip(&swept.votes);
    let runs: Vec<Run<'_>> =
        runs.map(|((run, found), votes)| (run, found.as_ref(), *votes)).collect();
    let all = &swept.reported.sweep.steps;
    let of_run = |run: usize| all.iter().map(|step| Swept::delay(step, run)).collect::<Vec<_>>();
    let mut settings = columns(&runs, SETTING);
    settings.push(lists("delays", &(0..runs.len()).map(of_run).collect::<Vec<_>>()));
    chunks.push("sweep/setting", swept.settings(), settings)?;
    let steps: Vec<&SweptStep> = swept.steps.iter().map(|(step, _)| *step).collect();
    let of_step = |step: &&SweptStep| {
        (0..step.delays.len()).map(|run| Swept::delay(step, run)).collect::<Vec<_>>()
    };
    let mut of_steps = columns(&steps, STEP);
    of_steps.push(lists("delays", &steps.iter().map(of_step).collect::<Vec<_>>()));
    chunks.push("sweep/step", swept.index.clone(), of_steps)
}
