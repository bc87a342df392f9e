//! The numbers of every candidate and every decision.

use rerun::{EntityPath, Scalars, SeriesLines, TextDocument};

use super::chunk::{Chunks, Index, fine_columns, integers, numbers, shown, texts};
use super::error::RecordError;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::paths::{self, at};
use crate::delay::{Candidate, FineDelay, Verdict};
use crate::experiment::Joint;
use crate::units::signed;
use crate::wording::{doubt_percent, number};

/// Adds `/decision/sse` and `/decision/table`.
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    joint: &Joint,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    add_errors(chunks, root, layout)?;
    add_page(chunks, root, joint, layout)?;
    add_table(chunks, root, layout)
}

/// All decisions as a person reads them: what the table has, in five digits.
fn add_page(
    chunks: &mut Chunks,
    root: &EntityPath,
    joint: &Joint,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    /// Rows that a person still reads.
    const MOST: usize = 1000;
    let rows: Vec<_> = layout.segments().take(MOST).map(|(t, s)| page_row(t, s)).collect();
    let all = layout.segments().count();
    let more = if all > MOST { format!("\n\nThe first {MOST} of {all}.") } else { String::new() };
    let page = format!("{}\n{}{more}", page_header(joint), rows.join("\n"));
    let document = TextDocument::from_markdown(page);
    chunks.push_static(at(root, paths::DECISION_PAGE), &document)
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
    let mark = if decision.verdict() == Verdict::Accepted { "✓" } else { "✗" };
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
fn add_errors(
    chunks: &mut Chunks,
    root: &EntityPath,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    let (mut index, mut errors, mut lengths) = (Index::default(), Vec::new(), Vec::new());
    for (trial, segment) in layout.segments() {
        index.extend([trial.opening(segment)]);
        lengths.push(0);
        for (moment, candidate) in trial.candidates(segment) {
            index.extend([moment]);
            errors.push(candidate.sse);
            lengths.push(1);
        }
        index.extend([trial.verdict(segment)]);
        lengths.push(0);
    }
    let entity = at(root, paths::SSE);
    let name = SeriesLines::new().with_names(["SSE"]);
    chunks.push_static(entity.clone(), &name)?;
    chunks.push(entity, index, Scalars::new(errors).columns(lengths)?)
}

/// Rows of `/decision/table`, column by column.
#[derive(Default)]
struct Table {
    index: Index,
    whole: [Vec<Option<i64>>; 8],
    real: [Vec<Option<f64>>; 3],
    /// Rank by squared error within the step.
    rank: Vec<Option<i64>>,
    /// What a person reads, in the order of [`Self::SHOWN`].
    shown: [Vec<Option<f64>>; 3],
    accepted: Vec<Option<i64>>,
    fine: Vec<Option<FineDelay>>,
    /// Trial and verdict.
    words: [Vec<Option<String>>; 2],
}

impl Table {
    const WHOLE: [&str; 8] = ["i", "p", "r", "end", "f", "j", "q", "delta"];
    const REAL: [&str; 3] = ["sse", "slope_before", "slope_after"];
    /// A viewer orders columns by their names: these are such that the most telling ones come first.
    const SHOWN: [&str; 3] = ["delay_s", "error", "error_times_least"];

    /// The numbers of `candidate`, of which so many have a smaller error; `j` is its number, empty on
    /// the row of the verdict.
    fn row(
        &mut self,
        (trial, segment): (&TrialLayout<'_>, &SegmentLayout<'_>),
        j: Option<usize>,
        (candidate, rank): (Option<Candidate>, Option<i64>),
    ) {
        let decision = segment.decision;
        let p = decision.input_step.sample;
        let best = decision.candidates.best();
        let breakpoint = candidate.map(|candidate| signed(candidate.breakpoint));
        let whole = [
            Some(signed(decision.number)),
            Some(signed(p)),
            Some(signed(decision.segment.first)),
            Some(signed(decision.segment.last)),
            best.map(|best| signed(best.f)),
            j.map(signed),
            breakpoint,
            breakpoint.map(|q| q - signed(p)),
        ];
        let real = [
            candidate.map(|candidate| candidate.sse),
            candidate.map(|candidate| candidate.before.slope),
            candidate.map(|candidate| candidate.after.slope),
        ];
        self.whole.iter_mut().zip(whole).for_each(|(column, value)| column.push(value));
        self.real.iter_mut().zip(real).for_each(|(column, value)| column.push(value));
        let period_s = trial.trial.period().seconds();
        let own = decision.delay().filter(|_| j.is_none());
        let delay = own.or_else(|| breakpoint.map(|q| (q - signed(p)) as f64));
        let [sse, ..] = real;
        let ratio = sse.zip(best.filter(|best| best.sse > 0.0)).map(|(sse, best)| sse / best.sse);
        let shown = [delay.map(|delay| delay * period_s), sse, ratio];
        self.shown.iter_mut().zip(shown).for_each(|(column, value)| column.push(value));
        self.rank.push(rank);
        let accepted = i64::from(decision.verdict() == Verdict::Accepted);
        self.accepted.push(j.is_none().then_some(accepted));
        self.fine.push(decision.fine.filter(|_| j.is_none()));
        let [trials, verdicts] = &mut self.words;
        trials.push(j.is_none().then(|| trial.trial.label().to_owned()));
        verdicts.push(j.is_none().then(|| decision.verdict().to_string()));
    }

    fn segment(&mut self, trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) {
        let ranks = ranks(segment.decision.candidates.sse());
        for (moment, candidate) in trial.candidates(segment) {
            self.index.extend([moment]);
            let rank = ranks.get(candidate.f - 1).copied();
            self.row((trial, segment), Some(candidate.f), (Some(candidate), rank));
        }
        self.index.extend([trial.verdict(segment)]);
        let best = segment.decision.candidates.best();
        self.row((trial, segment), None, (best, best.map(|_| 1)));
    }
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
fn add_table(
    chunks: &mut Chunks,
    root: &EntityPath,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    let mut table = Table::default();
    for (trial, segment) in layout.segments() {
        table.segment(trial, segment);
    }
    let whole = Table::WHOLE.iter().zip(&table.whole).map(|(name, values)| integers(name, values));
    let real = Table::REAL.iter().zip(&table.real).map(|(name, values)| numbers(name, values));
    let rounded = Table::SHOWN.iter().zip(&table.shown).map(|(name, values)| shown(name, values));
    let [trials, verdicts] = &table.words;
    let words = [texts("trial", trials), texts("verdict", verdicts)];
    let [.., breakpoints, _] = &table.whole;
    let accepted = [
        integers("accepted", &table.accepted),
        integers("error_rank", &table.rank),
        integers("breakpoint", breakpoints),
    ];
    let fine = fine_columns(&table.fine);
    let columns: Vec<_> =
        whole.chain(real).chain(rounded).chain(accepted).chain(words).chain(fine).collect();
    chunks.push(at(root, paths::DECISION_TABLE), table.index, columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_error_is_the_first() {
        assert_eq!(ranks(&[3.0, 1.0, 2.0]), [3, 1, 2]);
        assert_eq!(ranks(&[]), [0; 0]);
    }
}
