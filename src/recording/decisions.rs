//! The numbers of every candidate and every decision.

use rerun::SeriesLines;

use super::chunk::{Chunks, Moment, fine_columns, integers, numbers, shown, texts};
use super::error::RecordError;
use super::layout::{JointLayout, Placed, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::paths;
use crate::delay::{Candidate, Decision};
use crate::experiment::Joint;
use crate::units::signed;
use crate::wording::{doubt_percent, number};

/// Adds `/decision/sse` and `/decision/table`.
pub(super) fn add(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    add_errors(chunks, layout)?;
    add_page(chunks, layout)?;
    add_table(chunks, layout)
}

/// All decisions as a person reads them: what the table has, in five digits.
fn add_page(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    /// Rows that a person still reads.
    const MOST: usize = 1000;
    let rows: Vec<_> = layout.segments().take(MOST).map(|(t, s)| page_row(t, s)).collect();
    let all = layout.segments().count();
    let more = if all > MOST { format!("\n\nThe first {MOST} of {all}.") } else { String::new() };
    let page = format!("{}\n{}{more}", page_header(layout.joint), rows.join("\n"));
    chunks.page(paths::DECISION_PAGE, page)
}

/// The head of the table, with the units of `joint`.
fn page_header(joint: &Joint) -> String {
    let unit = plain(joint.output_unit.as_deref().unwrap_or("unit"));
    format!(
        "| trial | i | verdict | doubt | δ, s | δ | p | q | SSE, {unit}² | slopes, {unit}/sample |\n\
         |---|---|---|---|---|---|---|---|---|---|"
    )
}

fn page_row(trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) -> String {
    let decision = segment.decision;
    let best = decision.shown_candidate();
    let of = |value: Option<f64>| value.map_or_else(String::new, number);
    let delay = decision.delay();
    let period_s = trial.trial.period().seconds();
    let mark = if segment.is_accepted() { "✓" } else { "✗" };
    let cells = [
        plain(trial.trial.label()),
        decision.number.to_string(),
        format!("{mark} {}", decision.verdict()),
        doubt_percent(&segment.doubt),
        of(delay.map(|delay| delay * period_s)),
        of(delay),
        decision.input_step.sample.to_string(),
        segment.place().unwrap_or_default(),
        of(best.map(|best| best.sse)),
        best.map_or_else(String::new, slopes),
    ];
    format!("| {} |", cells.join(" | "))
}

/// The slopes of both lines: in one column, since two are wider than a small window.
fn slopes(best: Candidate) -> String {
    format!("{} → {}", number(best.before.slope), number(best.after.slope))
}

/// SSE at each candidate's tick; empty at the first and last tick of a segment.
fn add_errors(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    let ticks = layout.segments().flat_map(|(trial, segment)| trial.ticks(segment));
    let (moments, errors): (Vec<_>, Vec<_>) =
        ticks.map(|(moment, candidate)| (moment, candidate.map(|it| it.sse))).unzip();
    let name = SeriesLines::new().with_names(["SSE"]);
    chunks.series("decision/sse", &name, (moments.into_iter().collect(), errors))
}

/// A row of `/decision/table`: a candidate, or the verdict with the best one, which has no `j`.
struct Row<'l, 'a> {
    trial: &'l TrialLayout<'a>,
    segment: &'l SegmentLayout<'a>,
    j: Option<usize>,
    candidate: Option<Candidate>,
    /// Rank by squared error within the step.
    rank: Option<i64>,
}

impl<'l, 'a> Row<'l, 'a> {
    /// All rows of a segment, with their moments.
    fn of((trial, segment): Placed<'l, 'a>) -> impl Iterator<Item = (Moment, Self)> {
        let ranks = ranks(segment.decision.candidates.sse());
        let candidates = trial.candidates(segment).map(move |(moment, it)| {
            let rank = ranks.get(it.f - 1).copied();
            (moment, Self { trial, segment, j: Some(it.f), candidate: Some(it), rank })
        });
        let candidate = segment.decision.candidates.best();
        let rank = candidate.map(|_| 1);
        let verdict = Self { trial, segment, j: None, candidate, rank };
        candidates.chain([(trial.verdict(segment), verdict)])
    }

    /// What the row of a verdict has alone.
    fn verdict<T>(&self, of: impl Fn(&Decision) -> T) -> Option<T> {
        self.j.is_none().then(|| of(self.segment.decision))
    }
}

fn q(row: &Row<'_, '_>) -> Option<i64> {
    Some(signed(row.candidate?.breakpoint))
}

/// Samples from the input step to the breakpoint.
fn delta(row: &Row<'_, '_>) -> Option<i64> {
    Some(q(row)? - signed(row.segment.decision.input_step.sample))
}

fn delay_s(row: &Row<'_, '_>) -> Option<f64> {
    let own = row.segment.decision.delay().filter(|_| row.j.is_none());
    let delay = own.or_else(|| delta(row).map(|delta| delta as f64))?;
    Some(delay * row.trial.trial.period().seconds())
}

fn error_times_least(row: &Row<'_, '_>) -> Option<f64> {
    let best = row.segment.decision.candidates.best().filter(|best| best.sse > 0.0)?;
    Some(row.candidate?.sse / best.sse)
}

/// The place of each of `errors` among them, the least being the first.
fn ranks(errors: &[f64]) -> Vec<i64> {
    let mut order: Vec<(usize, &f64)> = errors.iter().enumerate().collect();
    order.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let mut ranks: Vec<(usize, i64)> = order.into_iter().map(|(index, _)| index).zip(1..).collect();
    ranks.sort_unstable();
    ranks.into_iter().map(|(_, rank)| rank).collect()
}

/// A row per candidate, and one per verdict: without `j`, but with `accepted` (1 or 0),
/// `trial` and `verdict`, and the delay between samples where there is one.
fn add_table(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    type Whole = fn(&Row<'_, '_>) -> Option<i64>;
    type Real = fn(&Row<'_, '_>) -> Option<f64>;
    let (moments, rows): (Vec<_>, Vec<_>) = layout.segments().flat_map(Row::of).unzip();
    let whole: [(&str, Whole); 11] = [
        ("i", |row| Some(signed(row.segment.decision.number))),
        ("p", |row| Some(signed(row.segment.decision.input_step.sample))),
        ("r", |row| Some(signed(row.segment.decision.segment.first))),
        ("end", |row| Some(signed(row.segment.decision.segment.last))),
        ("f", |row| row.segment.decision.candidates.best().map(|best| signed(best.f))),
        ("j", |row| row.j.map(signed)),
        ("q", q),
        ("delta", delta),
        ("accepted", |row| row.verdict(|_| i64::from(row.segment.is_accepted()))),
        ("error_rank", |row| row.rank),
        ("breakpoint", q),
    ];
    let real: [(&str, Real); 3] = [
        ("sse", |row| Some(row.candidate?.sse)),
        ("slope_before", |row| Some(row.candidate?.before.slope)),
        ("slope_after", |row| Some(row.candidate?.after.slope)),
    ];
    // What a person reads. A viewer orders columns by their names: these are such that the most telling
    // ones come first.
    let rounded: [(&str, Real); 3] = [
        ("delay_s", delay_s),
        ("error", |row| Some(row.candidate?.sse)),
        ("error_times_least", error_times_least),
    ];
    let trials = rows.iter().map(|row| row.verdict(|_| row.trial.trial.label().to_owned()));
    let verdicts = rows.iter().map(|row| row.verdict(|it| it.verdict().to_string()));
    let fine: Vec<_> = rows.iter().map(|row| row.verdict(|it| it.fine).flatten()).collect();
    let mut columns = vec![texts("trial", trials), texts("verdict", verdicts)];
    columns.extend(whole.map(|(name, value)| integers(name, rows.iter().map(value))));
    columns.extend(real.map(|(name, value)| numbers(name, rows.iter().map(value))));
    columns.extend(rounded.map(|(name, value)| shown(name, rows.iter().map(value))));
    columns.extend(fine_columns(&fine));
    chunks.push(paths::DECISION_TABLE, moments.into_iter().collect(), columns)
}
