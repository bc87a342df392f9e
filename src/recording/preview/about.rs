//! What is to be played on which joint, and from what it was made: one page.

use std::fmt::Write as _;

use rerun::{EntityPath, TextDocument};

use super::recorded::PreviewRecording;
use crate::recording::chunk::Chunks;
use crate::recording::error::RecordError;
use crate::recording::markdown::plain;
use crate::recording::origin::made_from;
use crate::recording::paths::ABOUT;
use crate::report::design_sentences;

/// Adds the page at `/about`.
pub(super) fn add(chunks: &mut Chunks, preview: &PreviewRecording<'_>) -> Result<(), RecordError> {
    let document = TextDocument::from_markdown(page(preview).unwrap_or_default());
    chunks.push_static(EntityPath::from(ABOUT), &document)
}

fn page(preview: &PreviewRecording<'_>) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    writeln!(page, "# The next experiment, before it is played\n")?;
    for joint in preview.joints {
        let first = design_sentences(joint).into_iter().next().unwrap_or_default();
        writeln!(page, "- {}", plain(&first))?;
    }
    if let Some(model) = preview.model {
        writeln!(page, "\nWith the model file `{}`.", model.display())?;
    }
    made_from(&mut page, preview.sources, preview.reading)?;
    writeln!(page, "{HOW_TO_READ}")?;
    Ok(page)
}

const HOW_TO_READ: &str = "\
## How to read it

- The shaded band is the margin of what is expected: two standard deviations of what the numbers \
of the model may be off. Red lines are the range that the joint may have.
- The lowest plot is the difference of both expected outputs in standard deviations of the \
noise. As in a fit, it starts anew at each step of the input. The percentages are the parts of \
all squared differences that lie in a hold.
- A click on the time in a line of the list of holds goes there; on the timeline `segment` the \
arrow keys go from hold to hold.";
