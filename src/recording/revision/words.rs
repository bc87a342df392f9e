//! A revision in words.

use std::fmt::Write as _;

use super::ladder::{judged, noise};
use super::record::worst_spans;
use crate::diagnosis::Comparison;
use crate::diagnosis::failure::WorstSegment;
use crate::explain::{Change, Revision};
use crate::fit::Termination;
use crate::model::Component;
use crate::recording::canvas::short;
use crate::recording::layout::JointLayout;
use crate::recording::markdown::{plain, prose};
use crate::recording::parameter_table::parameter_table;
use crate::report::{ImprovedJoint, MANY_TIMES_NOISE, Passage, Topic, change_in_words};
use crate::wording::{measure, percent, rounded, unit_suffix, worst_segment_text};

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
    for (question, answer) in improved.finding.answers() {
        writeln!(page, "**{question}:** {}\n", prose(&answer))?;
    }
    if let Some(sentence) = without_gain(improved) {
        writeln!(page, "**No gain:** {}\n", plain(&sentence))?;
    }
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
            where_it_fails(&mut page, passage)?;
        } else if passage.topic == Topic::WorstSegments {
            let worst = worst_segments(layout, &step.comparison);
            writeln!(page, "**{}:**\n\n{worst}", passage.topic.label())?;
        } else if passage.topic == Topic::Shares && is_last {
            // Shares and alternatives stand beside the effects above.
            if let Some(refinements) = improved.finding.refinements() {
                writeln!(page, "**Refinements:** {}\n", prose(&refinements))?;
            }
        } else {
            writeln!(page, "**{}:** {}\n", passage.topic.label(), prose(&passage.text()))?;
        }
    }
    for command in conclusion.commands.iter().filter(|_| is_last) {
        writeln!(page, "    {command}\n")?;
    }
    let several = if improved.revisions.len() > 1 { SEVERAL } else { "" };
    let decision = if layout.segments().next().is_some() { "`decision`, " } else { "" };
    writeln!(page, "*{several}The pages behind this one follow {decision}{HOW}*")?;
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

/// A line for each condition, which stands out.
fn where_it_fails(page: &mut String, passage: &Passage) -> std::fmt::Result {
    writeln!(page, "**{}:**\n", passage.topic.label())?;
    for sentence in &passage.sentences {
        match sentence.rsplit_once(": ") {
            Some((when, weight)) => writeln!(page, "- **{}**: {}", prose(when), prose(weight))?,
            None => writeln!(page, "- {}", prose(sentence))?,
        }
    }
    writeln!(page)
}

/// Whether it is known what the model leaves without each of several effects.
fn are_several(improved: &ImprovedJoint<'_>) -> bool {
    improved.finding.attribution.is_some_and(|known| known.found.len() > 1)
}

/// What each effect that was found is.
fn what_was_found(page: &mut String, improved: &ImprovedJoint<'_>) -> std::fmt::Result {
    // Not as a table, the widest row of which would push the text out of its panel.
    let compared = &improved.finding.compared;
    let unit = compared.joint.output_unit.as_deref();
    let components = compared.comparison.fit.model.components();
    let id = |component: &Component| component.effect().spec().id;
    let known = improved.finding.attribution;
    let contribution =
        |component: &Component| known?.found.iter().find(|one| one.effect == id(component));
    let is_doubtful = |component: &Component| {
        known.is_some_and(|known| known.doubtful.iter().any(|one| one.effect == id(component)))
    };
    // What explains most comes first, behind what the model had before.
    let share = |component: &Component| {
        contribution(component).map_or(f64::INFINITY, |one| one.error_share)
    };
    let mut components: Vec<&Component> = components.iter().collect();
    components.sort_by(|a, b| share(b).total_cmp(&share(a)));
    // Of one alone it is said above.
    let are_several = are_several(improved);
    if are_several {
        let error = judged(compared.comparison);
        writeln!(
            page,
            "Error with one left out and the rest fitted again ({} with all):\n",
            measure(error, unit)
        )?;
    }
    for component in components {
        write!(page, "- **{}**", plain(id(component)))?;
        let one = contribution(component);
        match one {
            Some(one) if are_several => {
                write!(page, " {}", plain(&measure(one.error_without, unit)))?;
            }
            None if is_doubtful(component) => write!(page, " (doubtful)")?,
            None if are_several => write!(page, " (from the start)")?,
            _ => {}
        }
        if let Some(one) = one.filter(|one| !one.alternatives.is_empty()) {
            write!(page, " (or {})", plain(&one.alternatives.join(" or ")))?;
        }
        writeln!(page, ": {}", prose(&component.summary()))?;
    }
    writeln!(page)?;
    if let Some(id) = improved.revisions.last().and_then(of_some_trials) {
        writeln!(page, "Brackets, as in `{id}`, name the trials in which alone it acts.\n")?;
    }
    Ok(())
}

/// An effect of some trials alone that is in the model of a revision, or among what was tried there.
fn of_some_trials(revision: &Revision) -> Option<&str> {
    let of_model = revision.comparison.fit.model.components().iter();
    let of_model = of_model.map(|component| component.effect().spec().id);
    let tried = revision.ranking.iter().flat_map(|candidate| candidate.effects.iter().copied());
    of_model.chain(tried).find(|id| id.ends_with(']'))
}

/// A line for each of the worst segments: where it is, also in the plots where these go through several
/// trials, and its share of the error.
fn worst_segments(layout: &JointLayout<'_>, comparison: &Comparison) -> String {
    /// Segments that a person looks at.
    const MOST: usize = 3;
    let several = layout.trials.len() > 1;
    let line = |(rank, (worst, [from, to])): (usize, (&WorstSegment, [f64; 2]))| {
        let share = percent(worst.share_of_squared_error);
        let (place, in_plots) = if several {
            let in_plots = format!(" ({} to {} s in the plots)", short(from), short(to));
            (format!("trial {}, {}", plain(&worst.trial), worst_segment_text(worst)), in_plots)
        } else {
            (worst_segment_text(worst), String::new())
        };
        format!("- **{rank}**: {place}{in_plots}, {share} of its squared error\n")
    };
    (1..).zip(worst_spans(layout, comparison)).take(MOST).map(line).collect()
}

const SEVERAL: &str = "This opens on the last revision; the right arrow begins with the first one, on \
the timeline `revision`. ";

const HOW: &str = "`sample` or `time`: choose it at the bottom.";

/// Which revisions did not lower the error on what was not fitted.
fn without_gain(improved: &ImprovedJoint<'_>) -> Option<String> {
    let revisions: Vec<(u32, &Revision)> = improved.numbered().collect();
    let gained = |before: &Revision, after: &Revision| {
        let error = |of: &Revision| of.comparison.validation.map(|error| error.rmse);
        error(before).zip(error(after)).map(|(before, after)| 1.0 - after / before)
    };
    let is_without = |before: &Revision, after: &Revision| {
        // What left the model or was exchanged for a simpler effect is to gain nothing.
        let least = if matches!(after.change, Change::Added(_)) { GAIN } else { -GAIN };
        gained(before, after).is_some_and(|gained| gained < least)
    };
    let pairs = || revisions.iter().zip(revisions.iter().skip(1));
    let without = pairs().filter(|((_, before), (_, after))| is_without(before, after));
    let numbers: Vec<String> = without.map(|(_, (number, _))| number.to_string()).collect();
    let not_fallen = match numbers.as_slice() {
        [] => None,
        [one] => Some(format!(
            "revision {one}, after which the error on what was not fitted is no smaller"
        )),
        several => Some(format!(
            "revisions {}, after which the error on what was not fitted is no smaller",
            several.join(", ")
        )),
    };
    let fits_alike = |before: &Revision, after: &Revision| {
        gained(before, after).is_none_or(|gained| gained.abs() <= GAIN)
    };
    let exchanges = pairs().filter_map(|((_, before), (number, after))| match after.change {
        Change::Replaced { old, new } if fits_alike(before, after) => Some(format!(
            "revision {number}, which exchanges {old} for {new}, which fits about as well"
        )),
        _ => None,
    });
    let all: Vec<String> = not_fallen.into_iter().chain(exchanges).collect();
    match all.as_slice() {
        [] if has_fallen_each_time(&revisions) => {
            Some("none: each revision lowered the error on what was not fitted".to_owned())
        }
        [] => None,
        all => Some(all.join("; ")),
    }
}

/// Whether there are several revisions, each with a smaller error on what was not fitted than the one before.
fn has_fallen_each_time(revisions: &[(u32, &Revision)]) -> bool {
    let error = |(_, revision): &(u32, &Revision)| Some(revision.comparison.validation?.rmse);
    let falls = |pair: &[(u32, &Revision)]| match pair {
        [before, after] => error(before).zip(error(after)).is_some_and(|(a, b)| b < a),
        _ => false,
    };
    revisions.len() > 1 && revisions.windows(2).all(falls)
}

/// What is a gain at all, as a part of the error.
const GAIN: f64 = 1e-3;

/// What the error is, and what it was before.
fn fall(improved: &ImprovedJoint<'_>, place: usize) -> String {
    let unit = unit_suffix(improved.finding.compared.joint.output_unit.as_deref());
    let error = |place: usize| Some(judged(&improved.revisions.get(place)?.comparison));
    let Some(now) = error(place) else { return String::new() };
    let floor = noise(improved);
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
