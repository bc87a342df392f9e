//! What the recording was made from and with: one page.

use std::fmt::Write as _;

use super::layout::JointLayout;
use super::markdown::{plain, prose};
use super::revision::judged;
use crate::delay::Doubt;
use crate::experiment::{ReadOptions, Source};
use crate::report::answer::dead_time_sentences;
use crate::report::decisions::doubtful_lines;
use crate::report::delays::levels_text;
use crate::report::estimate::summary_table;
use crate::report::facts::Place;
use crate::report::ladder::change_in_words;
use crate::report::review::ReviewCount;
use crate::report::settings::settings_table;
use crate::report::{Detail, EstimatedJoint, JointSummary, Recording, TextTable};
use crate::wording::{counted, measure, number};

/// The page on `recording`, whose joints have these layouts.
pub(super) fn page(recording: &Recording<'_>, layouts: &[JointLayout<'_>]) -> String {
    written(recording, layouts).unwrap_or_default()
}

fn written(
    recording: &Recording<'_>,
    layouts: &[JointLayout<'_>],
) -> Result<String, std::fmt::Error> {
    let mut page = String::new();
    answers(&mut page, recording)?;
    writeln!(page, "# Delays of {}\n", counted(recording.joints.len(), "joint"))?;
    let doubts = || layouts.iter().flat_map(JointLayout::segments).map(|(_, s)| &s.doubt);
    if doubts().next().is_some() {
        writeln!(page, "{}. {DOUBT_MEANS}\n", doubtful_sentence(doubts()))?;
        doubtful(&mut page, recording.joints)?;
    }
    writeln!(page, "{}", summary_table(recording.joints).markdown(plain))?;
    let summary = |joint: &EstimatedJoint<'_>| JointSummary::of(*joint);
    let summaries: Vec<JointSummary> = recording.joints.iter().map(summary).collect();
    for (joint, summary) in recording.joints.iter().zip(&summaries) {
        let name = plain(&joint.joint.name);
        let sentences = joint.kind_sentences(summary.headline.kinds()).into_iter();
        let sentences = sentences.chain(summary.reviewed.map(ReviewCount::sentence));
        for sentence in sentences.chain(dead_time_sentences(joint)) {
            writeln!(page, "- {name}: {sentence}")?;
        }
    }
    delay_levels(&mut page, recording.joints)?;
    let settings = settings_table(recording.settings).markdown(plain);
    writeln!(page, "\n## Settings\n\n{settings}")?;
    writeln!(page, "\n{}", detail(recording, layouts))?;
    let row = |EstimatedJoint { joint, .. }: &EstimatedJoint<'_>| {
        let unit = |unit: &Option<String>| unit.clone().unwrap_or_else(|| "no unit".to_owned());
        let mut periods: Vec<_> =
            joint.trials.iter().map(|trial| trial.period().to_string()).collect();
        periods.dedup();
        let (input, output) = (unit(&joint.input_unit), unit(&joint.output_unit));
        [joint.name.clone(), input, output, joint.trials.len().to_string(), periods.join(", ")]
    };
    let header = ["joint", "input", "output", "trials", "sample period"];
    let signals = TextTable::of(header, &[3], recording.joints.iter().map(row)).markdown(plain);
    writeln!(page, "\n## Signals\n\n{signals}")?;
    made_from(&mut page, recording.sources, recording.reading)?;
    writeln!(page, "{HOW_TO_READ}")?;
    Ok(page)
}

/// How many decisions are doubtful, and when one is: `6 of 587 decisions are doubtful (…)`.
fn doubtful_sentence<'d>(all: impl Iterator<Item = &'d Doubt>) -> String {
    let (doubtful, all) = all.fold((0_usize, 0_usize), |(doubtful, all), doubt| {
        (doubtful + usize::from(doubt.is_doubtful()), all + 1)
    });
    let (decisions, are) = (counted(all, "decision"), if doubtful == 1 { "is" } else { "are" });
    let from = number(Doubt::DOUBTFUL_PERCENT);
    format!("{doubtful} of {decisions} {are} doubtful (doubt of {from} % or more)")
}

/// What the number says.
const DOUBT_MEANS: &str = "\
Doubt is 0 % where nothing speaks against a decision and 100 % where the smallest change of the \
data would reverse it; it is not a probability.";

/// What was found of models and dead times, first of all: a headline per joint, and how the error
/// fell.
fn answers(page: &mut String, recording: &Recording<'_>) -> std::fmt::Result {
    for joint in recording.joints {
        if let [_, finding, ..] = dead_time_sentences(joint).as_slice() {
            writeln!(page, "# {}: {}\n", plain(&joint.joint.name), plain(finding))?;
        }
    }
    for improved in recording.revisions.iter().filter(|improved| !improved.revisions.is_empty()) {
        let unit = improved.finding.compared.joint.output_unit.as_deref();
        writeln!(page, "# {}\n", prose(&improved.finding.conclusion().headline))?;
        writeln!(page, "| revision | change | error |\n|---|---|---|")?;
        for (number, revision) in improved.numbered() {
            let error = measure(judged(&revision.comparison), unit);
            let change = plain(&change_in_words(revision));
            writeln!(page, "| {number} | {change} | {error} |")?;
        }
        writeln!(page)?;
    }
    Ok(())
}

/// The most doubtful decisions of all joints.
fn doubtful(page: &mut String, joints: &[EstimatedJoint<'_>]) -> std::fmt::Result {
    /// Decisions that are named.
    const MOST: usize = 10;
    for line in doubtful_lines(joints).iter().take(MOST) {
        writeln!(page, "1. {}", plain(line))?;
    }
    writeln!(page)
}

/// The delays by kind of step and levels.
fn delay_levels(page: &mut String, joints: &[EstimatedJoint<'_>]) -> std::fmt::Result {
    /// Rows that a person reads, at most.
    const MOST: usize = 200;
    let tables = joints.iter().map(|joint| (joint.joint.name.as_str(), joint.delay_table().rows));
    let tables: Vec<_> = tables.collect();
    let rows = || tables.iter().flat_map(|(name, rows)| rows.iter().map(move |row| (*name, row)));
    let all = rows().count();
    if all == 0 {
        return Ok(());
    }
    let table = levels_text(Place::Recording, rows().take(MOST)).markdown(plain);
    writeln!(page, "\n## Delay table\n\n{table}")?;
    if all > MOST {
        writeln!(page, "{MOST} of {all} rows; `--table FILE.csv` writes them all.")?;
    }
    Ok(())
}

const HOW_TO_READ: &str = "\
## How to read it

- **Right and left arrow** step through every candidate of every segment (timeline \
`decision`). Orange is the candidate under the cursor; green is the chosen pair of an \
accepted segment, red that of a rejected one.
- **A click on the number in a row** of the list of decisions jumps to that verdict.
- The timeline `segment` goes from step to step; `sample` and `time` run through the record.
- Sample numbers count from 1 within the trial, as in the paper: p is the input step, r the \
first sample of the segment, q the breakpoint, δ = q − p the delay.
- The timeline `doubt` goes through the decisions, the doubtful ones first.
- **fit** is the part of the motion that a model follows: 100 % less its error over the standard \
deviation of what was measured, about its mean between two restarts of the simulation.";

/// How many candidates of how many are in the recording.
fn detail(recording: &Recording<'_>, layouts: &[JointLayout<'_>]) -> String {
    let segments = || layouts.iter().flat_map(JointLayout::segments);
    let all: usize = segments().map(|(_, s)| s.decision.candidates.len()).sum();
    let kept: usize = segments().map(|(_, s)| s.kept.len()).sum();
    match recording.detail {
        Detail::Full => format!("All {all} candidates are recorded."),
        Detail::Lean => format!(
            "**{kept} of {all} candidates are recorded** (`--detail full` records all): all of \
             rejected and doubtful segments, of the others the best, its neighbours, and some more."
        ),
    }
}

/// The files, how they were read, and the program.
pub(super) fn made_from(
    page: &mut String,
    sources: &[Source],
    reading: &ReadOptions,
) -> std::fmt::Result {
    writeln!(page, "\n## Made from\n")?;
    for source in sources {
        let path = source.path.display();
        writeln!(page, "- `{path}`, {} bytes, SHA-256 `{}`", source.bytes, source.sha256)?;
    }
    writeln!(page, "\n{}", read_with(reading))?;
    writeln!(page, "\nMade by tauscope {}.\n", env!("CARGO_PKG_VERSION"))
}

/// How the files were read, where it was not as they are.
fn read_with(reading: &ReadOptions) -> String {
    let ReadOptions { columns, repair, .. } = reading;
    let mut parts = Vec::new();
    parts.extend(repair.resample.map(|period| format!("resampled to {period}")));
    parts.extend(
        repair.fill_s.map(|fill| format!("gaps up to {fill} s filled, split at longer ones")),
    );
    parts.extend(columns.sample_period_s.map(|s| format!("a sample period of {s} s given")));
    parts.extend(columns.time.iter().map(|time| format!("time from column `{time}`")));
    parts.extend(columns.trial.iter().map(|trial| format!("trials from column `{trial}`")));
    parts.extend(columns.joints.iter().map(|joint| {
        format!("{} from `{}` and `{}`", plain(&joint.name), joint.input, joint.output)
    }));
    if parts.is_empty() {
        "Read as they are.".to_owned()
    } else {
        format!("Read with: {}.", parts.join("; "))
    }
}
