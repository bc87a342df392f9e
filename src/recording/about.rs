//! What the recording was made from and with: one page.

use super::layout::JointLayout;
use super::markdown::{plain, prose};
use super::revision::judged;
use crate::delay::Doubt;
use crate::experiment::{ReadOptions, Source};
use crate::report::answer::dead_time_sentences;
use crate::report::columns::extent;
use crate::report::decisions::doubtful_lines;
use crate::report::delays::levels_text;
use crate::report::estimate::summary_table;
use crate::report::facts::Place;
use crate::report::ladder::change_in_words;
use crate::report::page::compose::files;
use crate::report::review::ReviewCount;
use crate::report::settings::settings_table;
use crate::report::{Detail, EstimatedJoint, ImprovedJoint, JointSummary, Recording, TextTable};
use crate::wording::{counted, measure, number};

/// The page on `recording`, whose joints have these layouts.
pub(super) fn page(recording: &Recording<'_>, layouts: &[JointLayout<'_>]) -> String {
    let joints = recording.joints;
    let dead_times =
        joints.iter().filter_map(|joint| match dead_time_sentences(joint).as_slice() {
            [_, finding, ..] => Some(format!("# {}: {}", plain(&joint.joint.name), plain(finding))),
            _ => None,
        });
    let improved = recording.revisions.iter().filter(|improved| !improved.revisions.is_empty());
    let mut parts: Vec<String> = dead_times.chain(improved.map(ladder)).collect();
    parts.push(format!("# Delays of {}", counted(joints.len(), "joint")));
    parts.extend(doubtful(joints, layouts));
    parts.push(summary_table(joints).markdown(plain));
    parts.push(joints.iter().map(sentences).collect());
    parts.extend(delay_levels(joints));
    parts.push(format!("## Settings\n\n{}", settings_table(recording.settings).markdown(plain)));
    parts.push(detail(recording, layouts));
    let extent = extent(joints.iter().map(|joint| joint.joint)).markdown(plain);
    parts.push(format!("## Signals\n\n{extent}"));
    parts.push(made_from(recording.sources, recording.reading));
    parts.push(HOW_TO_READ.to_owned());
    parts.join("\n\n") + "\n"
}

/// How the error of a model fell.
fn ladder(improved: &ImprovedJoint<'_>) -> String {
    let unit = improved.finding.compared.joint.output_unit.as_deref();
    let rows = improved.numbered().map(|(number, revision)| {
        let error = measure(judged(&revision.comparison), unit);
        [number.to_string(), change_in_words(revision), error]
    });
    let table = TextTable::of(["revision", "change", "error"], &[], rows).markdown(plain);
    format!("# {}\n\n{table}", prose(&improved.finding.conclusion().headline))
}

/// What is said of a joint, a line each.
fn sentences(joint: &EstimatedJoint<'_>) -> String {
    let (name, summary) = (plain(&joint.joint.name), JointSummary::of(*joint));
    let sentences = joint.kind_sentences(summary.headline.kinds()).into_iter();
    let sentences = sentences.chain(summary.reviewed.map(ReviewCount::sentence));
    let sentences = sentences.chain(dead_time_sentences(joint));
    sentences.map(|sentence| ["- ", &name, ": ", &sentence, "\n"].concat()).collect()
}

/// The most doubtful decisions of all joints.
fn doubtful(joints: &[EstimatedJoint<'_>], layouts: &[JointLayout<'_>]) -> Option<String> {
    /// Decisions that are named.
    const MOST: usize = 10;
    let doubts = || layouts.iter().flat_map(JointLayout::segments).map(|(_, s)| &s.doubt);
    doubts().next()?;
    let lines = doubtful_lines(joints).into_iter().take(MOST);
    let lines: String = lines.map(|line| ["1. ", &plain(&line), "\n"].concat()).collect();
    Some(format!("{}. {DOUBT_MEANS}\n\n{lines}", doubtful_sentence(doubts())))
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

/// The delays by kind of step and levels.
fn delay_levels(joints: &[EstimatedJoint<'_>]) -> Option<String> {
    /// Rows that a person reads, at most.
    const MOST: usize = 200;
    let tables = joints.iter().map(|joint| (joint.joint.name.as_str(), joint.delay_table().rows));
    let tables: Vec<_> = tables.collect();
    let rows = || tables.iter().flat_map(|(name, rows)| rows.iter().map(move |row| (*name, row)));
    let table = levels_text(Place::Recording, rows().take(MOST)).markdown(plain);
    let more = match rows().count() {
        0 => return None,
        1..=MOST => String::new(),
        all => format!("\n{MOST} of {all} rows; `--table FILE.csv` writes them all."),
    };
    Some(format!("## Delay table\n\n{table}{more}"))
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
pub(super) fn made_from(sources: &[Source], reading: &ReadOptions) -> String {
    let (table, version) = (files(sources).markdown(plain), env!("CARGO_PKG_VERSION"));
    let read = read_with(reading);
    format!("## Made from\n\n{table}\n{read}\n\nMade by tauscope {version}.")
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
