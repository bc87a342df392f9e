//! What was found of a joint and its model, what is doubtful, what to do next: a strip above its
//! decisions and above the revisions of its model.

use super::chunk::Chunks;
use super::error::RecordError;
use super::layout::JointLayout;
use super::markdown::plain;
use super::paths;
use crate::experiment::Source;
use crate::explain::Verdict;
use crate::report::ImprovedJoint;
use crate::report::answer::delay_answer;
use crate::wording::capitalized;

/// Adds `/headline`.
pub(super) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    sources: &[Source],
    improved: Option<&ImprovedJoint<'_>>,
) -> Result<(), RecordError> {
    chunks.page(paths::HEADLINE, text(layout, sources, improved))
}

fn text(
    layout: &JointLayout<'_>,
    sources: &[Source],
    improved: Option<&ImprovedJoint<'_>>,
) -> String {
    let estimated = layout.estimated;
    let name = plain(&estimated.joint.name);
    let answer = format!("**{name}: {}**", plain(&delay_answer(estimated)));
    // What to do about a warning is in the report and on the terminal.
    let warnings = estimated.warnings().into_iter();
    let mut sentences: Vec<String> =
        warnings.map(|warning| format!("⚠ {}.", plain(&capitalized(&warning.short)))).collect();
    sentences.extend(
        improved.map(|improved| format!("**Model: {}.**", plain(&improved.finding.headline()))),
    );
    let doubtful = layout.segments().filter(|(_, segment)| segment.is_open()).count();
    let log = match sources {
        [source] => source.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        _ => "LOG".to_owned(),
    };
    let quoted = |word: &str| shlex::try_quote(word).map_or_else(|_| word.to_owned(), Into::into);
    let data = format!("{} --joint {}", quoted(&log), quoted(&estimated.joint.name));
    sentences.push(match doubtful {
        _ if estimated.obstacle().is_some() => {
            format!("What the columns are taken for: `tauscope columns {}`", quoted(&log))
        }
        0 => format!("No decision is doubtful. {}", next(&data, improved)),
        1 => format!("1 decision is doubtful. {}", review(&data)),
        count => format!("{count} decisions are doubtful. {}", review(&data)),
    });
    format!("{answer}  \n{}", sentences.join(" "))
}

/// What follows where no decision is doubtful.
fn next(data: &str, improved: Option<&ImprovedJoint<'_>>) -> String {
    let Some(improved) = improved else {
        return format!("What a model lacks: `tauscope improve {data}`");
    };
    let add = improved.finding.conclusion().commands.into_iter().next();
    match (add, improved.finding.verdict) {
        (Some(add), _) => format!("To add it: `{add}`"),
        (None, Verdict::Adequate) => {
            "To check it on another log: `tauscope compare LOG --model MODEL.toml`".to_owned()
        }
        (None, _) => "The tab beside the ladder shows where the remaining error arises.".to_owned(),
    }
}

/// How decisions are corrected.
fn review(data: &str) -> String {
    format!("To correct them: `tauscope estimate {data} --review-sheet review.csv`")
}
