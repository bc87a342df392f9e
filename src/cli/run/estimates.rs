//! Delays of joints: those that have one, and what is said of them.

use crate::cli::failure::{read_failures, said};
use crate::delay::{Condition, Decision, EstimateError, Verdict};
use crate::experiment::{Experiment, Joint, Trial, coarse_resolution, saturations, spike_count};
use crate::numerics::{quantile, to_digits};
use crate::report::EstimatedJoint;
use crate::report::answer::input_note;
use crate::study::JointEstimate;
use crate::wording::percent;

/// The delays of each joint.
pub(crate) type Estimates = Vec<Result<JointEstimate, EstimateError>>;

/// The joints that have an estimate, in the order of the log.
pub(crate) fn estimated<'a>(
    experiment: &'a Experiment,
    results: &'a Estimates,
) -> Vec<EstimatedJoint<'a>> {
    let joints = experiment.joints.iter().zip(results);
    let estimated = joints.filter_map(|(joint, result)| Some((joint, result.as_ref().ok()?)));
    estimated.map(|(joint, estimate)| EstimatedJoint { joint, estimate }).collect()
}

/// A message on each file, joint and trial that failed.
pub(crate) fn failures(experiment: &Experiment, results: &Estimates) -> Vec<String> {
    // With several files a trial's name says which one it is from.
    let file = match experiment.sources.as_slice() {
        [source] => format!("{}: ", source.path.display()),
        _ => String::new(),
    };
    let joints = experiment.joints.iter().zip(results);
    let unestimated = joints.flat_map(|(joint, result)| {
        let name = &joint.name;
        let whole = result.as_ref().err();
        let whole = whole.map(|e| format!("joint `{name}` is left out: {file}{}", said(e)));
        let parts = result.iter().flat_map(JointEstimate::failed);
        let part = |error: &EstimateError| {
            let why = said(error);
            format!("joint `{name}`, one trial is left out: {file}{why}")
        };
        whole.into_iter().chain(parts.map(part)).collect::<Vec<_>>()
    });
    read_failures(experiment).into_iter().chain(unestimated).collect()
}

/// What a person should know who looks at the numbers.
pub(crate) fn notes(joints: &[EstimatedJoint<'_>]) -> Vec<String> {
    let of_joint = |estimated: &EstimatedJoint<'_>| {
        let name = &estimated.joint.name;
        let notes = notes_on(*estimated).into_iter().map(|note| format!("joint `{name}`: {note}"));
        notes.chain(input_note(estimated)).collect::<Vec<_>>()
    };
    joints.iter().flat_map(of_joint).collect()
}

/// What a person should know of one joint.
fn notes_on(estimated: EstimatedJoint<'_>) -> Vec<String> {
    let EstimatedJoint { joint, estimate } = estimated;
    let mut notes: Vec<String> = estimated.warnings().into_iter().map(|it| it.text).collect();
    // What is said of two lines is not said of an onset.
    if estimate.dead_time.is_none() && !estimate.settings.method.spec().has_intervals {
        notes.extend(unsmoothed(joint, estimate));
    }
    if estimate.dead_time.is_none() {
        notes.extend(as_long_as_allowed(joint, estimate));
        notes.extend(notes_on_sensor(joint, estimate));
    }
    let mut verdicts = decisions(estimate).map(Decision::verdict).peekable();
    let is_end = |verdict| verdict == Verdict::Rejected(Condition::FirstOrLast);
    if verdicts.peek().is_some() && verdicts.all(is_end) {
        let ends = "every step is the first or the last of its trial; `--keep-first-last` judges them like \
                    the others";
        notes.push(ends.to_owned());
    }
    notes
}

fn decisions(estimate: &JointEstimate) -> impl Iterator<Item = &Decision> {
    estimate.estimated().flat_map(|trial| &trial.decisions)
}

/// A line on delays that `--max-delay` may have cut short.
fn as_long_as_allowed(joint: &Joint, estimate: &JointEstimate) -> Option<String> {
    /// Part of the accepted delays, at least; fewer are chance.
    const PART: f64 = 0.1;
    let settings = estimate.settings.in_samples(&joint.trials);
    let longest = settings.max_delay? as f64;
    let delays: Vec<f64> = accepted(estimate).filter_map(Decision::delay).collect();
    let near = if settings.method.spec().has_intervals { 1.0 } else { settings.beta as f64 };
    let bounded = delays.iter().filter(|delay| **delay > longest - near).count();
    (bounded > 0 && bounded as f64 >= PART * delays.len() as f64).then(|| {
        format!(
            "{bounded} of {} delays are as long as `--max-delay` allows, so the reactions may \
             come later: increase `--max-delay`",
            delays.len()
        )
    })
}

fn accepted(estimate: &JointEstimate) -> impl Iterator<Item = &Decision> {
    decisions(estimate).filter(|decision| decision.verdict() == Verdict::Accepted)
}

/// A line on the trials that are sampled too slowly for the low-pass.
fn unsmoothed(joint: &Joint, estimate: &JointEstimate) -> Option<String> {
    let low_pass = estimate.settings.low_pass?;
    let is_slow = |trial: &&Trial| estimate.settings.low_pass_at(trial.period()).is_none();
    let slow = joint.trials.iter().filter(is_slow).count();
    let (all, hz) = (joint.trials.len(), low_pass.cutoff_hz);
    let whose = if slow == all { String::new() } else { format!(" at {slow} of {all} trials") };
    (slow > 0).then(|| {
        format!(
            "the {hz} Hz low-pass is not applied{whose}, since the log has no more than {} \
             samples per second",
            2.0 * hz
        )
    })
}

/// A line on each limit of its sensors, and of its logger, that shows in the delays of a joint.
fn notes_on_sensor(joint: &Joint, estimate: &JointEstimate) -> Vec<String> {
    let far = [("input", Trial::input as fn(&Trial) -> &[f64]), ("output", Trial::output)];
    let far = far.into_iter().filter_map(|(what, of)| far_off(joint, what, of));
    let limits = [spikes(joint, estimate), saturated(joint), coarse(joint)];
    far.chain(limits.into_iter().flatten()).collect()
}

/// A line on a signal that is now and then so far off that a number may stand for none, as −999.
fn far_off(joint: &Joint, what: &str, of: fn(&Trial) -> &[f64]) -> Option<String> {
    /// Times the range in which nine of ten samples are, and the part of the samples, at most (chosen).
    const TIMES: f64 = 50.0;
    const SELDOM: f64 = 0.05;
    /// Samples that are enough to know the range.
    const ENOUGH: usize = 10_000;
    let all = || joint.trials.iter().flat_map(of).copied();
    let count: usize = joint.trials.iter().map(Trial::len).sum();
    // An odd step keeps away from the periods of most inputs.
    let some: Vec<f64> = all().step_by((count / ENOUGH) | 1).collect();
    let [low, high] = [quantile(&some, 0.05)?, quantile(&some, 0.95)?];
    let room = TIMES * (high - low);
    let far: Vec<f64> = all().filter(|value| !(low - room..=high + room).contains(value)).collect();
    let share = far.len() as f64 / count as f64;
    (high > low && !far.is_empty() && share <= SELDOM).then(|| {
        format!(
            "the {what} goes to {} in {} of {count} samples, far beyond its usual range of {} to \
             {}: if such a number marks missing values, leave these cells empty",
            to_digits(far[0], 4),
            far.len(),
            to_digits(low, 3),
            to_digits(high, 3)
        )
    })
}

/// A line on isolated spikes of the sensor, where they do not count.
fn spikes(joint: &Joint, estimate: &JointEstimate) -> Option<String> {
    let count = !(estimate.settings.paper || estimate.settings.grows);
    let spikes = Some(joint).filter(|_| count).and_then(spikes_of)?;
    Some(format!("{spikes}: interpolated for delays, excluded from fits and errors of models"))
}

/// That there are isolated spikes in the output of a joint, where there are any.
pub(super) fn spikes_of(joint: &Joint) -> Option<String> {
    match joint.trials.iter().map(spike_count).sum::<usize>() {
        0 => None,
        1 => Some("1 sample is an isolated spike of the sensor".to_owned()),
        count => Some(format!("{count} samples are isolated spikes of the sensor")),
    }
}

/// A line on an output that stands at the end of its sensor's range.
fn saturated(joint: &Joint) -> Option<String> {
    let ends: Vec<String> = saturations(&joint.trials)
        .into_iter()
        .map(|end| format!("{} in {} of the samples", to_digits(end.at, 6), percent(end.share)))
        .collect();
    (!ends.is_empty()).then(|| {
        format!(
            "the output stays exactly, without noise, at {}: the sensor or its converter \
             saturates there. Motion beyond is not measured, and the delay of a step there is the \
             time until the output leaves saturation",
            ends.join(" and at ")
        )
    })
}

/// A line on an output whose counts are far apart in time.
fn coarse(joint: &Joint) -> Option<String> {
    let found = coarse_resolution(&joint.trials)?;
    let unit = joint.output_unit.as_deref().map_or_else(String::new, |unit| format!(" {unit}"));
    Some(format!(
        "the resolution of the output is {}{unit}, one count every {} s at its usual speed: a \
         reaction may be seen that much late, so delays are no more accurate than that. Use a \
         finer sensor or larger input steps",
        to_digits(found.count, 4),
        to_digits(found.between_s, 2)
    ))
}
