//! A revision in words.

use super::ladder::{judged, noise};
use crate::explain::{Change, Revision};
use crate::fit::Termination;
use crate::recording::layout::JointLayout;
use crate::recording::markdown::{plain, prose};
use crate::report::ImprovedJoint;
use crate::report::conclusion::Topic;
use crate::report::finding::{MANY_TIMES_NOISE, times_noise};
use crate::report::ladder::change_in_words;
use crate::report::parameters::parameter_table;
use crate::wording::{rounded, unit_suffix};

/// The page of the revision at `place`: the answers of the last, then what is concluded of this one.
pub(super) fn page(layout: &JointLayout<'_>, improved: &ImprovedJoint<'_>, place: usize) -> String {
    let Some((revision, step)) = improved.numbered().nth(place) else { return String::new() };
    let last = improved.numbered().last().map_or(revision, |(number, _)| number);
    let conclusion = improved.conclusion_at(place);
    let line = |question: &str, answer: &str| format!("**{question}:** {}\n", prose(answer));
    let answers = improved.finding.answers();
    let mut lines: Vec<String> =
        answers.iter().map(|(question, answer)| line(question, answer)).collect();
    lines.extend(without_gain(improved).map(|sentence| line("Revisions without gain", &sentence)));
    lines.push(format!("## Revision {revision} of {last}: {}\n", plain(&change_in_words(step))));
    // Where nothing is missing that is said in the conclusion.
    if conclusion.passages.iter().all(|passage| passage.topic != Topic::ERROR) {
        lines.push(format!("**{}**\n", plain(&fall(improved, place))));
    }
    // What is found at the last one is said above.
    if place + 1 < improved.revisions.len() {
        lines.push(line(&format!("At revision {revision}"), &conclusion.headline));
    }
    lines.extend(conclusion.passages.iter().map(|one| line(one.topic.0, &one.text())));
    // What an earlier revision lacks is in the next one: what to do is that of the last.
    let commands = conclusion.commands.iter().filter(|_| place + 1 == improved.revisions.len());
    lines.extend(commands.map(|command| format!("    {command}\n")));
    let several = if improved.revisions.len() > 1 { SEVERAL } else { "" };
    let decision = if layout.segments().next().is_some() { "`decision`, " } else { "" };
    lines.push(format!("*{several}The pages after this one follow {decision}{HOW}*"));
    lines.join("\n") + "\n"
}

/// The parameters of the revision at `place`: on a page of their own, since below the words they
/// are off a small window.
pub(super) fn parameters(
    _layout: &JointLayout<'_>,
    improved: &ImprovedJoint<'_>,
    place: usize,
) -> String {
    let Some((revision, step)) = improved.numbered().nth(place) else { return String::new() };
    let joint = improved.finding.compared.joint;
    let fit = match step.comparison.termination {
        Termination::Converged | Termination::NothingToFit => String::new(),
        stopped => format!("; its fit {stopped}"),
    };
    format!(
        "**Revision {revision}**{fit}\n\n{}",
        parameter_table(joint, &step.comparison.fit).markdown(plain)
    )
}

const SEVERAL: &str = "This opens on the last revision; the right arrow begins with the first one, on \
the timeline `revision`. ";

const HOW: &str = "`sample` or `time`: choose it at the bottom.";

/// Which revisions did not lower the validation error.
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
        [one] => Some(format!("revision {one} does not lower the validation error")),
        several => {
            Some(format!("revisions {} do not lower the validation error", several.join(", ")))
        }
    };
    let fits_alike = |before: &Revision, after: &Revision| {
        gained(before, after).is_none_or(|gained| gained.abs() <= GAIN)
    };
    let exchanges = pairs().filter_map(|((_, before), (number, after))| match after.change {
        Change::Replaced { old, new } if fits_alike(before, after) => {
            Some(format!("revision {number} exchanges {old} for {new}, which fits about as well"))
        }
        _ => None,
    });
    let all: Vec<String> = not_fallen.into_iter().chain(exchanges).collect();
    match all.as_slice() {
        [] if has_fallen_each_time(&revisions) => {
            Some("none; each revision lowered the validation error".to_owned())
        }
        [] => None,
        all => Some(all.join("; ")),
    }
}

/// Whether there are several revisions, each with a smaller validation error than the one before.
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
    let times = times.map_or_else(String::new, |times| format!(", {}", times_noise(times)));
    match place.checked_sub(1).and_then(error) {
        Some(before) => {
            format!("Error: {} → {}{unit}{times}", rounded(before), rounded(now))
        }
        None => format!("Error: {}{unit}{times}", rounded(now)),
    }
}
