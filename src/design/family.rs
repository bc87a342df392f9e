//! Inputs that may separate two suspects, each as long as the joint stays in its range.

use super::limits::Limits;
use super::predict::TestRig;
use super::random::{RandomSteps, random_steps};
use super::response::response_s;
use super::result::Order;
use super::schedule::{Hold, Schedule, samples_in};
use super::suspects::Suspects;
use crate::explain::{Pattern, level_sets, thresholds, two_digits};

/// An input that is tried, as long as it may become.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Family {
    pub(super) order: Order,
    pub(super) schedule: Schedule,
}

/// Shortest hold in which the noise of a joint is seen: it is looked for after what may be a
/// transient, in runs of some samples.
fn shortest_hold_s(period_s: f64) -> f64 {
    const TRANSIENT_S: f64 = 0.3;
    const RUN_SAMPLES: f64 = 25.0;
    TRANSIENT_S + RUN_SAMPLES * period_s
}

/// All inputs that are tried.
pub(super) fn families(suspects: &Suspects, rig: &TestRig, limits: &Limits) -> Vec<Family> {
    let holds = holds_s(suspects, rig, limits);
    let mut families = Vec::new();
    for (levels, patterns) in sets(suspects, limits.largest) {
        for (pattern, hold_s) in patterns.iter().flat_map(|p| holds.iter().map(|h| (*p, *h))) {
            let holds = repeated(pattern, &levels, hold_s, rig, limits.longest_s);
            families.push((Order::Pattern(pattern), Schedule::new(rig.period, holds)));
        }
    }
    families.extend(random(suspects, rig, limits, &holds));
    let kept = families.into_iter().filter_map(|(order, schedule)| {
        let count = kept(&schedule, suspects, rig);
        (count > 2).then(|| Family { order, schedule: schedule.first(count) })
    });
    kept.collect()
}

/// Holds that are worth a trial: from the time in which the joint responds to that in which a
/// fit starts anew.
pub(super) fn holds_s(suspects: &Suspects, rig: &TestRig, limits: &Limits) -> Vec<f64> {
    const WINDOW: f64 = 200.0;
    const COUNT: i32 = 5;
    let period_s = rig.period.seconds();
    let responses = suspects.models.iter().map(|m| response_s(&m.model, rig, limits.largest));
    let response = responses.fold(0.0, f64::max);
    let (lowest, highest) = limits.hold_s.unwrap_or_else(|| {
        let least = shortest_hold_s(period_s) + suspects.base.delay.value.min(response);
        let least = least.max(response);
        (least, (WINDOW * period_s).max(2.0 * least))
    });
    // A geometric series from the shortest to the longest hold.
    let ratio = (highest / lowest).max(1.0);
    let hold = |k: i32| two_digits(lowest * ratio.powf(f64::from(k) / f64::from(COUNT - 1)));
    let mut holds: Vec<f64> = (0..COUNT).map(hold).collect();
    holds.dedup();
    holds
}

/// Sets of magnitudes and the patterns to try them in: those that `explain` proposes, and
/// levels near and between the thresholds of both effects beside the largest.
fn sets(suspects: &Suspects, largest: f64) -> Vec<(Vec<f64>, &'static [Pattern])> {
    const ALL: &[Pattern] = &[Pattern::Ladder, Pattern::Pulses, Pattern::Reversals];
    const LEAST: f64 = 0.1;
    let ids = suspects.ids();
    let [one, other] = &suspects.models;
    let suspects = [(&one.model, &ids[..1]), (&other.model, &ids[1..])];
    let mut thresholds = thresholds(suspects, largest);
    let mut sets = level_sets((LEAST * largest, largest), &thresholds);
    thresholds.sort_by(f64::total_cmp);
    // Between two thresholds only one of the effects is at work.
    let between = thresholds.windows(2).map(|pair| pair.iter().sum::<f64>() / 2.0);
    let near = thresholds.iter().flat_map(|t| [0.7 * t, 1.3 * t]);
    let known = [0.25, 0.5].map(|part| part * largest);
    let single: Vec<f64> = between.chain(near).chain(known).map(two_digits).collect();
    sets.extend(single.iter().map(|level| (vec![*level, largest], ALL)));
    sets.extend(single.iter().map(|level| (vec![*level], &ALL[1..])));
    sets.push((vec![largest], &ALL[1..]));
    sets.retain(|(levels, _)| levels.iter().all(|level| *level <= largest && *level > 0.0));
    sets
}

/// `levels` in `pattern`, again and again, with a short rest before.
fn repeated(
    pattern: Pattern,
    levels: &[f64],
    hold_s: f64,
    rig: &TestRig,
    longest_s: f64,
) -> Vec<Hold> {
    let samples = samples_in(hold_s, rig.period);
    let rest = samples_in(shortest_hold_s(rig.period.seconds()), rig.period);
    let cycle: Vec<f64> = pattern.sequence(levels).into_iter().skip(1).collect();
    let most = samples_in(longest_s, rig.period);
    let mut holds = vec![Hold { level: 0.0, samples: rest }];
    let signs = (0..).flat_map(|_: usize| [1.0, -1.0]);
    let all = signs.flat_map(|sign| cycle.iter().map(move |level| sign * level));
    let count = most.saturating_sub(rest) / samples;
    for level in all.take(count) {
        match holds.last_mut() {
            // What follows at the same level is one hold.
            Some(last) if last.level.to_bits() == level.to_bits() => last.samples += samples,
            _ => holds.push(Hold { level, samples }),
        }
    }
    holds
}

/// Random steps over a grid of levels, as somebody who knows nothing would play them, and over
/// small ones.
fn random(
    suspects: &Suspects,
    rig: &TestRig,
    limits: &Limits,
    holds: &[f64],
) -> Vec<(Order, Schedule)> {
    let (Some(shortest), Some(longest)) = (holds.first(), holds.last()) else { return Vec::new() };
    let grid = |largest: f64| -> Vec<f64> {
        [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0].map(|part| part * largest).to_vec()
    };
    let mut all = Vec::new();
    for (part, seed) in [1.0, 0.5].into_iter().flat_map(|part| [(part, 1), (part, 2)]) {
        let levels = grid(part * limits.largest);
        let hold_s = (*shortest, *longest);
        let steps = RandomSteps { levels, hold_s, duration_s: limits.longest_s, seed };
        let plain = suspects.models.first().filter(|_| rig.range.is_some());
        all.push((Order::Random, random_steps(&steps, rig, plain, 0)));
    }
    all
}

/// Holds of `schedule` until the joint may leave its range, whichever suspect is there.
pub(super) fn kept(schedule: &Schedule, suspects: &Suspects, rig: &TestRig) -> usize {
    let Some(range) = rig.range else { return schedule.holds().len() };
    let until = suspects.models.iter().filter_map(|uncertain| {
        let predicted = rig.prediction(uncertain, schedule);
        predicted.kept_until(range)
    });
    let Some(until) = until.min() else { return schedule.holds().len() };
    // What was commanded acts on after its hold, until the next arrives.
    let delay = samples_in(suspects.base.delay.value, rig.period);
    until.checked_sub(delay).map_or(0, |until| schedule.over_after(until))
}
