//! A revision in words.

use super::ladder::{judged, noise};
use crate::fit::Termination;
use crate::recording::layout::JointLayout;
use crate::recording::markdown::{plain, prose};
use crate::report::ladder::change_in_words;
use crate::report::parameters::parameter_table;
use crate::report::{Finding, ImprovedJoint};
use crate::wording::{rounded, times_noise, unit_suffix};

/// The page of the revision at `place`: what is concluded of the last; then what changed at this one,
/// how large its error is and where it arises.
pub(super) fn page(layout: &JointLayout<'_>, improved: &ImprovedJoint<'_>, place: usize) -> String {
    let Some((revision, step)) = improved.numbered().nth(place) else { return String::new() };
    let last = improved.finding.compared.revision;
    let conclusion = improved.conclusion();
    let line = |question: &str, answer: &str| format!("**{question}:** {}\n", prose(answer));
    let mut lines = vec![
        format!("**{}**\n", prose(&conclusion.headline)),
        format!("## Revision {revision} of {last}: {}\n", plain(&change_in_words(step))),
        format!("**{}**\n", plain(&fall(improved, place))),
    ];
    if let Some(next) = improved.revisions.get(place + 1) {
        let compared = improved.compared().nth(place).unwrap_or(improved.finding.compared);
        let fails = Finding { compared, ..improved.finding }.fails();
        lines.extend(fails.iter().map(|one| line(one.topic.0, &one.text())));
        lines.push(line("Next", &change_in_words(next)));
    } else {
        lines.extend(conclusion.passages.iter().map(|one| line(one.topic.0, &one.text())));
        lines.extend(conclusion.commands.iter().map(|command| format!("    {command}\n")));
    }
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

/// What the error is, and what it was before.
fn fall(improved: &ImprovedJoint<'_>, place: usize) -> String {
    let unit = unit_suffix(improved.finding.compared.joint.output_unit.as_deref());
    let error = |place: usize| Some(judged(&improved.revisions.get(place)?.comparison));
    let Some(now) = error(place) else { return String::new() };
    let times = noise(improved).map(|noise| format!(", {}", times_noise(now / noise)));
    let times = times.unwrap_or_default();
    match place.checked_sub(1).and_then(error) {
        Some(before) => {
            format!("Error: {} → {}{unit}{times}", rounded(before), rounded(now))
        }
        None => format!("Error: {}{unit}{times}", rounded(now)),
    }
}
