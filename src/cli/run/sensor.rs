//! What is said of the sensors and the logger that measured a joint.

use crate::experiment::{Joint, Trial, coarse_resolution, saturations, spike_count};
use crate::numerics::{quantile, to_digits};
use crate::study::JointEstimate;
use crate::wording::percent;

/// A line on each limit of its sensors, and of its logger, that shows in the delays of a joint.
pub(super) fn notes_on_sensor(joint: &Joint, estimate: &JointEstimate) -> Vec<String> {
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
    Some(format!("{spikes}: interpolated where delays are estimated"))
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
            "the output stands, without noise, at {}: the range of the sensor or its converter \
             ends there; what the joint does beyond is not seen, and the delay of a step there is how late the \
             output comes back",
            ends.join(" and at ")
        )
    })
}

/// A line on an output whose counts are far apart in time.
fn coarse(joint: &Joint) -> Option<String> {
    let found = coarse_resolution(&joint.trials)?;
    let unit = joint.output_unit.as_deref().map_or_else(String::new, |unit| format!(" {unit}"));
    Some(format!(
        "the resolution of the output is {}{unit}, a count every {} s at its usual speed: a \
         reaction is seen up to that much late, and delays are no more accurate than that; a finer sensor, \
         or larger steps of the input, resolve them better",
        to_digits(found.count, 4),
        to_digits(found.between_s, 2)
    ))
}
