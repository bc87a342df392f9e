//! What was found, what is doubtful, what to do next, in strips above the pages of a joint: one on its
//! delays above the decisions, one on its model above the revisions.

use super::chunk::Chunks;
use super::error::RecordError;
use super::layout::JointLayout;
use super::markdown::{plain, prose};
use super::paths;
use crate::experiment::Source;
use crate::explain::Verdict;
use crate::report::ImprovedJoint;
use crate::report::answer::{delay_answer, doubtful_count};
use crate::report::conclusion::Topic;
use crate::wording::capitalized;

/// Adds `/headline`, and of a model `/revision/headline`.
pub(super) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    sources: &[Source],
    improved: Option<&ImprovedJoint<'_>>,
) -> Result<(), RecordError> {
    chunks.page(paths::HEADLINE, on_delays(layout, sources, improved))?;
    improved.map_or(Ok(()), |improved| {
        chunks.page(paths::REVISION_HEADLINE, on_model(layout, improved))
    })
}

/// What the delays are, what speaks against them, and how to correct them; where none is doubtful, what
/// follows.
fn on_delays(
    layout: &JointLayout<'_>,
    sources: &[Source],
    improved: Option<&ImprovedJoint<'_>>,
) -> String {
    let estimated = layout.estimated;
    let name = plain(&estimated.joint.name);
    let answer = format!("**{name}: {}**", prose(&delay_answer(estimated)));
    // What to do about a warning is in the report and on the terminal.
    let warnings = estimated.warnings().into_iter();
    let mut sentences: Vec<String> =
        warnings.map(|warning| format!("⚠ {}.", prose(&capitalized(&warning.short)))).collect();
    let log = match sources {
        [source] => source.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        _ => "LOG".to_owned(),
    };
    let quoted = |word: &str| shlex::try_quote(word).map_or_else(|_| word.to_owned(), Into::into);
    let data = format!("{} --joint {}", quoted(&log), quoted(&estimated.joint.name));
    let next = match doubtful_count(estimated) {
        _ if estimated.obstacle().is_some() => {
            format!("What the columns are taken for: `tauscope columns {}`", quoted(&log))
        }
        Some(doubtful) => {
            format!(
                "{doubtful} To correct them: `tauscope estimate {data} --review-sheet review.csv`"
            )
        }
        None if improved.is_some() => "No decision is doubtful.".to_owned(),
        None => {
            format!("No decision is doubtful. What a model lacks: `tauscope improve {data}`")
        }
    };
    sentences.push(next);
    format!("{answer}  \n{}", sentences.join(" "))
}

/// What the model explains and what remains, then the delays in short, and what to do next.
fn on_model(layout: &JointLayout<'_>, improved: &ImprovedJoint<'_>) -> String {
    let conclusion = improved.conclusion();
    let mut sentences = vec![prose(&delay_answer(layout.estimated))];
    sentences.extend(
        doubtful_count(layout.estimated).map(|doubtful| format!("{doubtful} See *Decisions*.")),
    );
    let next = conclusion.passages.iter().find(|passage| passage.topic == Topic::NEXT);
    sentences.extend(match (conclusion.commands.first(), next, improved.finding.verdict) {
        (Some(add), ..) => Some(format!("To add it: `{add}`")),
        (None, Some(next), _) => Some(prose(&next.text())),
        (None, None, Verdict::Adequate) => {
            Some("To check it on another log: `tauscope compare LOG --model MODEL.toml`".to_owned())
        }
        (None, None, _) => Some(
            "The second tab above the drawing shows where the remaining error arises.".to_owned(),
        ),
    });
    format!("**{}.**  \n{}", prose(&conclusion.headline), sentences.join(" "))
}
