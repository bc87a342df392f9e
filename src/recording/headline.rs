//! What was found, what is doubtful, what to do next, in strips above the pages of a joint: one on its
//! delays above the decisions, one on its model above the revisions; and where the cursor is, a line above
//! plots that do not say it themselves.

use super::chunk::{Chunks, Index};
use super::error::RecordError;
use super::layout::{JointLayout, SegmentLayout, TrialLayout};
use super::markdown::{plain, prose};
use super::paths;
use crate::experiment::Source;
use crate::explain::Verdict;
use crate::report::ImprovedJoint;
use crate::report::answer::{delay_answer, doubtful_count};
use crate::report::conclusion::Topic;
use crate::wording::{capitalized, to_place};

/// Adds `/headline`, and of a model `/revision/headline`.
pub(super) fn add(
    chunks: &mut Chunks,
    layout: &JointLayout<'_>,
    sources: &[Source],
    improved: Option<&ImprovedJoint<'_>>,
) -> Result<(), RecordError> {
    chunks.page(paths::HEADLINE, on_delays(layout, sources, improved))?;
    improved.map_or(Ok(()), |improved| {
        chunks.page(paths::REVISION_HEADLINE, on_model(layout, improved))
    })
}

/// What the delays are, what speaks against them, and how to correct them; where none is doubtful, what
/// follows.
fn on_delays(
    layout: &JointLayout<'_>,
    sources: &[Source],
    improved: Option<&ImprovedJoint<'_>>,
) -> String {
    let estimated = layout.estimated;
    let name = plain(&estimated.joint.name);
    let answer = format!("**{name}: {}**", prose(&delay_answer(estimated)));
    // What to do about a warning is in the report and on the terminal.
    let warnings = estimated.warnings().into_iter();
    let mut sentences: Vec<String> =
        warnings.map(|warning| format!("⚠ {}.", prose(&capitalized(&warning.short)))).collect();
    let log = match sources {
        [source] => source.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        _ => "LOG".to_owned(),
    };
    let quoted = |word: &str| shlex::try_quote(word).map_or_else(|_| word.to_owned(), Into::into);
    let data = format!("{} --joint {}", quoted(&log), quoted(&estimated.joint.name));
    let next = match doubtful_count(estimated) {
        _ if estimated.obstacle().is_some() => {
            format!("What the columns are taken for: `tauscope columns {}`", quoted(&log))
        }
        Some(doubtful) => {
            format!(
                "{doubtful} To correct them: `tauscope estimate {data} --review-sheet review.csv`"
            )
        }
        None if improved.is_some() => "No decision is doubtful.".to_owned(),
        None => {
            format!("No decision is doubtful. What a model lacks: `tauscope improve {data}`")
        }
    };
    sentences.push(next);
    format!("{answer}  \n{}", sentences.join(" "))
}

/// What the model explains and what remains, then the delays in short, and what to do next.
fn on_model(layout: &JointLayout<'_>, improved: &ImprovedJoint<'_>) -> String {
    let conclusion = improved.conclusion();
    let mut sentences = vec![prose(&delay_answer(layout.estimated))];
    sentences.extend(
        doubtful_count(layout.estimated).map(|doubtful| format!("{doubtful} See *Decisions*.")),
    );
    let next = conclusion.passages.iter().find(|passage| passage.topic == Topic::NEXT);
    sentences.extend(match (conclusion.commands.first(), next, improved.finding.verdict) {
        (Some(add), ..) => Some(format!("To add it: `{add}`")),
        (None, Some(next), _) => Some(prose(&next.text())),
        (None, None, Verdict::Adequate) => {
            Some("To check it on another log: `tauscope compare LOG --model MODEL.toml`".to_owned())
        }
        (None, None, _) => Some(
            "The second tab above the drawing shows where the remaining error arises.".to_owned(),
        ),
    });
    format!("**{}.**  \n{}", prose(&conclusion.headline), sentences.join(" "))
}

/// Adds `/place`.
pub(super) fn add_place(chunks: &mut Chunks, layout: &JointLayout<'_>) -> Result<(), RecordError> {
    let mut steps = layout.segments().peekable();
    // The first row of all: a viewer that knows a timeline begins at its first tick, and chooses
    // among those that it knows.
    let (opening, start) = match steps.peek() {
        None => (WITHOUT_STEPS, WITHOUT_STEPS),
        Some(_) if layout.first.is_compared => (OPENING_COMPARED, BEFORE),
        Some(_) => (OPENING, BEFORE),
    };
    chunks.pages(paths::PLACE, Index::before_all(layout.first), [opening.to_owned()])?;
    let start = layout.start().map(|moment| (moment, start.to_owned()));
    let steps = steps
        .map(|(trial, segment)| (trial.opening(segment), place_in_words(layout, trial, segment)));
    let (moments, texts): (Vec<_>, Vec<_>) = start.into_iter().chain(steps).unzip();
    let index = moments.into_iter().collect::<Index>().without_segment();
    chunks.pages(paths::PLACE, index, texts)?;
    chunks.pages(paths::PLACE, Index::off_the_record(layout.first), [HINT.to_owned()])
}

const BEFORE: &str = "before the first step";

const OPENING: &str = "**The most doubtful decision**: the right arrow goes through its candidates, \
then on to the first step.";

const WITHOUT_STEPS: &str = "**No steps**: what is found of the whole record is on the right.";

const OPENING_COMPARED: &str = "**The most different decision**: on `decision` the right arrow \
goes through its candidates, then on to the first step.";

const HINT: &str = "**The whole record is drawn below.** To move along it choose `sample`, `time` or \
`decision` at the bottom left, and the tab *Along …*.";

/// A timeline of candidates stretches the record.
const AXIS: &str = "*`decision` counts candidates: choose `time` for an axis in seconds*";

/// The step, with its place in the trial and, where that is another one, in the recording.
fn place_in_words(
    layout: &JointLayout<'_>,
    trial: &TrialLayout<'_>,
    segment: &SegmentLayout<'_>,
) -> String {
    let decision = segment.decision;
    let p = decision.input_step.sample;
    let seconds = |s: f64| to_place(s, 3);
    let of = trial.segments.len();
    let in_trial = format!(
        "**step {} of {of}**: p = sample {p} at {} s",
        decision.number,
        seconds(trial.trial.time_s(p))
    );
    if layout.trials.len() < 2 {
        return format!("{in_trial} · {AXIS}");
    }
    format!(
        "{}, {in_trial} **of the trial** · {} at {} s **of all trials in a row**, as in the plots · \
         {AXIS}",
        plain(trial.trial.label()),
        trial.sample(p),
        seconds(trial.seconds(p))
    )
}
