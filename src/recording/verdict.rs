//! Each verdict in words, with every number that was compared.

use std::iter::once;

use rerun::{Color, EntityPath, StateChange, StateConfiguration, TextDocument, TextLog};

use super::beside::{Other, decided_row, row};
use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::markdown::plain;
use super::palette::{self, color};
use super::paths::{self, at};
use crate::delay::{Check, Condition, Decision, FineDelay, OnsetModel, Outcome};
use crate::delay::{Settings, Tracking, Verdict};
use crate::experiment::Joint;
use crate::numerics::quantile;
use crate::report::{EstimatedJoint, JointSummary, dead_time_sentences};
use crate::wording::{counted, doubt_percent, number, remedy_text, rounded, samples_text};

/// Adds `/verdict` (text, log line and lane), `/segment` and `/trial` (lanes).
pub(super) fn add(
    chunks: &mut Chunks,
    root: &EntityPath,
    estimated: EstimatedJoint<'_>,
    layout: &JointLayout<'_>,
    others: &[Other<'_>],
) -> Result<(), RecordError> {
    let (joint, settings) = (estimated.joint, &estimated.estimate.settings);
    let segments: Vec<_> = layout.segments().collect();
    let opening = layout.openings();
    let typical = typical_delay(estimated);
    let text = |(trial, segment): &Placed<'_, '_>| {
        let methods = methods(trial, segment, settings, others);
        document(Facts { joint, trial, segment, settings, typical: typical.as_deref() }, &methods)
    };
    let texts: Vec<String> = segments.iter().map(text).collect();
    let markdown = std::iter::repeat_n("text/markdown", texts.len());
    let documents =
        TextDocument::update_fields().with_many_text(texts).with_many_media_type(markdown);
    let verdict = |(_, segment): &Placed<'_, '_>| segment.decision.verdict().to_string();
    let states: Vec<String> = segments.iter().map(verdict).collect();
    let states = StateChange::new().with_state(states).columns_of_unit_batches()?;
    let entity = at(root, paths::VERDICT);
    if segments.is_empty() {
        let name = plain(&joint.name);
        let text = match dead_time_sentences(&estimated).as_slice() {
            [] => {
                let why = JointSummary::of(estimated).without_steps();
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
        chunks.push_static(entity.clone(), &TextDocument::from_markdown(text))?;
    }
    let columns = documents.columns_of_unit_batches()?.chain(states);
    chunks.push(entity.clone(), opening.clone(), columns)?;
    chunks.push_static(entity, &lane_colors())?;
    add_log(chunks, root, joint, (&segments, layout.last_revision))?;
    add_lanes(chunks, root, layout, &segments, opening)
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

type Placed<'l, 'a> = (&'l TrialLayout<'a>, &'l SegmentLayout<'a>);

/// One line per segment, at its opening tick: a click on it goes there, and the right arrow then to
/// its candidates.
fn add_log(
    chunks: &mut Chunks,
    root: &EntityPath,
    joint: &Joint,
    (segments, last_revision): (&[Placed<'_, '_>], Option<i64>),
) -> Result<(), RecordError> {
    let index: Index = segments.iter().map(|(trial, segment)| trial.opening(segment)).collect();
    let lines: Vec<_> = segments.iter().map(|(t, s)| log_line(joint, t, s)).collect();
    // On the timeline of revisions, too, where a click leads away from.
    let index = index.at_revision(last_revision);
    let accepted = |segment: &SegmentLayout<'_>| segment.decision.verdict() == Verdict::Accepted;
    let levels = segments.iter().map(|(_, s)| if accepted(s) { "INFO" } else { "WARN" });
    let log = TextLog::update_fields().with_many_text(lines).with_many_level(levels);
    chunks.push(at(root, paths::VERDICT_LOG), index, log.columns_of_unit_batches()?)
}

fn log_line(joint: &Joint, trial: &TrialLayout<'_>, segment: &SegmentLayout<'_>) -> String {
    let decision = segment.decision;
    let trials =
        if joint.trials.len() > 1 { format!("{} ", trial.trial.label()) } else { String::new() };
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

/// Which step of which trial it is.
pub(super) fn step_of(
    joint: &Joint,
    trial: &TrialLayout<'_>,
    segment: &SegmentLayout<'_>,
) -> String {
    let number = segment.decision.number;
    match joint.trials.len() {
        1 => format!("step {number}"),
        _ => format!("{}, step {number}", trial.trial.label()),
    }
}

/// A step and its verdict.
pub(super) fn in_short(
    joint: &Joint,
    trial: &TrialLayout<'_>,
    segment: &SegmentLayout<'_>,
) -> String {
    format!("{} {}", step_of(joint, trial, segment), verdict(trial, segment.decision))
}

fn verdict(trial: &TrialLayout<'_>, decision: &Decision) -> String {
    let period = trial.trial.period().seconds();
    let seconds = |delay: f64| format!("δ {}", seconds(decision, delay, period));
    let program = match (decision.program_verdict(), decision.program_delay()) {
        (Verdict::Rejected(condition), _) => format!("✗ {}", condition.meaning()),
        (Verdict::Accepted, delay) => format!("✓ {}", delay.map_or_else(String::new, seconds)),
    };
    if decision.reviewer_verdict.is_some() {
        let said = match (decision.verdict(), decision.delay()) {
            (Verdict::Accepted, Some(delay)) => format!("✓ by a reviewer {}", seconds(delay)),
            (Verdict::Accepted, None) => "✓ by a reviewer".to_owned(),
            (Verdict::Rejected(_), _) => "✗ by a reviewer".to_owned(),
        };
        return format!("{said} (the program: {program})");
    }
    program
}

/// Seconds: to a millisecond, and finer where delays are between samples.
fn seconds(decision: &Decision, samples: f64, period: f64) -> String {
    let decimals = if decision.fine.is_some() { 5 } else { 3 };
    format!("{:.decimals$} s", samples * period)
}

fn add_lanes(
    chunks: &mut Chunks,
    root: &EntityPath,
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
    let entity = at(root, paths::SEGMENT);
    chunks.push_static(entity.clone(), &style)?;
    chunks.push(
        entity,
        opening,
        StateChange::new().with_state(names).columns_of_unit_batches()?,
    )?;
    let revision = layout.first.revision.into_iter();
    let hint = ["along decision, segment, sample or time: choose it at the bottom left"];
    let hint = StateChange::new().with_state(hint).columns_of_unit_batches()?;
    // On the timeline of revisions the lane has nothing else.
    chunks.push_revisions(at(root, paths::SEGMENT), revision.collect(), hint)?;
    let starts = layout.trials.iter().filter_map(|trial| trial.moments(1).next());
    let labels: Vec<_> = layout.trials.iter().map(|trial| trial.trial.label().to_owned()).collect();
    let states = StateChange::new().with_state(labels).columns_of_unit_batches()?;
    chunks.push(at(root, paths::TRIAL), starts.collect(), states)
}

/// The page beside the drawing: verdict first, then what it was made of.
fn document(facts: Facts<'_, '_>, methods: &str) -> String {
    let Facts { joint, trial, segment, .. } = facts;
    let decision = segment.decision;
    let of = trial.segments.len();
    let in_trial = match joint.trials.len() {
        1 => String::new(),
        _ => format!(", trial {}", plain(trial.trial.label())),
    };
    let name = plain(&joint.name);
    let title = format!("### {name}{in_trial}: step {} of {of}", decision.number);
    let headline = facts.headline();
    let (doubt, conditions, quantities) = (facts.doubt(of), facts.conditions(), facts.quantities());
    let asked = facts.asked();
    format!("{title}\n{headline}\n\n{doubt}\n{methods}\n{conditions}\n\n{quantities}\n\n{asked}\n")
}

/// The page on a decision, without other results.
pub(super) fn page(
    estimated: EstimatedJoint<'_>,
    trial: &TrialLayout<'_>,
    segment: &SegmentLayout<'_>,
) -> String {
    let settings = &estimated.estimate.settings;
    let typical = typical_delay(estimated);
    let typical = typical.as_deref();
    document(Facts { joint: estimated.joint, trial, segment, settings, typical }, "")
}

/// The median delay of the accepted steps of a joint, and the range of most of them: what one of
/// them is held against.
fn typical_delay(EstimatedJoint { joint, estimate }: EstimatedJoint<'_>) -> Option<String> {
    /// Share of the steps that lie between both ends.
    const MOST: f64 = 0.8;
    let mut delays = Vec::new();
    for (trial, found) in joint.trials.iter().zip(&estimate.trials) {
        let decisions = found.iter().flat_map(|found| &found.decisions);
        let accepted = decisions.filter_map(Decision::accepted_delay);
        delays.extend(accepted.map(|samples| samples * trial.period().seconds()));
    }
    let [low, middle, high] =
        [0.5 - MOST / 2.0, 0.5, 0.5 + MOST / 2.0].map(|part| quantile(&delays, part).map(rounded));
    let most = number(100.0 * MOST);
    Some(format!("{} s; {most} % within {} to {} s", middle?, low?, high?))
}

/// The table of all results, where there are several.
fn methods(
    trial: &TrialLayout<'_>,
    segment: &SegmentLayout<'_>,
    settings: &Settings,
    others: &[Other<'_>],
) -> String {
    let (label, p) = (trial.trial.label(), segment.decision.input_step.sample);
    let found = |other: &Other<'_>| Some(row(&plain(other.name), &other.pair(label, p)?.there));
    let others: Vec<String> = others.iter().filter_map(found).collect();
    if others.is_empty() {
        return String::new();
    }
    let first = decided_row(&format!("{}, here", settings.method), segment.decision);
    let others = others.join("\n");
    format!("\n| result | δ, samples | verdict |\n|---|---|---|\n{first}\n{others}\n")
}

#[derive(Clone, Copy)]
struct Facts<'l, 'a> {
    joint: &'l Joint,
    trial: &'l TrialLayout<'a>,
    segment: &'l SegmentLayout<'a>,
    settings: &'l Settings,
    /// The delays of all accepted steps of the joint, in words.
    typical: Option<&'l str>,
}

impl Facts<'_, '_> {
    fn seconds(&self, samples: f64) -> String {
        format!("{:.3} s", samples * self.trial.trial.period().seconds())
    }

    fn delay(&self, samples: f64) -> String {
        seconds(self.segment.decision, samples, self.trial.trial.period().seconds())
    }

    fn at(&self, sample: usize) -> String {
        let in_trial = format!("sample {sample} = {:.3} s", self.trial.trial.time_s(sample));
        if self.joint.trials.len() < 2 {
            return in_trial;
        }
        let joined = self.trial.time_ns(sample) as f64 * 1e-9;
        format!("{in_trial} of the trial; {} = {joined:.3} s in a row", self.trial.sample(sample))
    }

    /// How doubtful the decision is, and why.
    fn doubt(&self, of: usize) -> String {
        let (percent, rank) = (doubt_percent(&self.segment.doubt), self.segment.rank);
        let several = self.joint.trials.len() > 1;
        let of = if several { String::new() } else { format!(" of {of}") };
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
                // A heading of its own has no stop behind it.
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
        let unit = self.joint.output_unit.as_deref().map_or_else(String::new, plain);
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

    fn quantities(&self) -> String {
        let decision = self.segment.decision;
        let step = decision.input_step;
        let unit = self.joint.input_unit.as_deref();
        let input = |value| with_unit(value, unit, "");
        let (first, last) = (decision.segment.first, decision.segment.last);
        let mut rows = vec![
            ("input step p".to_owned(), self.at(step.sample)),
            ("input".to_owned(), format!("{} → {}", input(step.before), input(step.after))),
            (
                "input keeps this level for".to_owned(),
                format!(
                    "{} = {}",
                    counted(decision.hold, "sample"),
                    self.seconds(decision.hold as f64)
                ),
            ),
            (
                "segment r … end".to_owned(),
                format!("{first} … {last}: {} samples", decision.segment.len()),
            ),
        ];
        if let Some(best) = decision.breakpoint() {
            let candidate = best.candidate;
            let slope = |slope| with_unit(slope, self.joint.output_unit.as_deref(), "/sample");
            let samples = decision.delay().unwrap_or(best.delay as f64);
            let delay = format!("**{} = {}**", samples_text(samples), self.delay(samples));
            let count = decision.candidates.len();
            let breakpoint = match decision.delay_before_review().and(self.segment.place()) {
                Some(place) => format!("sample {place}, by a reviewer"),
                None => self.breakpoint(candidate.breakpoint),
            };
            if let Some(delay) = decision.delay_before_review() {
                let program = format!("{} = {}", samples_text(delay), self.delay(delay));
                let place = self.at(candidate.breakpoint);
                rows.push(("the program's δ and q".to_owned(), format!("{program}; {place}")));
            }
            rows.extend([
                ("breakpoint q".to_owned(), breakpoint),
                ("candidate f".to_owned(), format!("{} of {count}", candidate.f)),
                ("**delay δ = q − p**".to_owned(), delay),
                (
                    "SSE of both lines".to_owned(),
                    with_unit(candidate.sse, self.joint.output_unit.as_deref(), "²"),
                ),
                ("slope before".to_owned(), slope(candidate.before.slope)),
                ("slope after".to_owned(), slope(candidate.after.slope)),
            ]);
        }
        rows.extend(decision.fine.map(|fine| self.interval(fine)));
        rows.extend(self.by_lines());
        rows.extend(self.trial.estimate.onset_model.as_deref().map(onset_row));
        rows.extend(self.trial.estimate.tracking.as_ref().map(tracking_row));
        rows.extend(self.how_near());
        let typical = |words: &str| ("median delay of the joint".to_owned(), words.to_owned());
        rows.extend(self.typical.map(typical));
        let rows: Vec<_> =
            rows.iter().map(|(name, value)| format!("| {name} | {value} |")).collect();
        format!("| quantity | value |\n|---|---|\n{}", rows.join("\n"))
    }

    /// Algorithm 1's delay, where the answer is an onset's.
    fn by_lines(&self) -> Option<(String, String)> {
        let decision = self.segment.decision;
        decision.onset.as_ref()?;
        let delay = decision.breakpoint()?.delay as f64;
        Some(("Algorithm 1's δ for comparison".to_owned(), self.delay(delay)))
    }

    /// The breakpoint as finely as it is known.
    fn breakpoint(&self, sample: usize) -> String {
        let decision = self.segment.decision;
        let Some((fine, place)) = decision.fine.zip(self.segment.place()) else {
            return self.at(sample);
        };
        let trial = self.trial.trial;
        let before = trial.time_s(decision.input_step.sample);
        let seconds = before + fine.delay * trial.period().seconds();
        format!("sample {place} = {seconds:.5} s")
    }

    fn interval(&self, fine: FineDelay) -> (String, String) {
        let FineDelay { low, high, confidence, .. } = fine;
        let samples = format!("{} … {} samples", number(low), number(high));
        let seconds = format!("{} … {}", self.delay(low), self.delay(high));
        (
            format!("{} % interval of δ", number(100.0 * confidence)),
            format!("{samples} = {seconds}"),
        )
    }

    /// What would have accepted the step, or by how much the second-best breakpoint is worse.
    fn how_near(&self) -> Option<(String, String)> {
        let decision = self.segment.decision;
        if decision.verdict() == Verdict::Accepted {
            let second = decision.runner_up().filter(|second| second.margin.is_finite())?;
            let (percent, q) = (number(100.0 * second.margin), second.breakpoint);
            let near = format!("q = {q}, with an SSE {percent} % above");
            return Some(("second-best breakpoint".to_owned(), near));
        }
        let remedies = decision.remedies(self.settings, self.trial.output());
        let remedies: Vec<_> = remedies.into_iter().map(|it| remedy_text(it, "`")).collect();
        Some(("would be accepted with".to_owned(), remedies.join(", ")))
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
            let unit = self.joint.output_unit.as_deref();
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
                (output("y = ", ""), self.settings.output_limits.map(between))
            }
            // Of a delay between samples the end of its interval counts.
            Condition::BeforeInput => {
                let of = if self.segment.decision.fine.is_some() { "at most " } else { "" };
                (said(&|q| format!("q = {of}{q}")), needed("≥ p ="))
            }
            Condition::SlopeChange => (output("", "/sample"), needed("≥")),
            Condition::ShortHold => (said(&|hold| format!("{hold} samples")), needed("≥")),
            Condition::Sse => (output("", "²"), needed("<")),
            Condition::TooShort => {
                let beta = self.settings.beta;
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

/// The response behind the dead times.
fn onset_row(model: &OnsetModel) -> (String, String) {
    let named = model.parameters();
    let named = named.iter().map(|(name, value)| format!(", {name} {}", number(*value)));
    let parameters: String = named.collect();
    let text = format!(
        "{}{parameters}; residual {} times the noise",
        model.shape(),
        number(model.misfit())
    );
    ("response behind the delay".to_owned(), text)
}

/// Where the output comes to rest.
fn tracking_row(tracking: &Tracking) -> (String, String) {
    let at = format!("{} + {}·u", number(tracking.offset()), number(tracking.gain()));
    ("output tracks the input, at rest".to_owned(), at)
}

fn with_unit(value: f64, unit: Option<&str>, per: &str) -> String {
    let value = number(value);
    unit.map_or_else(|| value.clone(), |unit| format!("{value} {unit}{per}"))
}
