//! What was found of a joint, what is doubtful, what to do next: a strip above its decisions.

use rerun::{EntityPath, TextDocument};

use super::chunk::Chunks;
use super::error::RecordError;
use super::layout::JointLayout;
use super::markdown::plain;
use super::paths::{self, at};
use crate::experiment::Source;
use crate::report::{EstimatedJoint, delay_answer};
use crate::wording::{capitalized, counted};

/// Adds `/headline`.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    estimated: EstimatedJoint<'_>,
    (layout, sources): (&JointLayout<'_>, &[Source]),
) -> Result<(), RecordError> {
    let text = text(estimated, layout, sources);
    chunks.push_static(at(root, paths::HEADLINE), &TextDocument::from_markdown(text))
}

fn text(estimated: EstimatedJoint<'_>, layout: &JointLayout<'_>, sources: &[Source]) -> String {
    let name = plain(&estimated.joint.name);
    let mut sentences = vec![format!("**{name}: {}**", plain(&delay_answer(estimated)))];
    let warnings = estimated.warnings();
    sentences.extend(
        warnings.iter().map(|warning| format!("⚠ {}.", plain(&capitalized(&warning.text)))),
    );
    let doubtful = layout.segments().filter(|(_, segment)| segment.is_open()).count();
    let log = match sources {
        [source] => source.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        _ => "LOG".to_owned(),
    };
    let quoted = |word: &str| shlex::try_quote(word).map_or_else(|_| word.to_owned(), Into::into);
    let data = format!("{} --joint {}", quoted(&log), quoted(&estimated.joint.name));
    let are = if doubtful == 1 { "is" } else { "are" };
    sentences.push(match doubtful {
        0 if warnings.is_empty() => format!(
            "No decision is doubtful. `tauscope improve {data}` seeks what a model of the joint lacks."
        ),
        0 => "No decision is doubtful by itself.".to_owned(),
        count => format!(
            "{} {are} doubtful: the list on the right leads there. `tauscope estimate {data} \
             --review-sheet review.csv` makes a sheet to correct decisions.",
            counted(count, "decision")
        ),
    });
    sentences.join("  \n")
}
