//! A revision in words.

use std::fmt::Write as _;

use super::figure::noise;
use crate::figure::ladder::judged;
use crate::recording::error_share::short;
use crate::recording::markdown::{plain, prose};
use crate::recording::parameter_table::parameter_table;
use crate::report::{ImprovedJoint, Topic, change_in_words};
use crate::wording::{rounded, unit_suffix};

/// The page of the revision at `place`.
pub(super) fn page(improved: &ImprovedJoint<'_>, place: usize) -> String {
    written(improved, place).unwrap_or_default()
}

fn written(improved: &ImprovedJoint<'_>, place: usize) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    let Some((revision, step)) = improved.numbered().nth(place) else { return Ok(page) };
    let last = improved.numbered().last().map_or(revision, |(number, _)| number);
    // What an earlier revision lacks is in the next one: the answer is that of the last.
    let is_last = place + 1 == improved.revisions.len();
    let conclusion = improved.conclusion_at(place);
    writeln!(page, "**{}**\n", prose(&improved.finding.conclusion().headline))?;
    writeln!(page, "## Revision {revision} of {last}: {}\n", plain(&change_in_words(step)))?;
    // Where nothing is missing that is said in the conclusion.
    if conclusion.passages.iter().all(|passage| passage.topic != Topic::Error) {
        writeln!(page, "**{}**\n", plain(&fall(improved, place)))?;
    }
    if is_last {
        what_was_found(&mut page, improved)?;
    } else {
        writeln!(page, "**At revision {revision}:** {}\n", plain(&conclusion.headline))?;
    }
    for passage in &conclusion.passages {
        writeln!(page, "**{}:** {}\n", passage.topic.label(), prose(&passage.text))?;
    }
    for command in conclusion.commands.iter().filter(|_| is_last) {
        writeln!(page, "    {command}\n")?;
    }
    parameter_table(&mut page, improved.finding.compared.joint, &step.comparison.fit)?;
    writeln!(page, "\n{HOW}")?;
    Ok(page)
}

/// What each effect that was found is.
fn what_was_found(page: &mut String, improved: &ImprovedJoint<'_>) -> std::fmt::Result {
    // Not as a table, the widest row of which would push the text out of its panel.
    let components = improved.finding.compared.comparison.fit.model.components();
    for spec in components.iter().map(|component| component.effect().spec()) {
        writeln!(page, "- **{}:** {}", plain(spec.id), plain(spec.summary))?;
    }
    writeln!(page)
}

const HOW: &str = "\
*Right and left arrow go from revision to revision: timeline `revision`. The pages behind this \
one follow `decision`, `sample` or `time`: choose it at the bottom.*";

/// What the error is, and what it was before.
fn fall(improved: &ImprovedJoint<'_>, place: usize) -> String {
    let unit = unit_suffix(improved.finding.compared.joint.output_unit.as_deref());
    let error = |place: usize| Some(judged(&improved.revisions.get(place)?.comparison));
    let Some(now) = error(place) else { return String::new() };
    let floor = noise(improved).filter(|noise| *noise > 0.0);
    let times =
        floor.map_or_else(String::new, |n| format!(", {} times the noise", rounded(now / n)));
    match place.checked_sub(1).and_then(error) {
        Some(before) => {
            format!("Error: {} → {}{unit}{times}", short(before), short(now))
        }
        None => format!("Error: {}{unit}{times}", short(now)),
    }
}
