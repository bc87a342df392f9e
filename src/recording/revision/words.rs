//! A revision in words.

use std::fmt::Write as _;

use super::figure::noise;
use super::record::worst_spans;
use crate::diagnosis::Comparison;
use crate::figure::ladder::judged;
use crate::fit::Termination;
use crate::model::Component;
use crate::recording::error_share::short;
use crate::recording::layout::JointLayout;
use crate::recording::markdown::{plain, prose};
use crate::recording::parameter_table::parameter_table;
use crate::report::{ImprovedJoint, MANY_TIMES_NOISE, Passage, Topic, change_in_words};
use crate::wording::{percent, rounded, unit_suffix};

/// The page of the revision at `place`.
pub(super) fn page(layout: &JointLayout<'_>, improved: &ImprovedJoint<'_>, place: usize) -> String {
    written(layout, improved, place).unwrap_or_default()
}

fn written(
    layout: &JointLayout<'_>,
    improved: &ImprovedJoint<'_>,
    place: usize,
) -> Result<String, std::fmt::Error> {
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
        if passage.topic == Topic::WhereItFails {
            where_it_fails(&mut page, passage, &in_the_plots(layout, &step.comparison))?;
        } else {
            writeln!(page, "**{}:** {}\n", passage.topic.label(), prose(&passage.text()))?;
        }
    }
    for command in conclusion.commands.iter().filter(|_| is_last) {
        writeln!(page, "    {command}\n")?;
    }
    let several = if improved.revisions.len() > 1 { SEVERAL } else { "" };
    writeln!(page, "*{several}{HOW}*")?;
    Ok(page)
}

/// The parameters of the revision at `place`: on a page of their own, since below the words they
/// are off a small window.
pub(super) fn parameters(
    _layout: &JointLayout<'_>,
    improved: &ImprovedJoint<'_>,
    place: usize,
) -> String {
    let mut page = String::new();
    let Some((revision, step)) = improved.numbered().nth(place) else { return page };
    let joint = improved.finding.compared.joint;
    let fit = match step.comparison.termination {
        Termination::Converged | Termination::NothingToFit => String::new(),
        stopped => format!("; its fit {stopped}"),
    };
    let written = writeln!(page, "**Revision {revision}**{fit}\n")
        .and_then(|()| parameter_table(&mut page, joint, &step.comparison.fit));
    written.map(|()| page).unwrap_or_default()
}

/// A line for each condition, which stands out, and the worst segments.
fn where_it_fails(page: &mut String, passage: &Passage, in_the_plots: &str) -> std::fmt::Result {
    writeln!(page, "**{}:**\n", passage.topic.label())?;
    for sentence in &passage.sentences {
        match sentence.rsplit_once(": ") {
            Some((when, weight)) => writeln!(page, "- **{}**: {}", prose(when), prose(weight))?,
            None => writeln!(page, "- {}{in_the_plots}", prose(sentence))?,
        }
    }
    writeln!(page)
}

/// What each effect that was found is.
fn what_was_found(page: &mut String, improved: &ImprovedJoint<'_>) -> std::fmt::Result {
    // Not as a table, the widest row of which would push the text out of its panel.
    let components = improved.finding.compared.comparison.fit.model.components();
    let found = improved.finding.attribution.iter().flat_map(|all| &all.found);
    let shares: Vec<_> = found.map(|one| (one.effect, one.error_share)).collect();
    let share_of =
        |id: &str| shares.iter().find(|(effect, _)| *effect == id).map(|(_, share)| *share);
    let id = |component: &Component| component.effect().spec().id;
    // What explains most comes first, behind what the model had before.
    let share = |component: &Component| share_of(id(component)).unwrap_or(f64::INFINITY);
    let mut components: Vec<&Component> = components.iter().collect();
    components.sort_by(|a, b| share(b).total_cmp(&share(a)));
    if shares.len() > 1 {
        writeln!(page, "Share of the first error that returns without each (shares overlap):\n")?;
    }
    for component in components {
        let share = share_of(id(component));
        let share = share.map_or_else(String::new, |share| format!(" {}", percent(share)));
        let summary = component.summary();
        writeln!(page, "- **{}**{share}: {}", plain(id(component)), prose(&summary))?;
    }
    writeln!(page)
}

/// Where the worst segments of several trials lie in the plots.
fn in_the_plots(layout: &JointLayout<'_>, comparison: &Comparison) -> String {
    let spans = worst_spans(layout, comparison);
    if layout.trials.len() < 2 || spans.is_empty() {
        return String::new();
    }
    // As many as the sentence before it names.
    let spans = (1..)
        .zip(spans)
        .take(3)
        .map(|(rank, (_, [from, to]))| format!("**{rank}** at {} to {} s", short(from), short(to)));
    let spans: Vec<String> = spans.collect();
    format!(" In the plots, whose time goes through all trials: {}.", spans.join(", "))
}

const SEVERAL: &str = "This opens on the last revision; the right arrow begins with the first one, on \
the timeline `revision`. ";

const HOW: &str = "The pages behind this one follow `decision`, `sample` or `time`: choose it at the \
bottom.";

/// What the error is, and what it was before.
fn fall(improved: &ImprovedJoint<'_>, place: usize) -> String {
    let unit = unit_suffix(improved.finding.compared.joint.output_unit.as_deref());
    let error = |place: usize| Some(judged(&improved.revisions.get(place)?.comparison));
    let Some(now) = error(place) else { return String::new() };
    let floor = noise(improved).filter(|noise| *noise > 0.0);
    let times = floor.map(|noise| now / noise).filter(|times| *times < MANY_TIMES_NOISE);
    let times =
        times.map_or_else(String::new, |times| format!(", {} times the noise", rounded(times)));
    match place.checked_sub(1).and_then(error) {
        Some(before) => {
            format!("Error: {} → {}{unit}{times}", short(before), short(now))
        }
        None => format!("Error: {}{unit}{times}", short(now)),
    }
}
