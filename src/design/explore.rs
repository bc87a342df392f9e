//! An input that explores: where a record leaves a level of the input open at which an effect
//! switches, no input suits all that is possible, and the input that shows where that level lies
//! comes first.

use super::family::{holds_s, kept};
use super::limits::Limits;
use super::predict::TestRig;
use super::result::OpenThreshold;
use super::schedule::{Hold, Schedule, samples_in};
use super::suspects::Suspects;
use crate::effect::Dimension;
use crate::explain::two_digits;

/// A threshold is open where the highest level that is likely is so many times the lowest.
/// Chosen: below it, levels 20 % below and above cross it for sure.
const OPEN: f64 = 1.25;

/// What the record leaves open of the suspects `aims`, up to the level `largest`.
pub(super) fn open(suspects: &Suspects, aims: [bool; 2], largest: f64) -> Vec<OpenThreshold> {
    /// Lower levels, in parts of the largest, are none.
    const LEAST: f64 = 0.02;
    let mut all = Vec::new();
    for ((effect, known), aim) in suspects.effects.iter().zip(&suspects.models).zip(aims) {
        let spec = effect.spec();
        let levels = spec.parameters.iter().enumerate();
        let levels = levels.filter(|(_, p)| aim && p.dimension == Dimension::Input);
        for (index, parameter) in levels {
            let drawn = known.draws.iter().filter_map(|model| {
                let mut own = model.components().iter();
                let own = own.find(|component| component.effect().spec().id == spec.id)?;
                let level = own.parameters()[index].value.abs();
                Some(level.clamp(LEAST * largest, largest))
            });
            let none = (f64::INFINITY, 0.0);
            let (low, high) =
                drawn.fold(none, |(low, high): (f64, f64), x| (low.min(x), high.max(x)));
            if high > OPEN * low {
                all.push(OpenThreshold { effect: spec.id, parameter: parameter.name, low, high });
            }
        }
    }
    all
}

/// Steps over all levels that are `open`, as finely as the range of the joint allows: up from
/// rest, which shows where the joint starts, and down again, which shows where it stops, in
/// either direction.
///
/// `None` where nothing is open, or the joint would leave its range.
pub(super) fn exploring(
    suspects: &Suspects,
    rig: &TestRig,
    limits: &Limits,
    open: &[OpenThreshold],
) -> Option<Schedule> {
    /// Levels that are played.
    const MOST: u32 = 8;
    const FEWEST: u32 = 4;
    let none = (f64::INFINITY, 0.0);
    let ends =
        |(low, high): (f64, f64), open: &OpenThreshold| (low.min(open.low), high.max(open.high));
    let (low, high) = open.iter().fold(none, ends);
    if low >= high {
        return None;
    }
    let hold_s = hold_s(suspects, rig, limits, low)?;
    let schedules = (FEWEST..=MOST).rev().map(|count| {
        let schedule = Schedule::new(rig.period, holds((low, high), count, hold_s, rig, limits));
        let whole = kept(&schedule, suspects, rig) == schedule.holds().len();
        (whole && schedule.duration_s() <= limits.longest_s).then_some(schedule)
    });
    schedules.flatten().next()
}

/// The shortest hold that a fit can use, and in which the lowest level shows.
fn hold_s(suspects: &Suspects, rig: &TestRig, limits: &Limits, low: f64) -> Option<f64> {
    /// Deviations of the noise by which a joint that moves does so at least.
    const SHOWS: f64 = 10.0;
    let usual = holds_s(suspects, rig, limits);
    let (shortest, longest) = (*usual.first()?, *usual.last()?);
    let speed = suspects.base.gain.value.abs() * low;
    let delay_s = suspects.base.delay.value;
    let needed = delay_s + SHOWS * suspects.noise / speed.max(f64::MIN_POSITIVE);
    Some(two_digits(needed.clamp(shortest, longest.max(shortest))))
}

/// The holds at `count` levels from the lowest to the highest, each by the same factor higher
/// than the one before.
fn holds(
    (low, high): (f64, f64),
    count: u32,
    hold_s: f64,
    rig: &TestRig,
    limits: &Limits,
) -> Vec<Hold> {
    /// So far beyond both ends the levels reach.
    const BEYOND: f64 = 1.1;
    let (low, high) = (low / BEYOND, (BEYOND * high).min(limits.largest));
    // Levels in a geometric series: a threshold is found to the same part wherever it lies.
    let ratio = (high / low).powf(1.0 / f64::from(count - 1));
    let level = |k: u32| two_digits(low * ratio.powf(k.into())).min(limits.largest);
    let levels: Vec<f64> = (0..count).map(level).collect();
    let top = levels.last().copied().unwrap_or(high);
    // Every other level on either side: an effect that is the same in both directions is found
    // twice as finely.
    let side = |skipped: usize, sign: f64| {
        let mut up: Vec<f64> = levels.iter().copied().skip(skipped).step_by(2).collect();
        if up.last().is_some_and(|last| *last < top) {
            up.push(top);
        }
        let down = up.iter().rev().skip(1).copied().collect::<Vec<_>>();
        up.into_iter().chain(down).map(move |level| sign * level).collect::<Vec<_>>()
    };
    let samples = samples_in(hold_s, rig.period);
    let all = std::iter::once(0.0).chain(side(0, 1.0)).chain(side(1, -1.0));
    all.map(|level| Hold { level, samples }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::predict::Uncertain;
    use super::super::predict::tests::rig;
    use super::*;
    use crate::effect::{DeadBand, Stiction};
    use crate::model::{Component, JointModel};

    /// A dead band that is known, and a stiction that starts somewhere from 0.2 V to 0.8 V.
    fn suspects() -> Suspects {
        let base = JointModel::integrator(10.0, 0.1);
        let sticky = |start: f64| {
            let numbers = vec![start.into(), 0.15.into()];
            base.with(Component::new(&Stiction, numbers).unwrap())
        };
        let band = Component::new(&DeadBand, vec![(-0.3).into(), 0.3.into()]).unwrap();
        let mut models = [base.with(band), sticky(0.5)].map(|m| Uncertain::by_share(m, 0.0));
        models[0].draws = vec![models[0].model.clone(); 3];
        models[1].draws = [0.2, 0.5, 0.8].map(sticky).to_vec();
        let effects: [&'static dyn crate::effect::Effect; 2] = [&DeadBand, &Stiction];
        Suspects { effects, base, models, noise: 0.05, excluded: [false; 2] }
    }

    #[test]
    fn what_is_open_is_crossed_both_ways_and_in_both_directions() {
        let suspects = suspects();
        let found = open(&suspects, [true, true], 2.0);
        let expected =
            OpenThreshold { effect: "stiction", parameter: "start", low: 0.2, high: 0.8 };
        assert_eq!(found, [expected]);
        assert_eq!(open(&suspects, [true, false], 2.0), []);
        let limits =
            Limits { largest: 2.0, hold_s: None, longest_s: 60.0, power: 0.95, rehearsals: 40 };
        let rig = rig(Some((-20.0, 20.0)));
        let schedule = exploring(&suspects, &rig, &limits, &found).unwrap();
        let levels = schedule.levels();
        for sign in [1.0, -1.0] {
            let side = levels.iter().map(|level| sign * level).filter(|level| *level > 0.0);
            let side: Vec<f64> = side.collect();
            let inside = side.iter().filter(|level| (0.2..0.8).contains(*level)).count();
            assert!(inside >= 1 && side.iter().any(|level| *level > 0.8), "{side:?}");
        }
        // The joint moves at every level that lies above where it starts, and comes back.
        let output = rig.output(&suspects.models[1].model, &schedule);
        assert!(output.iter().all(|angle| angle.abs() < 20.0));
        assert_eq!(exploring(&suspects, &rig, &limits, &[]), None);
    }
}
