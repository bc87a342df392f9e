//! Each verdict in words, with every number that was compared.

use std::iter::once;

use rerun::{Color, StateConfiguration};

use super::chunk::{Chunks, Index};
use super::difference::{Other, row};
use super::error::RecordError;
use super::layout::{JointLayout, Placed, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::palette::{self, color};
use super::paths;
use crate::delay::{Check, Condition, Decision, Outcome, Verdict};
use crate::report::answer::dead_time_sentences;
use crate::report::decisions::DECISION;
use crate::report::estimate::onset_sentence;
use crate::report::facts::Place;
use crate::report::{DelayRange, EstimatedJoint, JointSummary};
use crate::study::StepResult;
use crate::wording::{doubt_percent, number, rounded, verdict_in_short};

/// Adds `/verdict` (text, log line and lane), `/segment` and `/trial` (lanes).
pub(super) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    others: &[Other<'_>],
) -> Result<(), RecordError> {
    let estimated = layout.estimated;
    let segments: Vec<_> = layout.segments().collect();
    let opening = layout.openings();
    let typical = typical_delay(estimated);
    let text = |(trial, segment): &Placed<'_, '_>| {
        let methods = methods(trial, segment, others);
        Facts { trial, segment, typical: typical.as_deref() }.page(&methods)
    };
    if segments.is_empty() {
        let name = plain(&layout.joint.name);
        let text = match dead_time_sentences(&estimated).as_slice() {
            [] => {
                let why = JointSummary::of(estimated).without_steps;
                format!("### {name}\n## no step to decide: {why}\n")
            }
            // What was found comes first, then what makes it doubtful, then why there are no steps.
            [moves, finding, rest @ ..] => {
                let others = rest.iter().rev().chain(once(moves));
                let others = others.map(|sentence| format!("- {sentence}\n"));
                format!("### {name}\n## {finding}\n\n{}", others.collect::<String>())
            }
            [moves] => format!("### {name}\n- {moves}\n"),
        };
        chunks.page(paths::VERDICT, text)?;
    }
    let states = segments.iter().map(|(_, segment)| segment.decision.verdict().to_string());
    chunks.pages(paths::VERDICT, opening.clone(), segments.iter().map(text))?;
    chunks.states(paths::VERDICT, opening.clone(), states)?;
    chunks.push_static(paths::VERDICT, &lane_colors())?;
    add_log(chunks, &segments, layout.last_revision)?;
    add_lanes(chunks, layout, &segments, opening)
}

fn lane_colors() -> StateConfiguration {
    let conditions = || Condition::ALL.into_iter().chain([Condition::Reviewer]);
    let values = once("accepted").chain(conditions().map(Condition::id));
    // A mark is seen where there is no room for words.
    let labels = conditions().map(|condition| format!("✗ {condition}"));
    let labels = once("✓ accepted".to_owned()).chain(labels);
    let rejected = conditions().map(|_| color(palette::REJECTED));
    let colors: Vec<Color> = once(color(palette::ACCEPTED)).chain(rejected).collect();
    StateConfiguration::new().with_values(values).with_labels(labels).with_colors(colors)
}

/// One line per segment, at its opening tick: a click on it goes there, and the right arrow then to
/// its candidates.
fn add_log(
    chunks: &mut Chunks,
    segments: &[Placed<'_, '_>],
    last_revision: Option<i64>,
) -> Result<(), RecordError> {
    let index: Index = segments.iter().map(|(trial, segment)| trial.opening(segment)).collect();
    // On the timeline of revisions, too, where a click leads away from.
    let index = index.all_at("revision", last_revision);
    let level = |segment: &SegmentLayout<'_>| if segment.is_accepted() { "INFO" } else { "WARN" };
    let lines = segments.iter().map(|(t, s)| (Some(level(s)), log_line(t, s)));
    chunks.lines(paths::VERDICT_LOG, index, lines)
}

fn log_line(trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) -> String {
    let decision = segment.decision;
    let trials =
        if trial.is_one_of_several() { format!("{} ", trial.trial.label()) } else { String::new() };
    let step = format!("{trials}step {:>3}", decision.number);
    let verdict = verdict(trial, decision);
    let at = format!("p {}", decision.input_step.sample);
    let found = decision.shown_candidate().zip(decision.delay());
    let found = found.map_or_else(String::new, |(best, delay)| {
        let (q, sse) = (segment.place().unwrap_or_default(), number(best.sse));
        format!(", q {q}, δ {}, SSE {sse}", number(delay))
    });
    let doubt = doubt_percent(&segment.doubt);
    format!("{step}  {verdict}   ({at}{found}; doubt {doubt})")
}

/// A step and its verdict.
pub(super) fn in_short(trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) -> String {
    format!("{} {}", trial.step(segment), verdict(trial, segment.decision))
}

fn verdict(trial: &TrialLayout<'_>, decision: &Decision) -> String {
    let period = trial.trial.period().seconds();
    let delay = |delay: Option<f64>| {
        delay.map_or_else(String::new, |delay| format!(" δ {}", seconds(decision, delay, period)))
    };
    let accepted = format!("✓{}", delay(decision.program_delay()));
    let program = verdict_in_short(decision.program_verdict(), &accepted);
    if decision.reviewer_verdict.is_none() {
        return program;
    }
    let said = match decision.verdict() {
        Verdict::Accepted => format!("✓ by a reviewer{}", delay(decision.delay())),
        Verdict::Rejected(_) => "✗ by a reviewer".to_owned(),
    };
    format!("{said} (the program: {program})")
}

/// Seconds: to a millisecond, and finer where delays are between samples.
fn seconds(decision: &Decision, samples: f64, period: f64) -> String {
    let decimals = if decision.fine.is_some() { 5 } else { 3 };
    format!("{:.decimals$} s", samples * period)
}

fn add_lanes(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    segments: &[Placed<'_, '_>],
    opening: Index,
) -> Result<(), RecordError> {
    let names: Vec<_> =
        segments.iter().map(|(_, segment)| segment.decision.number.to_string()).collect();
    // Two greys in turn: the border between two steps is seen, and nothing else shouts.
    let greys = (0..names.len()).map(|n| {
        if n % 2 == 0 { Color::from_rgb(72, 84, 96) } else { Color::from_rgb(98, 110, 122) }
    });
    let style = StateConfiguration::new().with_values(names.clone()).with_colors(greys);
    chunks.push_static(paths::SEGMENT, &style)?;
    chunks.states(paths::SEGMENT, opening, names)?;
    let hint = ["along decision, segment, sample or time: choose it at the bottom left"];
    // On the timeline of revisions the lane has nothing else.
    chunks.states(paths::SEGMENT, Index::on("revision", layout.first.revision), hint)?;
    let starts = layout.trials.iter().filter_map(|trial| trial.moments(1).next());
    let labels = layout.trials.iter().map(|trial| trial.trial.label());
    chunks.states(paths::TRIAL, starts.collect(), labels)
}

/// The accepted delays of a joint: what one of them is held against.
fn typical_delay(estimated: EstimatedJoint<'_>) -> Option<String> {
    let DelayRange { min, median, max } = JointSummary::of(estimated).delay_s?;
    let [min, median, max] = [min, median, max].map(rounded);
    Some(format!("{median} s, of {min} to {max} s"))
}

/// The table of all results, where there are several.
fn methods(trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>, others: &[Other<'_>]) -> String {
    let here = StepResult::of(trial.trial, segment.decision);
    let found =
        |other: &Other<'_>| Some(row(&other.pair(&here.trial, here.p)?.there, &plain(other.name)));
    let others: Vec<String> = others.iter().filter_map(found).collect();
    if others.is_empty() {
        return String::new();
    }
    let first = row(&here, &format!("{}, here", trial.estimated.estimate.settings.method));
    let others = others.join("\n");
    format!("\n| result | δ, samples | verdict |\n|---|---|---|\n{first}\n{others}\n")
}

#[derive(Clone, Copy)]
struct Facts<'l, 'a> {
    trial: &'l TrialLayout<'a>,
    segment: &'l SegmentLayout<'a>,
    /// The delays of all accepted steps of the joint, in words.
    typical: Option<&'l str>,
}

impl Facts<'_, '_> {
    /// The page beside the drawing: verdict first, then what it was made of.
    fn page(&self, methods: &str) -> String {
        let (of, number) = (self.trial.segments.len(), self.segment.decision.number);
        let in_trial = if self.trial.is_one_of_several() {
            format!(", trial {}", plain(self.trial.trial.label()))
        } else {
            String::new()
        };
        let title = format!(
            "### {}{in_trial}: step {number} of {of}",
            plain(&self.trial.estimated.joint.name)
        );
        let (headline, doubt, asked) = (self.headline(), self.doubt(of), self.asked());
        let (conditions, quantities) = (self.conditions(), self.quantities());
        format!(
            "{title}\n{headline}\n\n{doubt}\n{methods}\n{conditions}\n\n{quantities}\n\n{asked}\n"
        )
    }

    fn delay(&self, samples: f64) -> String {
        seconds(self.segment.decision, samples, self.trial.trial.period().seconds())
    }

    /// How doubtful the decision is, and why.
    fn doubt(&self, of: usize) -> String {
        let (percent, rank) = (doubt_percent(&self.segment.doubt), self.segment.rank);
        let of = if self.trial.is_one_of_several() { String::new() } else { format!(" of {of}") };
        format!(
            "doubt **{percent}** (rank {rank}{of} of this joint): {}",
            self.trial.reason(self.segment)
        )
    }

    fn headline(&self) -> String {
        let decision = self.segment.decision;
        match &decision.reviewer_verdict {
            None => self.program_headline(),
            Some(reviewed) => {
                let said = match (reviewed.accepted, decision.delay()) {
                    (true, Some(delay)) => format!("✓ accepted: delay {}", self.delay(delay)),
                    (true, None) => "✓ accepted".to_owned(),
                    (false, _) => "✗ rejected".to_owned(),
                };
                let (by, note) = (plain(&reviewed.reviewer), plain(&reviewed.note));
                let by = if by.is_empty() { "a reviewer".to_owned() } else { by };
                let note = if note.is_empty() { note } else { format!("\n> {note}\n") };
                let program = self.program_headline().replacen("## ", "", 1);
                // A heading of its own has no stop after it.
                let program = program.replacen('\n', ".\n\n", 1);
                let stop = if program.contains('\n') { "" } else { "." };
                format!("## {said} (by {by})\n{note}\n**The program:** {program}{stop}\n")
            }
        }
    }

    fn program_headline(&self) -> String {
        let decision = self.segment.decision;
        match (decision.program_verdict(), decision.program_delay()) {
            (Verdict::Accepted, Some(delay)) => {
                let doubtful = if self.segment.doubt.is_doubtful() { ", doubtful" } else { "" };
                format!(
                    "## ✓ accepted{doubtful}: delay {}\n{}",
                    self.delay(delay),
                    self.why_accepted()
                )
            }
            (Verdict::Accepted, None) => "## ✓ accepted".to_owned(),
            (Verdict::Rejected(first), _) => {
                let failed = decision.failed_checks();
                let whys: Vec<_> = failed.map(|check| format!("- {}", self.why(&check))).collect();
                format!("## ✗ rejected: {}\n{}", first.meaning(), whys.join("\n"))
            }
        }
    }

    /// What speaks for the breakpoint, and that nothing speaks against it.
    fn why_accepted(&self) -> String {
        let decision = self.segment.decision;
        let Some(best) = decision.breakpoint() else { return String::new() };
        let per_second = |slope: f64| rounded(slope / self.trial.trial.period().seconds());
        let [before, after] = [best.candidate.before, best.candidate.after];
        let [before, after] = [before, after].map(|line| per_second(line.slope));
        let unit =
            self.trial.estimated.joint.output_unit.as_deref().map_or_else(String::new, plain);
        let is_set = |check: &Check| check.outcome == Outcome::Passed;
        let held = decision.checks.into_iter().filter(is_set).count();
        format!(
            "The slope changes from {before} to {after} {unit}/s there; {} met.\n",
            match held {
                1 => "the one condition that applies is".to_owned(),
                _ => format!("all {held} conditions that apply are"),
            }
        )
    }

    /// A failed condition as a sentence with its numbers.
    fn why(&self, check: &Check) -> String {
        let (value, needed) = self.compared(check);
        let needed = needed.unwrap_or_else(|| "a step on each side".to_owned());
        format!("**{}**: {value}, but needs {needed}", check.condition)
    }

    /// All that is said of the decision, and of the joint what it is held against.
    fn quantities(&self) -> String {
        let (found, joint) = (self.trial.doubted(self.segment), self.trial.estimated.joint);
        let mut page = "| quantity | value |\n|---|---|".to_owned();
        let mut row = |name: &str, value: &str| page.extend(["\n| ", name, " | ", value, " |"]);
        for fact in DECISION.iter().filter(|fact| fact.is_shown(Place::Verdict)) {
            let value = (fact.value)(&found);
            if !value.is_null() {
                row(&fact.label(), &plain(&fact.in_words(&value, joint, self.trial.trial)));
            }
        }
        if let Some(model) = self.trial.estimate.onset_model.as_deref() {
            row("response after the delay", &plain(&onset_sentence(model)));
        }
        if let Some(tracking) = &self.trial.estimate.tracking {
            let (offset, gain) = (number(tracking.offset()), number(tracking.gain()));
            row("output tracks the input, at rest", &format!("{offset} + {gain}·u"));
        }
        if let Some(typical) = self.typical {
            row("median delay of the joint", typical);
        }
        page
    }

    fn conditions(&self) -> String {
        let row = |check: Check| {
            let mark = match check.outcome {
                Outcome::Passed => "✓",
                Outcome::Failed => "✗",
                Outcome::NotChecked => "–",
            };
            // `✓ nothing_happened` would read inverted.
            format!("| {mark} | {} | {} |", check.condition.when_met(), self.in_short(&check))
        };
        let rows: Vec<_> = self.segment.decision.checks.into_iter().map(row).collect();
        format!("| | met when | value (limit) |\n|---|---|---|\n{}", rows.join("\n"))
    }

    /// What the conditions ask that were checked; `–` has no limit, or nothing to compare.
    fn asked(&self) -> String {
        let checks = self.segment.decision.checks.into_iter();
        let checked = checks.filter(|check| check.outcome != Outcome::NotChecked);
        let asked = checked.map(|check| {
            let condition = check.condition;
            format!("- *{}* (`{condition}`): {}", condition.when_met(), condition.asks())
        });
        let asked: Vec<_> = asked.collect();
        format!("What the conditions ask (–: no limit, not checked):\n\n{}", asked.join("\n"))
    }

    /// Value and what it must be, as narrow as a cell is: `q = 11070 (≥ p = 11069)`.
    fn in_short(&self, check: &Check) -> String {
        let (value, needed) = self.compared(check);
        needed.map_or_else(|| value.clone(), |needed| format!("{value} ({needed})"))
    }

    /// Value of a condition, and what it must be, if a limit is set.
    fn compared(&self, check: &Check) -> (String, Option<String>) {
        let said = |text: &dyn Fn(String) -> String| {
            check.value.map_or_else(|| "none".to_owned(), |value| text(number(value)))
        };
        let output = |words: &str, per: &str| {
            let unit = self.trial.estimated.joint.output_unit.as_deref();
            let unit = unit.map(|unit| format!(" {unit}{per}")).unwrap_or_default();
            said(&|value| format!("{words}{value}{unit}"))
        };
        let needed = |relation: &str| check.limit.map(|it| format!("{relation} {}", number(it)));
        match check.condition {
            Condition::FirstOrLast => {
                let last = check.limit.unwrap_or_default();
                let between = format!("2 to {}", number(last - 1.0));
                let is_judged = check.outcome == Outcome::NotChecked;
                let step = said(&|step| format!("step {step} of {}", number(last)));
                (step, (!is_judged && last > 2.0).then_some(between))
            }
            Condition::OutputLimit => {
                let between = |(low, high)| format!("{} to {}", number(low), number(high));
                (
                    output("y = ", ""),
                    self.trial.estimated.estimate.settings.output_limits.map(between),
                )
            }
            // Of a delay between samples the end of its interval counts.
            Condition::BeforeInput => {
                let sign = if self.segment.decision.fine.is_some() { "≤" } else { "=" };
                (said(&|q| format!("q {sign} {q}")), needed("≥ p ="))
            }
            Condition::SlopeChange => (output("", "/sample"), needed("≥")),
            Condition::ShortHold => (said(&|hold| format!("{hold} samples")), needed("≥")),
            Condition::Sse => (output("", "²"), needed("<")),
            Condition::TooShort => {
                let beta = self.trial.estimated.estimate.settings.beta;
                (said(&|rows| format!("{rows} rows of β = {beta}")), needed("≥"))
            }
            Condition::AtRest => (output("moves by ", ""), needed(">")),
            Condition::NothingHappened => {
                let value = check.value.map(|p| format!("p-value {}", rounded(p)));
                (value.unwrap_or_else(|| "none".to_owned()), needed("≤"))
            }
            Condition::Reviewer => ("none".to_owned(), None),
        }
    }
}
