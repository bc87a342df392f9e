//! The next experiment in words.

use super::TextTable;
use super::design::{Basis, DesignedJoint, Discrimination, kept_until_s, order};
use super::finding::levels_text;
use crate::design::{
    Expected, FreeRunError, OpenThreshold, Prediction, Rehearsal, Schedule, transitions,
};
use crate::wording::{effects_named, measure, range_text, rounded, wrapped};

/// What is to be played on each joint, and what is expected of it.
pub(crate) fn design_text(joints: &[DesignedJoint]) -> String {
    joints.iter().map(joint_text).collect::<Vec<_>>().join("\n\n") + "\n"
}

fn joint_text(joint: &DesignedJoint) -> String {
    let mut sentences = design_sentences(joint);
    let mut parts = vec![wrapped(&sentences.remove(0))];
    parts.extend(joint.discrimination.as_ref().map(|found| side_table(found).to_string()));
    if joint.basis.is_some() {
        let lines: Vec<String> = sentences.iter().map(|sentence| wrapped(sentence)).collect();
        parts.push(lines.join("\n"));
    } else if !sentences.is_empty() {
        parts.push(wrapped(&sentences.join(" ")));
    }
    parts.join("\n\n")
}

/// What is played, in the first sentence; what it distinguishes, where the joint will be, and what
/// whoever plays it should know.
pub(super) fn design_sentences(joint: &DesignedJoint) -> Vec<String> {
    let mut sentences = vec![headline(joint)];
    sentences.extend(joint.discrimination.iter().flat_map(|found| explanation(joint, found)));
    match (&joint.prediction, &joint.basis) {
        (Some(prediction), Some(basis)) => sentences.extend(promise(joint, prediction, basis)),
        (Some(prediction), None) => sentences.push(foreseen(joint, prediction)),
        (None, _) => {}
    }
    sentences.extend(joint.notes.iter().cloned());
    sentences
}

/// What is played, in a sentence.
fn headline(joint: &DesignedJoint) -> String {
    let DesignedJoint { rig, schedule, .. } = joint;
    let levels = levels_text(&schedule.levels(), rig.input_unit.as_deref());
    let (hold, steps) = (hold_text(schedule), schedule.steps());
    let duration = duration_text(schedule);
    let name = &rig.name;
    if let Some(Discrimination { ids: [one, other], design, .. }) = &joint.discrimination {
        if !design.explores.is_empty() {
            return format!(
                "{name}: an input of {duration} explores, before one distinguishes {one} from {other}: \
                 {levels}, each held for {hold}, {steps} steps."
            );
        }
        let order = order(design.order);
        return format!(
            "{name}: an input of {duration} distinguishes {one} from {other}: {order} of {levels}, each held for \
             {hold}, {steps} steps."
        );
    }
    let (least, most) = transitions(schedule);
    format!(
        "{name}: random steps of {levels}, each held for {hold}: {steps} steps in {duration}, from \
         each level to each other {least} to {most} times."
    )
}

/// How long it is, and in how many trials.
fn duration_text(schedule: &Schedule) -> String {
    let seconds = |schedule: &Schedule| measure(schedule.duration_s(), Some("s"));
    let trials = schedule.trials();
    match trials.as_slice() {
        [first, _, ..] => format!("{} trials of {}", trials.len(), seconds(first)),
        _ => seconds(schedule),
    }
}

fn hold_text(schedule: &Schedule) -> String {
    let (shortest, longest) = schedule.hold_range_s();
    let (shortest, longest) = (rounded(shortest), measure(longest, Some("s")));
    if longest.trim_end_matches(" s") == shortest {
        return longest;
    }
    format!("{shortest} to {longest}")
}

/// Header of [`side_rows`].
const SIDE_HEADER: [&str; 5] = ["if it is", "expected power", "rehearsed", "other", "neither"];

/// A row for each suspect: how surely it is identified where it is present.
fn side_rows(found: &Discrimination) -> [[String; 5]; 2] {
    let [one, other] = &found.design.sides;
    let [first, second] = found.ids;
    [(first, one), (second, other)].map(|(id, side)| {
        let Expected { rival, neither, .. } = side.expected;
        let power =
            if side.is_target { format!("{:.3}", side.expected.power()) } else { "-".into() };
        let rehearsed = side.rehearsal.map_or_else(
            || "-".to_owned(),
            |Rehearsal { successes, runs }| format!("{successes} of {runs} correct"),
        );
        let far = |noncentrality: f64| format!("λ = {}", rounded(noncentrality));
        let (rival, neither) = (far(rival.noncentrality()), far(neither.noncentrality()));
        [id.to_owned(), power, rehearsed, rival, neither]
    })
}

pub(super) fn side_table(found: &Discrimination) -> TextTable {
    TextTable::of(SIDE_HEADER, &[1, 2, 3, 4], side_rows(found))
}

/// What the figures are about.
fn explanation(joint: &DesignedJoint, found: &Discrimination) -> Vec<String> {
    let Discrimination { ids, design, wanted, noise, .. } = found;
    let noise = measure(*noise, joint.rig.output_unit.as_deref());
    let mut sentences = vec![format!(
        "Power: the probability that `explain` names the effect that the joint has and excludes \
         the other, with noise of {noise}; {wanted} was required. λ: squared distance to the best fit \
         with the other effect and with neither, in variances of the noise."
    )];
    for (index, side) in design.sides.iter().enumerate().filter(|(_, side)| !side.is_target) {
        let (is, other) = (ids.get(index), ids.get(1 - index));
        if let (Some(is), Some(other), true) = (is, other, side.is_excluded) {
            sentences.push(format!(
                "The log already contradicts {is}: the input is designed for the case that the \
                 joint has {other}."
            ));
        } else if let (Some(is), Some(other)) = (is, other) {
            let lambda = rounded(side.expected.rival.noncentrality());
            sentences.push(format!(
                "If the joint has {is}, {other} gives the same output (λ = {lambda}), so no input \
                 can exclude {other}."
            ));
        }
    }
    if !design.explores.is_empty() {
        let unit = joint.rig.input_unit.as_deref();
        let open = design.explores.iter().map(|OpenThreshold { effect, parameter, low, high }| {
            format!("{effect}.{parameter} from {} to {}", rounded(*low), measure(*high, unit))
        });
        sentences.push(format!(
            "No input passed its rehearsals, because the log does not show at which levels the \
             joint starts or stops: {}. This input finds these levels.",
            open.collect::<Vec<_>>().join(", ")
        ));
    }
    sentences
}

/// Where the joint will be, whichever suspect is there, and how sure that is.
fn foreseen(joint: &DesignedJoint, prediction: &Prediction) -> String {
    let unit = joint.rig.output_unit.as_deref();
    let expected = joint.expected();
    let ends = expected.iter().map(|(_, prediction)| prediction.extent());
    let within = range_text(ends.flat_map(|(low, high)| [low, high]), unit);
    let margins = expected.iter().map(|(_, prediction)| prediction.largest_margin());
    let margin = measure(margins.fold(0.0, f64::max), unit);
    let start = measure(joint.rig.start, unit);
    let from = format!(
        "From {start} the joint is expected within {within}, a margin of up to {margin} (two \
         standard deviations) included."
    );
    match (joint.rig.range, kept_until_s(joint, prediction)) {
        (Some(_), Some(until)) => {
            format!("{from} After {} the output may leave its range.", measure(until, Some("s")))
        }
        _ => from,
    }
}

/// Where random steps start, where the joint will be, and how sure that is.
fn promise(joint: &DesignedJoint, prediction: &Prediction, basis: &Basis) -> [String; 3] {
    let unit = joint.rig.output_unit.as_deref();
    let from_to = |(low, high): (f64, f64)| format!("{} to {}", rounded(low), measure(high, unit));
    let start = start_text(joint, basis);
    let alone = range_text(prediction.output.iter().copied(), unit);
    let expected = format!("{alone} expected, {} with the margin", from_to(prediction.extent()));
    let range = match joint.rig.range {
        Some(range) => {
            let known = basis.within.filter(|within| *within != range).map(|known| {
                let known = from_to(known);
                format!(" Only {known} is used, which is about the range of the log.")
            });
            format!("Range: {} is kept: {expected}.{}", from_to(range), known.unwrap_or_default())
        }
        None => format!("Output: {expected}."),
    };
    [start, range, margin_text(joint, prediction, basis)]
}

/// What is done before the input is played.
fn start_text(joint: &DesignedJoint, basis: &Basis) -> String {
    let start = measure(joint.rig.start, joint.rig.output_unit.as_deref());
    if basis.regulates_itself {
        let rest = measure(joint.rest, joint.rig.input_unit.as_deref());
        return format!("Start: hold the input at {rest} until the output settles, near {start}.");
    }
    let near = basis.start_tolerance.map_or_else(String::new, |tolerance| {
        format!(", to within {}", measure(tolerance, joint.rig.output_unit.as_deref()))
    });
    match joint.schedule.trial_count() {
        1 if near.is_empty() => format!("Start: bring it to {start} and let it rest."),
        1 => format!("Start: bring it to {start}{near}, and let it rest."),
        trials => format!(
            "Start: before each of the {trials} trials drive it back to {start}{near}, by hand or by \
             its position controller, and let it rest."
        ),
    }
}

/// How large the margin is, and where it comes from.
fn margin_text(
    joint: &DesignedJoint,
    prediction: &Prediction,
    Basis { effects, free_run, .. }: &Basis,
) -> String {
    let unit = joint.rig.output_unit.as_deref();
    let is_bounded = free_run.as_ref().is_some_and(FreeRunError::is_bounded);
    let model = effects_named(effects);
    let margin = measure(prediction.largest_margin(), unit);
    let Some(free_run) = free_run else {
        return format!(
            "Margin: up to {margin}: two standard deviations of the prediction, from the \
             uncertainty of the parameters (--uncertainty) of the model, {model}."
        );
    };
    let (largest, longest) = (measure(free_run.largest(), unit), free_run.longest_s());
    let beyond = if is_bounded { "no more" } else { "in proportion" };
    let within = if joint.schedule.trial_count() > 1 { " within a trial" } else { "" };
    format!(
        "Margin: grows to {margin}{within}. It is {} times the largest error of the model, \
         {model}, on parts of the log that were left out of its fit: {largest} within {}, and \
         {beyond} beyond.",
        rounded(free_run.reserve()),
        measure(longest, Some("s"))
    )
}

/// Why holds may be too short.
pub(crate) fn hold_note(shortest_s: f64, response_s: f64) -> String {
    format!(
        "Holds from {shortest_s} s are shorter than the {response_s:.2} s in which the model \
         responds: a level may end before the output shows it."
    )
}

/// Which levels a wider range would allow.
pub(crate) fn left_out_note(levels: &[f64], unit: Option<&str>) -> String {
    let levels = levels_text(levels, unit);
    format!("Levels: the range is too narrow for {levels}, which the log has.")
}

/// Why the input is no longer.
pub(crate) fn shortened_note(schedule: &Schedule, usual_s: f64) -> String {
    let duration_s = schedule.duration_s();
    if schedule.trial_count() > 1 {
        return format!(
            "Length: {duration_s:.0} s instead of {usual_s:.0} s, since the trials are short. For \
             more data, apply another input (--seed 2), or give --duration {usual_s:.0}."
        );
    }
    format!(
        "Length: {duration_s:.0} s instead of {usual_s:.0} s, since it is not certain that the \
         range is kept for longer. For more data, go back to the start and apply another input \
         (--seed 2)."
    )
}

/// Why there are several trials.
pub(crate) fn trials_note(trials: usize) -> String {
    format!(
        "Trials: the error of a prediction accumulates, so it is not certain that one input of \
         this length keeps the range. Each of the {trials} trials begins at the start again; \
         --trials 1 makes one input, as long as the range allows."
    )
}

/// That nothing was said of where the joint may go.
pub(crate) fn no_range_note() -> String {
    "No range is kept: --output-range LO,HI says where the joint may go.".to_owned()
}
