//! A page on which a person goes through the decisions, by keys or with the mouse, and saves a
//! review: one HTML file that needs no network.

use serde_json::{Value, json};

use super::decisions::by_doubt;
use super::json::joined;
use super::page::document::Report;
use super::recorded::names_of;
use super::review::review_json;
use super::{Doubted, EstimatedJoint};
use crate::delay::{Check, Decision, Outcome};
use crate::figure::segment::window;
use crate::numerics::as_written;
use crate::wording::legible;

/// Decisions that a page holds at most: some 5 kB each.
const MOST: usize = 4000;

/// The page on the decisions of `report`, the most doubtful ones first.
pub(crate) fn review_page(report: &Report<'_>) -> String {
    let name = names_of(&report.experiment.sources);
    page(&name, report.joints)
}

fn page(name: &str, joints: &[EstimatedJoint<'_>]) -> String {
    let data = page_json(name, joints, MOST).to_string();
    // Within a script nothing may look like its end.
    let data = data.replace('<', "\\u003c");
    let title = html(&format!("Review of {name}"));
    let parts = [
        ("{title}", title.as_str()),
        ("{style}", include_str!("page.css")),
        ("{script}", include_str!("page.js")),
        // Last, since it may hold anything.
        ("{data}", data.as_str()),
    ];
    let page = include_str!("page.html").to_owned();
    let page = parts.into_iter().fold(page, |page, (place, text)| page.replacen(place, text, 1));
    legible(&page)
}

fn html(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('{', "&#123;")
}

/// All that the page is made from: the log's name, how many decisions there are, and the `most` most
/// doubtful ones on `joints`.
pub(super) fn page_json(name: &str, joints: &[EstimatedJoint<'_>], most: usize) -> Value {
    let all = by_doubt(joints);
    let steps = all.iter().take(most).map(step);
    json!({ "name": name, "decisions": all.len(), "steps": steps.collect::<Value>() })
}

/// One decision, with what a reviewer looks at: the row of the review as it is saved; the levels of the
/// input; the segment, and the last sample that the lines are fitted to, since of rows of β samples an
/// incomplete one is left out; the signals from the sample `first` on, `smoothed` empty where the lines
/// were fitted to the measured output; breakpoint and squared error of every candidate.
fn step(doubted: &Doubted<'_>) -> Value {
    let Doubted { joint, trial, decision, doubt, .. } = doubted;
    let (from, to) = window(trial, decision);
    let part = |values: &[f64]| {
        let visible = values.get(from - 1..to).unwrap_or_default().iter();
        visible.map(|value| six_digits(*value)).collect::<Vec<_>>()
    };
    let (first, last) = (decision.segment.first, decision.segment.last);
    let errors = decision.candidates.iter().map(|c| (c.breakpoint, six_digits(c.sse)));
    let facts = json!({
        "input_unit": joint.joint.input_unit,
        "output_unit": joint.joint.output_unit,
        "period_s": trial.period().seconds(),
        "input": [decision.input_step.before, decision.input_step.after],
        "segment": [first, last],
        "fitted_to": fitted_to(decision).unwrap_or(last),
        "hold": decision.hold,
        "first": from,
        "measured": part(trial.output()),
        "smoothed": doubted.smoothed.map(part).unwrap_or_default(),
        "errors": errors.collect::<Vec<_>>(),
        "conditions": decision.checks.iter().copied().map(condition).collect::<Value>(),
        "flags": doubt.flags.iter().map(|flag| flag.meaning()).collect::<Vec<_>>(),
    });
    joined([review_json(doubted).into(), facts])
}

/// A condition; `met` is `null` where it was not checked.
fn condition(check: Check) -> Value {
    let condition = check.condition;
    let met = match check.outcome {
        Outcome::Passed => Some(true),
        Outcome::Failed => Some(false),
        Outcome::NotChecked => None,
    };
    json!({
        "id": condition.id(),
        "meaning": condition.meaning(),
        "asks": condition.asks(),
        "value": check.value,
        "limit": check.limit,
        "met": met,
    })
}

/// Last sample of the last whole row of the segment; `None` where the rows are not known.
fn fitted_to(decision: &Decision) -> Option<usize> {
    let breakpoint = |back: usize| {
        let candidates = &decision.candidates;
        candidates.get(candidates.len().checked_sub(back)?).map(|candidate| candidate.breakpoint)
    };
    let beta = breakpoint(1)?.checked_sub(breakpoint(2)?)?;
    Some((breakpoint(1)? + beta.saturating_sub(1)).min(decision.segment.last))
}

/// What is drawn needs no more.
fn six_digits(value: f64) -> f64 {
    as_written(value, 6)
}
