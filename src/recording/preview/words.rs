//! What an input distinguishes and how surely, in words; the hold under the cursor; all holds.

use std::fmt::Write as _;

use super::expected::Preview;
use crate::design::Hold;
use crate::recording::chunk::Chunks;
use crate::recording::error::RecordError;
use crate::recording::markdown::plain;
use crate::recording::paths;
use crate::report::{SIDE_HEADER, design_sentences, side_rows};
use crate::wording::measure;

/// Adds all words below `root`.
pub(super) fn add(chunks: &mut Chunks, preview: &Preview<'_>) -> Result<(), RecordError> {
    chunks.page(paths::SAYS, says(preview).unwrap_or_default())?;
    let holds = preview.joint.schedule.holds().iter().zip(preview.holds()).enumerate();
    let pages = holds
        .clone()
        .map(|(place, (hold, ends))| page(preview, place, *hold, ends).unwrap_or_default());
    chunks.pages(paths::HERE, preview.hold_rows(), pages)?;
    let lines = holds.map(|(place, (hold, _))| (None, line(preview, place, *hold)));
    chunks.lines(paths::HOLDS, preview.hold_rows(), lines)
}

type Written = Result<String, std::fmt::Error>;

/// What the input is, what it distinguishes, and how surely.
fn says(preview: &Preview<'_>) -> Written {
    let mut page = String::new();
    writeln!(page, "## {}\n", plain(&preview.joint.rig.name))?;
    let mut sentences = design_sentences(preview.joint).into_iter();
    if let Some(first) = sentences.next() {
        writeln!(page, "**{}**\n", plain(&first))?;
    }
    if let Some(sides) = &preview.joint.discrimination {
        writeln!(page, "| {} |\n|---|---|---|---|---|", SIDE_HEADER.join(" | "))?;
        for row in side_rows(sides) {
            writeln!(page, "| {} |", row.map(|cell| plain(&cell)).join(" | "))?;
        }
        writeln!(page)?;
    }
    for sentence in sentences {
        writeln!(page, "{}\n", plain(&sentence))?;
    }
    Ok(page)
}

/// A hold in numbers: what is expected at its end, and how far the suspects are apart.
fn page(preview: &Preview<'_>, place: usize, hold: Hold, (start, end): (usize, usize)) -> Written {
    let mut page = String::new();
    let rig = &preview.joint.rig;
    let level = measure(hold.level, rig.input_unit.as_deref());
    let [from, to] = [start, end].map(|sample| measure(preview.seconds(sample), Some("s")));
    let all = preview.joint.schedule.holds().len();
    writeln!(page, "## {}\n", plain(&level))?;
    writeln!(page, "| hold {} of {all} | |\n|---|---|", place + 1)?;
    writeln!(page, "| from, to | {from}, {to} |")?;
    let unit = rig.output_unit.as_deref();
    for expected in &preview.expected {
        let (output, margin) = (&expected.prediction.output, &expected.prediction.margin);
        let last = end.saturating_sub(1);
        if let (Some(output), Some(margin)) = (output.get(last), margin.get(last)) {
            let (angle, margin) = (measure(*output, unit), measure(*margin, unit));
            let name = plain(expected.name);
            writeln!(page, "| at its end, {name} | {angle} ± {margin} |")?;
        }
    }
    let own = preview.apart.as_ref().and_then(|apart| apart.holds.get(place));
    if let Some(own) = own {
        writeln!(page, "| largest difference | {} of the noise |", measure(own.largest, None))?;
        writeln!(page, "| of all squared differences | {:.1} % |", 100.0 * own.share)?;
    }
    Ok(page)
}

/// A hold in a line.
fn line(preview: &Preview<'_>, place: usize, hold: Hold) -> String {
    let rig = &preview.joint.rig;
    let level = measure(hold.level, rig.input_unit.as_deref());
    let seconds = hold.samples as f64 * preview.joint.schedule.period().seconds();
    let line = format!("hold {}: {level} for {}", place + 1, measure(seconds, Some("s")));
    let own = preview.apart.as_ref().and_then(|apart| apart.holds.get(place));
    own.map_or(line.clone(), |own| {
        let (largest, share) = (measure(own.largest, None), 100.0 * own.share);
        format!("{line}; apart by up to {largest} × noise, {share:.0} % of all")
    })
}
