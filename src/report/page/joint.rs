//! What is said of one joint; single decisions: the segment with both lines, and the error of every
//! candidate.

use std::collections::HashSet;

use super::delays::{dead_time_blocks, record_figure};
use super::document::{Block, Figure, NARROW, Report};
use super::{delays, model};
use crate::delay::{AgainstState, Condition, DelayTable, Verdict};
use crate::experiment::Joint;
use crate::figure::segment::{Scale, SegmentFigure};
use crate::report::answer::{delay_answer, doubtful_count};
use crate::report::decisions::{by_doubt, decision_names, decision_text, doubted, step_line};
use crate::report::delays::{
    AGAINST_HEADER, CORRECTED, against_rows, confounded_sentences, levels_text, neutral_sentence,
};
use crate::report::difference::difference_table;
use crate::report::estimate::{onset_line, tracking_line};
use crate::report::facts::Place;
use crate::report::review::{ReviewCount, reviewed_table};
use crate::report::{Doubted, EstimatedJoint, JointSummary, TextTable};
use crate::wording::{capitalized, difference_sentences};

/// Rows of a table that a reader may still want to scroll through.
const MOST_ROWS: usize = 2000;

/// All that is said of a joint, but for its [`sentences`], which stand at the head of the page.
pub(super) fn blocks(report: &Report<'_>, estimated: EstimatedJoint<'_>) -> Vec<Block> {
    let mut blocks = vec![Block::Figures(vec![record_figure(estimated)])];
    // Where there is a model, the delays are what it is made from.
    if let Some(improved) = report.model_of(estimated.joint) {
        blocks.extend(model::blocks(improved));
    }
    blocks.extend(dead_time_blocks(estimated));
    let segments = segment_figures(estimated);
    if !segments.is_empty() {
        blocks.push(Block::part("Single decisions"));
        blocks.push(Block::Figures(segments));
    }
    blocks.extend(differing(report, estimated));
    blocks.extend(doubtful(estimated));
    blocks.extend(part_with_table("Reviewed by a person", reviewed_table(estimated)));
    let found = estimated.delay_table();
    blocks.extend(delay_blocks(estimated));
    if !found.rows.is_empty() {
        blocks.extend(level_blocks(estimated, &found));
    }
    blocks.extend(rejections(estimated));
    if estimated.estimate.dead_time.is_none() {
        blocks.push(decisions(estimated));
    }
    blocks
}

/// Model, delays and decisions of a joint, in a sentence each.
pub(super) fn sentences(report: &Report<'_>, estimated: EstimatedJoint<'_>) -> String {
    let model = report.model_of(estimated.joint).map(model::sentence);
    let reviewed = ReviewCount::on(estimated).map(|count| format!("{}.", count.sentence()));
    let mut sentences: Vec<String> = model.into_iter().chain([delay_answer(estimated)]).collect();
    if estimated.obstacle().is_some() {
        // A model of columns that do not belong together says nothing.
        sentences.reverse();
    }
    sentences.extend(doubtful_count(estimated).into_iter().chain(reviewed));
    sentences.join(" ")
}

/// `words` with a capital letter and a full stop.
fn sentence(words: &str) -> String {
    format!("{}.", capitalized(words))
}

/// Figures and table of the delays.
fn delay_blocks(estimated: EstimatedJoint<'_>) -> Vec<Block> {
    let Some(figure) = delays::over_time(estimated) else { return Vec::new() };
    let found = estimated.against_state();
    let mut blocks = vec![Block::part("Delay")];
    blocks.extend(onset_line(&estimated).map(|line| Block::text(line.trim_end())));
    blocks.extend(tracking_line(&estimated).map(|line| Block::text(line.trim_end())));
    blocks.push(Block::Figures(vec![figure]));
    let note = format!("{CORRECTED}: the delay depends on a quantity where p is at most 0.05.");
    blocks.push(Block::text(note));
    blocks.push(Block::Figures(delays::against(&estimated.joint.name, &found)));
    let table = Block::Table(against(&estimated.joint.name, &found));
    let mut details = vec![table];
    let confounded = confounded_sentences(&found);
    if !confounded.is_empty() {
        details.push(Block::List(confounded.iter().map(|one| sentence(one)).collect()));
    }
    blocks.push(Block::details("What the delay depends on", details));
    blocks
}

/// The delays by kind of step and level.
fn level_blocks(estimated: EstimatedJoint<'_>, found: &DelayTable) -> Vec<Block> {
    let unit = estimated.joint.input_unit.as_deref();
    let figure = delays::over_levels(estimated, found);
    let mut blocks = vec![
        Block::part("Delay by kind of step"),
        Block::text(sentence(&neutral_sentence(found, unit))),
        Block::List(estimated.kind_sentences(&found.kinds)),
    ];
    blocks.extend(figure.map(|figure| Block::Figures(vec![figure])));
    let rows = found.rows.iter().map(|row| (estimated.joint.name.as_str(), row));
    blocks.push(Block::Table(levels_text(Place::Terminal, rows)));
    blocks
}

/// A row per variable.
fn against(joint: &str, found: &AgainstState) -> TextTable {
    let [_, header @ ..] = AGAINST_HEADER;
    let rows = against_rows(joint, found).into_iter();
    TextTable::of(header, &[3, 4], rows.map(|[_, cells @ ..]| cells))
}

/// The decisions that a person looks at first, and what was said of those.
fn doubtful(estimated: EstimatedJoint<'_>) -> Vec<Block> {
    /// Decisions in the table.
    const MOST: usize = 10;
    let ranked = by_doubt(&[estimated]).into_iter();
    let doubted = ranked.filter(|found| found.doubt.value() > 0.0).take(MOST);
    let table = decision_text(Place::Doubtful, Some(estimated.joint), doubted);
    part_with_table("Most doubtful decisions", table)
}

/// Where the decisions differ from those of other results.
fn differing(report: &Report<'_>, estimated: EstimatedJoint<'_>) -> Vec<Block> {
    /// Decisions in a table.
    const MOST: usize = 10;
    let mut blocks = Vec::new();
    for against in report.against {
        let name = &estimated.joint.name;
        let of_joint = against.joints.iter().find(|(joint, _)| joint == name);
        let Some((_, found)) = of_joint else { continue };
        blocks.push(Block::part(format!("Against {}", against.title())));
        let sentences = difference_sentences(found);
        blocks.push(Block::List(sentences.iter().map(|words| sentence(words)).collect()));
        let table = difference_table([(name.as_str(), found)].into_iter(), MOST);
        if !table.rows.is_empty() {
            blocks.push(Block::Table(table));
        }
    }
    blocks
}

/// A table under a heading; nothing where it has no rows.
fn part_with_table(heading: &str, table: TextTable) -> Vec<Block> {
    if table.rows.is_empty() {
        return Vec::new();
    }
    vec![Block::part(heading), Block::Table(table)]
}

/// How many steps were rejected for which reason.
fn rejections(estimated: EstimatedJoint<'_>) -> Vec<Block> {
    let header = ["rejected as", "steps", "meaning", "what the condition asks"];
    let row = |(condition, count): (Condition, usize)| {
        let [meaning, asks] = [condition.meaning(), condition.asks()].map(str::to_owned);
        [condition.to_string(), count.to_string(), meaning, asks]
    };
    let rows = JointSummary::of(estimated).rejected.into_iter().map(row);
    part_with_table("Rejected steps", TextTable::of(header, &[1], rows))
}

/// All decisions, numbers to five digits.
fn decisions(estimated: EstimatedJoint<'_>) -> Block {
    let all = estimated.decisions().count();
    let names = decision_names(Place::Report);
    let mut blocks =
        vec![Block::text(format!("Sample numbers count from 1 within the trial. {names}."))];
    if all > MOST_ROWS {
        blocks.push(Block::text(format!(
            "These are the first {MOST_ROWS} of {all}; `tauscope estimate --decisions FILE.csv` \
             writes them all."
        )));
    }
    let rows = doubted(estimated).take(MOST_ROWS);
    blocks.push(Block::Table(decision_text(Place::Report, Some(estimated.joint), rows)));
    Block::details(format!("All {all} decisions"), blocks)
}

/// A decision that is worth a look, and why.
struct Choice<'a> {
    why: &'static str,
    found: Doubted<'a>,
}

/// The best, a typical and the most doubtful of the accepted decisions, and a rejected one.
fn segment_figures(estimated: EstimatedJoint<'_>) -> Vec<Figure> {
    let choices = choices(estimated);
    choices.iter().map(|choice| choice.figure(estimated.joint)).collect()
}

fn choices(estimated: EstimatedJoint<'_>) -> Vec<Choice<'_>> {
    let has_breakpoint = |found: &Doubted<'_>| found.decision.breakpoint().is_some();
    let (accepted, others): (Vec<_>, Vec<_>) =
        doubted(estimated).partition(|found| found.decision.accepted_delay().is_some());
    let mut accepted: Vec<_> = accepted.into_iter().filter(has_breakpoint).collect();
    accepted.sort_by(|a, b| unclear(a).total_cmp(&unclear(b)));
    let last = accepted.len().saturating_sub(1);
    // What is odd is never clear, however well it is known.
    let clearest = accepted.iter().position(|found| found.doubt.flags.is_empty());
    let clearest = clearest.map_or((0, "Best known"), |place| (place, "Clearest"));
    let doubt = |place: &usize| accepted.get(*place).map_or(0.0, |found| found.doubt.value());
    let most = (0..accepted.len()).max_by(|a, b| doubt(a).total_cmp(&doubt(b)));
    let mut places = vec![clearest, (last / 2, "Typical"), (most.unwrap_or(0), "Most doubtful")];
    let mut seen = HashSet::new();
    places.retain(|(place, _)| seen.insert(*place));
    let choice = |(place, why): (usize, &'static str)| {
        accepted.get(place).map(|found| Choice { why, found: found.clone() })
    };
    let rejected = others.into_iter().find(is_telling);
    let rejected = rejected.map(|found| Choice { why: "Rejected", found });
    places.into_iter().filter_map(choice).chain(rejected).collect()
}

/// How little is known of the delay of a decision: the width of its interval, without one its doubt.
fn unclear(found: &Doubted<'_>) -> f64 {
    found.decision.fine.map_or_else(|| found.doubt.value(), |fine| fine.high - fine.low)
}

/// Whether a rejected decision says something: the first and the last step of a trial are never
/// judged.
fn is_telling(found: &Doubted<'_>) -> bool {
    match found.decision.verdict() {
        Verdict::Accepted | Verdict::Rejected(Condition::FirstOrLast) => false,
        Verdict::Rejected(_) => found.decision.breakpoint().is_some(),
    }
}

impl Choice<'_> {
    fn figure(&self, joint: &Joint) -> Figure {
        let Doubted { trial, decision, smoothed, .. } = &self.found;
        let unit = joint.output_unit.as_deref();
        let drawn = SegmentFigure::new((trial, unit), *smoothed, decision, Scale::time(trial));
        let panels = vec![drawn.output(), drawn.errors()];
        let number = self.found.decision.number;
        let name = format!("{} step of {}: number {number}", self.why, joint.name);
        let (why, step) = (self.why, step_line(joint, trial, decision));
        let by = decision.reviewer_verdict.as_ref().map_or("", |_| " (reviewed by a person)");
        Figure { name, width: NARROW, panels, caption: format!("{why}: {step}{by}.") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::Threads;
    use crate::delay::{FirstLast, Method, Settings};
    use crate::experiment::Trial;
    use crate::study::estimate_joints;
    use crate::units::SamplePeriod;

    /// Steps of a joint whose noise grows with the time.
    fn joint() -> Joint {
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        let input: Vec<f64> = (0..600).map(|k| f64::from((k / 100) % 2)).collect();
        let (mut angle, mut output) = (0.0, Vec::new());
        for k in 0..600_u32 {
            angle += f64::from((k.saturating_sub(12) / 100) % 2) - 0.5;
            let noise = f64::from(k.wrapping_mul(2_654_435_761) >> 22) / 1024.0 - 0.5;
            output.push(angle + 0.004 * f64::from(k) * noise);
        }
        let trial = Trial::new("t", 0.0, period, input, output).unwrap();
        let name = "boom".to_owned();
        let (input_unit, output_unit) = (None, None);
        Joint { name, input_unit, output_unit, covariates: Vec::new(), trials: [trial].into() }
    }

    fn chosen(settings: &Settings) -> Vec<(&'static str, usize)> {
        let joint = joint();
        let estimate = estimate_joints(std::slice::from_ref(&joint), settings, || (), &Threads);
        let estimate = estimate.into_iter().next().unwrap().unwrap();
        let estimated = EstimatedJoint { joint: &joint, estimate: &estimate };
        let choices = choices(estimated);
        choices.iter().map(|choice| (choice.why, choice.found.decision.number)).collect()
    }

    #[test]
    fn the_clearest_decision_is_where_the_noise_is_least() {
        let settings = Settings {
            low_pass: None,
            first_last: FirstLast::Keep,
            ..Settings::of(Method::TWO_LINE)
        };
        let chosen = chosen(&settings);
        assert_eq!(chosen, [("Clearest", 1), ("Typical", 3), ("Most doubtful", 5)]);
    }

    #[test]
    fn where_there_are_intervals_the_narrowest_is_the_clearest() {
        let settings = Settings { first_last: FirstLast::Keep, ..Settings::of(Method::AUTO) };
        let joint = joint();
        let estimate = estimate_joints(std::slice::from_ref(&joint), &settings, || (), &Threads);
        let estimate = estimate.into_iter().next().unwrap().unwrap();
        let estimated = EstimatedJoint { joint: &joint, estimate: &estimate };
        let width = |found: &Doubted<'_>| found.decision.fine.map(|fine| fine.high - fine.low);
        let clear = doubted(estimated).filter(|found| found.decision.accepted_delay().is_some());
        let clear = clear.filter(|found| found.doubt.flags.is_empty());
        let narrowest = clear.filter_map(|found| width(&found)).fold(f64::INFINITY, f64::min);
        let choices = choices(estimated);
        let clearest = choices.iter().find(|choice| choice.why == "Clearest").unwrap();
        assert_eq!(width(&clearest.found), Some(narrowest));
    }

    #[test]
    fn a_rejected_decision_is_shown_where_one_says_something() {
        let settings = Settings { low_pass: None, ..Settings::of(Method::TWO_LINE) };
        assert!(chosen(&settings).iter().all(|(why, _)| *why != "Rejected"), "ends are not judged");
        let settings = Settings { min_delay: 1000, ..settings };
        assert_eq!(chosen(&settings), [("Rejected", 2)]);
    }
}
