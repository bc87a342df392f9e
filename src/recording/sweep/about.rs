//! What was tried, and what it was made from: one page.

use std::fmt::Write as _;

use rerun::{EntityPath, TextDocument};

use super::recorded::SweepRecording;
use crate::delay::sweep::Factor;
use crate::recording::chunk::Chunks;
use crate::recording::error::RecordError;
use crate::recording::markdown::plain;
use crate::recording::origin::made_from;
use crate::recording::paths::ABOUT;
use crate::report::{level_text, settings_rows, sweep_sentences};
use crate::wording::number;

/// Adds the page at `/about`.
pub(super) fn add(chunks: &mut Chunks, sweep: &SweepRecording<'_>) -> Result<(), RecordError> {
    let document = TextDocument::from_markdown(page(sweep).unwrap_or_default());
    chunks.push_static(EntityPath::from(ABOUT), &document)
}

fn page(sweep: &SweepRecording<'_>) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    writeln!(page, "# Delays of {} joints with every setting\n", sweep.joints.len())?;
    for joint in sweep.joints {
        let sentences = sweep_sentences(sweep.grid, joint).join(" ");
        writeln!(page, "- **{}**: {}", plain(&joint.joint.name), plain(&sentences))?;
    }
    writeln!(page, "\n## What was tried\n\n| setting | values |\n|---|---|")?;
    for factor in Factor::ALL {
        let level = |level| level_text(sweep.grid, factor, level);
        let levels: Vec<_> = (0..sweep.grid.levels(factor)).map(level).collect();
        writeln!(page, "| {factor} | {} |", plain(&levels.join(", ")))?;
    }
    let (combinations, runs) = (sweep.grid.combinations().len(), sweep.grid.runs().len());
    writeln!(
        page,
        "\n{combinations} combinations, of which {runs} differ. Delays agree when they differ \
         by {} samples at most, beside what the distance of candidates (β) or their own \
         intervals allow.\n",
        number(sweep.tolerance)
    )?;
    for base in sweep.grid.bases() {
        writeln!(page, "### {}, where nothing else was tried\n", base.settings.method)?;
        writeln!(page, "| setting | value |\n|---|---|")?;
        for (name, value) in settings_rows(&base.settings) {
            writeln!(page, "| {name} | {value} |")?;
        }
    }
    made_from(&mut page, sweep.sources, sweep.reading)?;
    Ok(page)
}
