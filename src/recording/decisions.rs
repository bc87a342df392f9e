//! The numbers of every candidate and every decision.

use rerun::SeriesLines;

use super::chunk::{Chunks, Moment, integers, numbers, shown, values};
use super::error::RecordError;
use super::layout::{JointLayout, Placed, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::paths;
use crate::delay::{Candidate, Decision};
use crate::report::Doubted;
use crate::report::decisions::{DECISION, decision_text};
use crate::report::facts::Place;
use crate::units::signed;

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
    let rows = layout.segments().take(MOST).map(|(trial, segment)| trial.doubted(segment));
    let table = decision_text(Place::Recording, Some(layout.joint), rows).markdown(plain);
    let all = layout.segments().count();
    let more = if all > MOST { format!("\nThe first {MOST} of {all}.") } else { String::new() };
    chunks.page(paths::DECISION_PAGE, table + &more)
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

    fn doubted(&self) -> Doubted<'a> {
        self.trial.doubted(self.segment)
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

/// What is said of a decision that is the same for all its candidates.
const OF_THE_STEP: [&str; 4] = ["i", "p", "r", "end"];

/// What each candidate has of its own; and what the entity says.
const OF_THE_CANDIDATE: [&str; 8] =
    ["joint", "f_opt", "q", "delta", "delta_s", "sse", "slope_before", "slope_after"];

/// A row per candidate, and one per verdict: without `j`, but with all that is said of the decision,
/// and the delay between samples where there is one.
fn add_table(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    type Whole = fn(&Row<'_, '_>) -> Option<i64>;
    type Real = fn(&Row<'_, '_>) -> Option<f64>;
    let (moments, rows): (Vec<_>, Vec<_>) = layout.segments().flat_map(Row::of).unzip();
    let whole: [(&str, Whole); 7] = [
        ("f", |row| row.segment.decision.candidates.best().map(|best| signed(best.f))),
        ("j", |row| row.j.map(signed)),
        ("q", q),
        ("delta", delta),
        ("accepted", |row| row.verdict(|_| i64::from(row.segment.is_accepted()))),
        ("error_rank", |row| row.rank),
        ("breakpoint", q),
    ];
    let real: [(&str, Real); 4] = [
        ("sse", |row| Some(row.candidate?.sse)),
        ("slope_before", |row| Some(row.candidate?.before.slope)),
        ("slope_after", |row| Some(row.candidate?.after.slope)),
        ("fine_delta", |row| Some(row.verdict(|decision| decision.fine)??.delay)),
    ];
    // What a person reads. A viewer orders columns by their names: these are such that the most telling
    // ones come first.
    let rounded: [(&str, Real); 3] = [
        ("delay_s", delay_s),
        ("error", |row| Some(row.candidate?.sse)),
        ("error_times_least", error_times_least),
    ];
    let facts = DECISION.iter().filter(|fact| !OF_THE_CANDIDATE.contains(&fact.id));
    let mut columns: Vec<_> = facts
        .filter(|fact| fact.is_in_tables())
        .map(|fact| {
            let is_there = |row: &&Row<'_, '_>| row.j.is_none() || OF_THE_STEP.contains(&fact.id);
            let value = |row| Some((fact.value)(&Some(row).filter(is_there)?.doubted()));
            values(fact.id, fact.kind, rows.iter().map(value))
        })
        .collect();
    columns.extend(whole.map(|(name, value)| integers(name, rows.iter().map(value))));
    columns.extend(real.map(|(name, value)| numbers(name, rows.iter().map(value))));
    columns.extend(rounded.map(|(name, value)| shown(name, rows.iter().map(value))));
    chunks.push(paths::DECISION_TABLE, moments.into_iter().collect(), columns)
}
