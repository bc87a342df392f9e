//! A joint in words; the setting and the step under the cursor; the steps to look at; and what a program
//! reads: a row per setting, and a row per step.

use serde_json::Value;

use super::swept::{Opinion, Swept};
use crate::delay::Settings;
use crate::delay::sweep::{Factor, RunSummary, SweptStep};
use crate::recording::chunk::{Chunks, columns, lists};
use crate::recording::error::RecordError;
use crate::recording::markdown::plain;
use crate::recording::paths;
use crate::report::Kind::{self, Real, Text, Whole};
use crate::report::TextTable;
use crate::report::sweep::{depends_on, level_cell, level_text, sweep_sentences};
use crate::units::Length;
use crate::wording::{capitalized, number, percent};

/// Adds all words below `root`.
pub(super) fn add(chunks: &mut Chunks, swept: &Swept<'_>) -> Result<(), RecordError> {
    chunks.page(paths::FOUND, found(swept))?;
    let settings = (0..swept.names.len()).map(|run| setting(swept, run));
    chunks.pages(paths::HERE, swept.settings(), settings)?;
    let steps = swept.steps.iter().map(|(step, _)| one_step(swept, step));
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

/// What the settings make of the joint.
fn found(swept: &Swept<'_>) -> String {
    let sentences = sweep_sentences(swept.grid, &swept.reported).into_iter().enumerate();
    let sentences = sentences.map(|(place, sentence)| {
        let mark = if place == 0 { "**" } else { "" };
        format!("{mark}{}{mark}\n\n", plain(&capitalized(&sentence)))
    });
    let varied = Factor::ALL.into_iter().zip(&swept.reported.sweep.levels);
    let rows = varied.filter(|(_, levels)| levels.len() > 1).flat_map(|(factor, levels)| {
        let levels = levels.iter().enumerate();
        levels.map(move |(level, found)| [level_text(swept.grid, factor, level), level_cell(found)])
    });
    let header = ["setting", "median delay, part that differs from most"];
    let (table, name) = (TextTable::of(header, &[], rows), plain(&swept.reported.joint.name));
    let (sentences, table) = (sentences.collect::<String>(), table.markdown(plain));
    format!("## {name}\n\n{sentences}{table}\n{HOW_TO_READ}\n")
}

const HOW_TO_READ: &str = "\
*Each column of the lowest picture is a step, each row a combination of settings, by method, \
low-pass, α and β from top to bottom. A row with much orange or blue is a setting that differs; \
such a column is a delay that is sensitive to a setting. Right and left arrow go from setting to setting; \
on the timeline `segment` from step to step.*";

/// What is said of one thing, a row each, below its name.
fn table<const N: usize>(header: [&str; N], rows: impl IntoIterator<Item = [String; N]>) -> String {
    TextTable::of(header, &[], rows).markdown(str::to_owned)
}

/// A run in numbers.
fn setting(swept: &Swept<'_>, run: usize) -> String {
    let name = swept.names.get(run).map_or("", String::as_str);
    let votes = swept.votes.get(run).copied().unwrap_or(0);
    let mut rows = vec![["combinations that it represents".to_owned(), votes.to_string()]];
    let mut row = |name: &str, value: String| rows.push([name.to_owned(), value]);
    match swept.reported.sweep.runs.get(run).and_then(Option::as_ref) {
        None => row("", "**it cannot be used on this record**".to_owned()),
        Some(found) => {
            let seconds = |s: f64| format!("{} s", number(s));
            row("steps accepted", format!("{} of {}", found.accepted, swept.steps.len()));
            row("median delay", found.median_s.map_or("-".to_owned(), seconds));
            row("delays that differ from most", found.disagreements.to_string());
            if let Some(lag_s) = found.lag_s {
                row("lag, apart from the delays", seconds(lag_s));
            }
        }
    }
    let differs: Vec<String> =
        swept.steps.iter().filter_map(|(step, _)| differing(step, run)).collect();
    let differs = match differs.as_slice() {
        [] => String::new(),
        differs => format!("\nIt differs on step {}.\n", listed(differs)),
    };
    let place = format!("setting {} of {}", run + 1, swept.names.len());
    format!("## {name}\n\n{}{differs}", table([&place, ""], rows))
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
fn one_step(swept: &Swept<'_>, step: &SweptStep) -> String {
    let seconds = |samples: f64| format!("{:.3} s", samples * step.period_s);
    let on = depends_on(swept.grid, step);
    let on = if on.is_empty() { "no setting".to_owned() } else { plain(&on) };
    let accepted = format!("{} of {}", step.accepted, step.tried);
    let mut rows = vec![("settings that accept it", accepted)];
    if let (Some(agreed), Some(all)) = (step.agreement, step.spread) {
        let most = format!("**{}**, {} of them", seconds(agreed.delay), agreed.combinations);
        let range = format!("{} to {}", seconds(all.min), seconds(all.max));
        rows.extend([("most say", most), ("range of all", range)]);
    }
    rows.push(("sensitive to", on));
    let rows = rows.into_iter().map(|(name, value)| [name.to_owned(), value]);
    let numbers = table([&format!("p = {}", step.sample), ""], rows);
    let hanging = step.delay_depends_on.as_ref().map_or_else(String::new, |hanging| {
        let rows = hanging.levels.iter().enumerate().map(|(level, found)| {
            let dash = || "-".to_owned();
            let name = plain(&level_text(swept.grid, hanging.factor, level));
            let delay = found.map_or_else(dash, |(delay, _)| seconds(delay));
            [name, delay, found.map_or_else(dash, |(_, agree)| percent(agree))]
        });
        let header = [&*hanging.factor.to_string(), "median delay", "agree with most"];
        format!("\n{}", table(header, rows))
    });
    let (number, trial) = (step.number, plain(&step.trial));
    let title = format!("## Step {number} of trial {trial}, at {:.2} s", step.time_s);
    format!("{title}\n\n{numbers}{hanging}")
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
