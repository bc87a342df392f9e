//! The numbers of every candidate and every decision, and the decisions by doubt: lines to click.

use rerun::SeriesLines;
use serde_json::Value;

use super::chunk::{Chunks, Moment, columns, shown, values};
use super::error::RecordError;
use super::layout::{JointLayout, Placed, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::paths;
use crate::delay::{Candidate, Decision};
use crate::report::Doubted;
use crate::report::Kind::{self, Real, Whole};
use crate::report::decisions::{DECISION, decision_text};
use crate::report::facts::Place;
use crate::units::signed;
use crate::wording::doubt_percent;

/// Adds `/decision/sse` and `/decision/table`.
pub(super) fn add(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    add_errors(chunks, layout)?;
    add_page(chunks, layout)?;
    add_table(chunks, layout)?;
    add_doubts(chunks, layout)
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

/// Samples from the input step to the breakpoint.
fn delta(row: &Row<'_, '_>) -> Option<i64> {
    Some(signed(row.candidate?.breakpoint) - signed(row.segment.decision.input_step.sample))
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

type OfRow = fn(&Row<'_, '_>) -> Value;

/// What a row has beside the facts.
#[rustfmt::skip]
const OWN: &[(&str, Kind, OfRow)] = &[
    ("f", Whole, |row| row.segment.decision.candidates.best().map(|best| best.f).into()),
    ("j", Whole, |row| row.j.into()),
    ("q", Whole, |row| row.candidate.map(|it| it.breakpoint).into()),
    ("delta", Whole, |row| delta(row).into()),
    ("accepted", Whole, |row| row.verdict(|_| i64::from(row.segment.is_accepted())).into()),
    ("error_rank", Whole, |row| row.rank.into()),
    ("breakpoint", Whole, |row| row.candidate.map(|it| it.breakpoint).into()),
    ("sse", Real, |row| row.candidate.map(|it| it.sse).into()),
    ("slope_before", Real, |row| row.candidate.map(|it| it.before.slope).into()),
    ("slope_after", Real, |row| row.candidate.map(|it| it.after.slope).into()),
    ("fine_delta", Real, |row| row.verdict(|decision| decision.fine).flatten().map(|fine| fine.delay).into()),
];

/// A row per candidate, and one per verdict: without `j`, but with all that is said of the decision,
/// and the delay between samples where there is one.
fn add_table(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    type Number = fn(&Row<'_, '_>) -> Option<f64>;
    let (moments, rows): (Vec<_>, Vec<_>) = layout.segments().flat_map(Row::of).unzip();
    // What a person reads. A viewer orders columns by their names: these are such that the most telling
    // ones come first.
    let rounded: [(&str, Number); 3] = [
        ("delay_s", delay_s),
        ("error", |row| Some(row.candidate?.sse)),
        ("error_times_least", error_times_least),
    ];
    let facts = DECISION.iter().filter(|fact| !OF_THE_CANDIDATE.contains(&fact.id));
    let facts = facts.filter(|fact| fact.is_in_tables()).map(|fact| {
        let is_there = |row: &&Row<'_, '_>| row.j.is_none() || OF_THE_STEP.contains(&fact.id);
        let value = |row| Some((fact.value)(&Some(row).filter(is_there)?.doubted()));
        values(fact.id, fact.kind, rows.iter().map(|row| value(row).unwrap_or_default()))
    });
    let rounded = rounded.map(|(name, value)| shown(name, rows.iter().map(value)));
    let all = facts.chain(columns(&rows, OWN)).chain(rounded);
    chunks.push(paths::DECISION_TABLE, moments.into_iter().collect(), all)
}

/// Adds `/doubt/log`.
fn add_doubts(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    let ranked = layout.ranked(|segment| segment.rank);
    if ranked.is_empty() {
        return Ok(());
    }
    let index = layout
        .at_the_end(ranked.len())
        .all_at("revision", layout.last_revision)
        .with("doubt", ranked.iter().map(|(_, segment)| segment.rank))
        .all_at("difference", layout.first.is_compared.then_some(1));
    let level = |segment: &SegmentLayout<'_>| match segment.doubt.value() {
        doubt if doubt >= LIKELY => "ERROR",
        _ if segment.doubt.is_doubtful() => "WARN",
        _ => "INFO",
    };
    let lines = ranked.iter().map(|(trial, segment)| (Some(level(segment)), line(trial, segment)));
    chunks.lines(paths::DOUBT_LOG, index, lines)
}

/// Doubt from which on a line is red; what is doubtful below it is yellow. Chosen: on synthetic
/// records about every second accepted step above it is off by more than one and a half rows of β.
const LIKELY: f64 = 0.6;

fn line(trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) -> String {
    let doubt = doubt_percent(&segment.doubt);
    let not = if segment.doubt.is_doubtful() { "" } else { " (not doubtful)" };
    // A line is cut where its list ends: the delay is in the verdict, the whole reason on the page.
    let mark = if segment.is_accepted() { '✓' } else { '✗' };
    let (step, why) = (trial.step(segment), trial.reason(segment));
    format!("{doubt:>5} {mark} {step}: {why}{not}")
}
