//! A page on which a person goes through the decisions, by keys or with the mouse, and saves a
//! review: one HTML file that needs no network.

mod data;

use data::page_json;

use super::{EstimatedJoint, Report};
use crate::experiment::Source;
use crate::wording::legible;

/// Decisions that a page holds at most: some 5 kB each.
const MOST: usize = 4000;

/// The page on the decisions of `report`, the most doubtful ones first.
///
/// # Errors
/// Never: what is on the page is numbers and texts.
pub(crate) fn review_page(report: &Report<'_>) -> serde_json::Result<String> {
    let name = name_of(&report.experiment.sources);
    page(&name, report.joints)
}

fn page(name: &str, joints: &[EstimatedJoint<'_>]) -> serde_json::Result<String> {
    let data = serde_json::to_string(&page_json(name, joints, MOST))?;
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
    Ok(legible(&page))
}

/// The log, without its folder.
fn name_of(sources: &[Source]) -> String {
    let stems = sources.iter().filter_map(|source| source.path.file_stem());
    stems.map(|stem| stem.to_string_lossy()).collect::<Vec<_>>().join(", ")
}

fn html(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('{', "&#123;")
}
