//! Outputs that wrap, of sensors that begin anew after a turn.
//!
//! An absolute encoder on a slewing joint shows 179.9 deg and then −179.9: a turn of 360 deg in one
//! sample, which no joint makes. Where all large jumps of an output are of a turn, they are taken
//! out. Its unit says what a turn is, else the jumps themselves do.

use crate::experiment::layout::JointLayout;
use crate::experiment::log::{Log, Mended};
use crate::numerics::{RunningLine, as_written, median, quantile, to_decimals};

/// The output of a joint without the turns of a sensor that wraps.
pub(super) fn unwrap(log: &Log<'_>, joint: &JointLayout) -> Option<Mended> {
    let (column, unit) = (joint.output.column, joint.output.signal.unit.as_deref());
    let wrap = Wrap::of(&log.parts(column)?, unit)?;
    let mut values = log.column(column)?.values.clone();
    let mut count = 0;
    for rows in log.spans() {
        count += values.get_mut(rows).map_or(0, |part| wrap.unwrap(part));
    }
    let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
    let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
    let turn = to_decimals(wrap.turn, 4);
    let note = format!("the output wraps at a turn of {turn}{unit}, {times}: it is unwrapped");
    let note = Some(note).filter(|_| count > 0);
    Some((values, note))
}

/// A sensor that wraps after so much, output units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wrap {
    turn: f64,
    /// The step above which a sample that both its neighbours differ from is an outlier.
    outlier_step: f64,
}

/// Parts of a turn: below the first no sample jumps, nor does it between the first and the second.
const MOTION: f64 = 0.25;
const JUMP: f64 = 0.75;

/// Times a turn that it goes through at most: noise and offsets come after the turn.
const BEYOND: f64 = 1.02;

impl Wrap {
    /// The turn of a sensor whose output is `trials`, not a number where it is missing, in `unit`;
    /// none where it does not begin anew.
    pub(super) fn of(trials: &[&[f64]], unit: Option<&str>) -> Option<Self> {
        if !jumps(trials) {
            return None;
        }
        let outlier_step = outlier_step(trials);
        let whole: Vec<Vec<f64>> =
            trials.iter().map(|trial| without_outliers(trial, outlier_step)).collect();
        let known = || whole.iter().flatten().copied();
        let range = range(known());
        let is_turn = |turn: &f64| (RANGE * turn..=BEYOND * turn).contains(&range);
        let counts = || known().all(|value| value.fract() == 0.0);
        let turn = turns(unit)
            .find(is_turn)
            .or_else(|| powers_of_two(unit).find(is_turn).filter(|_| counts()))
            .or_else(|| seen(&whole, range, unit))?;
        let wrap = Self { turn, outlier_step };
        wrap.explains(&whole).then_some(wrap)
    }

    /// Whether every jump is that of a turn, but for as much as the output moves from one sample to
    /// the next elsewhere. A sensor that fails for a moment jumps by something else.
    fn explains(self, trials: &[Vec<f64>]) -> bool {
        /// Times the largest other step that a jump may be off, and parts of a turn besides.
        const TIMES: f64 = 3.0;
        const BESIDES: f64 = 1e-3;
        let pairs = || trials.iter().flat_map(|trial| trial.windows(2));
        let steps = || pairs().map(|pair| (pair[1] - pair[0]).abs() / self.turn);
        let largest = steps().filter(|step| *step < JUMP).fold(0.0, f64::max);
        let off = steps().filter(|step| *step >= JUMP).map(|step| (step - 1.0).abs());
        let most = off.fold(f64::NEG_INFINITY, f64::max);
        largest < MOTION && (0.0..=TIMES * largest + BESIDES).contains(&most)
    }

    /// Takes the turns out of `values`, which follow one another; how many there were. An outlier near the end of a
    /// turn, as noise there shows, goes to where its neighbours are.
    pub(super) fn unwrap(self, values: &mut [f64]) -> usize {
        let (mut turns, mut count, mut before) = (0.0, 0, f64::NAN);
        let outliers = outliers(values, self.outlier_step);
        for (index, value) in values.iter_mut().enumerate().filter(|(_, value)| !value.is_nan()) {
            let turned = |turns: f64| turns * self.turn;
            if outliers.binary_search(&index).is_ok() {
                let near = |by: &f64| (*value + by - before).abs() < MOTION * self.turn;
                let by = [-self.turn, self.turn].into_iter().find(near).unwrap_or(0.0);
                *value += turned(turns) + by;
                continue;
            }
            let step = *value - before;
            if step.abs() >= JUMP * self.turn {
                turns -= step.signum();
                count += 1;
            }
            before = *value;
            *value += turned(turns);
        }
        count
    }
}

/// The known ones of `values` that are more than `step` from those before and after.
fn outliers(values: &[f64], step: f64) -> Vec<usize> {
    let known: Vec<usize> = (0..values.len()).filter(|index| !values[*index].is_nan()).collect();
    let is_far = |a: usize, b: usize| (values[a] - values[b]).abs() > step;
    let triples = known.windows(3);
    let far = triples.filter(|three| is_far(three[0], three[1]) && is_far(three[1], three[2]));
    far.map(|three| three[1]).collect()
}

/// The step above which a sample is an outlier: well above usual ones. Where such
/// samples are no few, none is.
fn outlier_step(trials: &[&[f64]]) -> f64 {
    /// Part of the steps that are usual, times the largest of them, and part of the range.
    const USUAL: f64 = 0.95;
    const TIMES: f64 = 5.0;
    const OF_RANGE: f64 = 0.01;
    /// Samples to one outlier, at least.
    const SELDOM: usize = 100;
    let known = || trials.iter().copied().flatten().copied().filter(|value| !value.is_nan());
    let steps: Vec<f64> = trials
        .iter()
        .flat_map(|trial| trial.windows(2))
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|step| !step.is_nan())
        .collect();
    let usual = quantile(&steps, USUAL).unwrap_or_default();
    let step = (TIMES * usual).max(OF_RANGE * range(known()));
    let count: usize = trials.iter().map(|trial| outliers(trial, step).len()).sum();
    if SELDOM * count > known().count() { f64::INFINITY } else { step }
}

/// The known values of a trial without its outliers.
fn without_outliers(trial: &[f64], step: f64) -> Vec<f64> {
    let outliers = outliers(trial, step);
    let values = trial.iter().copied().enumerate();
    let kept = values.filter(|(index, _)| outliers.binary_search(index).is_err());
    kept.map(|(_, value)| value).filter(|value| !value.is_nan()).collect()
}

/// Whether any sample jumps by a good part of the range, as all do that begin a turn: most outputs
/// are known at once to do nothing like it.
fn jumps(trials: &[&[f64]]) -> bool {
    let known = trials.iter().copied().flatten().copied().filter(|value| !value.is_nan());
    let range = range(known);
    // Across what is missing, too.
    let mut before = f64::NAN;
    trials.iter().copied().flatten().copied().filter(|value| !value.is_nan()).any(|value| {
        let step = (value - before).abs();
        before = value;
        step >= MOTION * range
    })
}

fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
    high - low
}

/// Part of a turn that an output which wraps goes through, at least.
const RANGE: f64 = 0.9;

/// The turns of sensors of angles, by the names of their units; where none is said it may be the
/// first two.
const TURNS: [(&[&str], f64); 6] = [
    (&["deg", "°", "degrees"], 360.0),
    (&["rad", "radians"], std::f64::consts::TAU),
    (&["mdeg"], 360e3),
    (&["mrad"], 1e3 * std::f64::consts::TAU),
    (&["gon"], 400.0),
    (&["rev", "turn", "turns"], 1.0),
];

fn turns(unit: Option<&str>) -> impl Iterator<Item = f64> {
    let is_it = move |(place, (units, _)): &(usize, (&[&str], f64))| {
        unit.map_or(*place < 2, |unit| units.contains(&unit))
    };
    TURNS.into_iter().enumerate().filter(is_it).map(|(_, (_, turn))| turn)
}

/// Those of sensors that count.
fn powers_of_two(unit: Option<&str>) -> impl Iterator<Item = f64> {
    const COUNTS: [&str; 5] = ["cnt", "count", "counts", "inc", "ticks"];
    let is_count = unit.is_none_or(|unit| COUNTS.contains(&unit));
    (8..=32).map(|bits| 2_f64.powi(bits)).filter(move |_| is_count)
}

/// The turn that the jumps of `trials` show, whose output goes through so much of a `range`: none where
/// their unit says it, or where no two of these are jumps to the other end of the range and on in the
/// same direction. Others are noise where a joint rests at the end of a turn.
fn seen(trials: &[Vec<f64>], range: f64, unit: Option<&str>) -> Option<f64> {
    /// Jumps, at least: a sensor that is set to zero jumps once.
    const FEWEST: usize = 2;
    /// The part that a turn of a few significant digits may be off by.
    const OFF: f64 = 2e-3;
    let is_said = unit.is_some_and(|unit| TURNS.iter().any(|(units, _)| units.contains(&unit)));
    if is_said {
        return None;
    }
    let turns: Vec<f64> = trials.iter().flat_map(|trial| turns_at_jumps(trial, range)).collect();
    let turn = median(&turns).filter(|_| turns.len() >= FEWEST)?;
    // Makers choose round numbers.
    let binary = 2_f64.powf(turn.log2().round());
    let round = [binary, as_written(turn, 1), as_written(turn, 2), as_written(turn, 3)];
    let is_near = |round: &f64| (round / turn - 1.0).abs() < OFF;
    Some(round.into_iter().find(is_near).unwrap_or(turn))
}

/// The turn of each jump through the `range`: its height and the way gone meanwhile. None of a jump against
/// which the output does not plainly move, before it and after it.
fn turns_at_jumps(trial: &[f64], range: f64) -> Vec<f64> {
    /// Samples whose motion is looked at, and the part of the range that it goes through, at least.
    const NEAR: usize = 20;
    const LEAST: f64 = 0.005;
    let jumps = (1..trial.len()).filter(|k| (trial[*k] - trial[*k - 1]).abs() >= RANGE * range);
    let ends: Vec<usize> = [0].into_iter().chain(jumps).chain([trial.len()]).collect();
    let turn = |jumps: &[usize]| {
        let &[from, at, to] = jumps else { return None };
        let before = &trial[from.max(at.saturating_sub(NEAR))..at];
        let behind = &trial[at..to.min(at + NEAR)];
        let direction = -(trial[at] - trial[at - 1]).signum();
        let moved = |part: &[f64]| part[part.len() - 1] - part[0];
        let moves = [before, behind].iter().all(|part| direction * moved(part) >= LEAST * range);
        // From the middle of what is before to that of what is after, by the slopes of both.
        let [(first, first_way), (second, second_way)] = [before, behind].map(|part| {
            let mut line = RunningLine::default();
            for value in part {
                line.push(*value);
            }
            (line.mean(), 0.5 * line.slope() * part.len() as f64)
        });
        moves.then(|| (second - first - first_way - second_way).abs())
    };
    ends.windows(3).filter_map(turn).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A motion to and fro over several turns, as a sensor shows it from `low` on.
    fn shown(turn: f64, low: f64) -> (Vec<f64>, Vec<f64>) {
        let truth: Vec<f64> =
            (0..4000).map(|k| 1.7 * turn * (f64::from(k) / 300.0).sin() + 0.1 * turn).collect();
        let wrapped = truth.iter().map(|y| (y - low).rem_euclid(turn) + low).collect();
        (truth, wrapped)
    }

    #[test]
    fn turns_are_taken_out() {
        for (turn, low, unit) in [
            (360.0, -180.0, Some("deg")),
            (360.0, 0.0, None),
            (std::f64::consts::TAU, 0.0, Some("rad")),
        ] {
            let (truth, mut seen) = shown(turn, low);
            let wrap = Wrap::of(&[&seen], unit).unwrap();
            assert!(wrap.unwrap(&mut seen) > 10);
            let offset = seen[0] - truth[0];
            assert!(seen.iter().zip(&truth).all(|(a, b)| (a - b - offset).abs() < 1e-9));
        }
        let (_, seen) = shown(4096.0, 0.0);
        let counts: Vec<f64> = seen.iter().map(|y| y.floor()).collect();
        assert_eq!(Wrap::of(&[&counts], Some("counts")).map(|wrap| wrap.turn), Some(4096.0));
    }

    #[test]
    fn samples_amid_a_turn_and_single_faults_are_passed_over() {
        let (truth, mut seen) = shown(360.0, 0.0);
        let jump = (1..seen.len()).find(|k| (seen[*k] - seen[k - 1]).abs() > 200.0).unwrap();
        seen[jump] = f64::midpoint(seen[jump - 1], seen[jump]);
        seen[50] = 999.0;
        let wrap = Wrap::of(&[&seen], Some("deg")).unwrap();
        assert!(wrap.unwrap(&mut seen) > 10);
        let offset = seen[0] - truth[0];
        let off = |k: &usize| (seen[*k] - truth[*k] - offset).abs();
        assert_eq!((0..seen.len()).filter(|k| off(k) > 1e-9).collect::<Vec<_>>(), [50, jump]);
    }

    #[test]
    fn units_say_the_turn() {
        for (turn, unit) in [(1.0, "rev"), (360e3, "mdeg"), (400.0, "gon")] {
            let (_, seen) = shown(turn, 0.0);
            assert_eq!(Wrap::of(&[&seen], Some(unit)).map(|wrap| wrap.turn), Some(turn));
        }
        let (_, seen) = shown(2_f64.powi(32), 0.0);
        let counts: Vec<f64> = seen.iter().map(|y| y.floor()).collect();
        assert!(Wrap::of(&[&counts], None).is_some());
    }

    #[test]
    fn what_is_missing_parts_no_turn() {
        let (_, mut seen) = shown(360.0, 0.0);
        let wrap = Wrap::of(&[&seen], Some("deg")).unwrap();
        seen.iter_mut().step_by(7).for_each(|y| *y = f64::NAN);
        let mut whole = shown(360.0, 0.0).1;
        assert_eq!(wrap.unwrap(&mut seen), wrap.unwrap(&mut whole));
    }

    #[test]
    fn a_large_motion_and_a_sensor_that_fails_are_no_turns() {
        let motion: Vec<f64> = (0..400).map(|k| 180.0 * (f64::from(k) / 30.0).sin()).collect();
        assert_eq!(Wrap::of(&[&motion], Some("deg")), None);
        let mut failing: Vec<f64> = (0..400).map(|k| 355.0 + 0.01 * f64::from(k % 50)).collect();
        failing.iter_mut().step_by(40).for_each(|y| *y = 0.0);
        assert_eq!(Wrap::of(&[&failing], Some("deg")), None);
    }

    #[test]
    fn a_turn_that_no_unit_names_is_seen() {
        for (turn, low, unit, counts) in [
            (3600.0, 0.0, Some("counts"), true),
            (14_400.0, 0.0, None, true),
            (10.0, 0.0, Some("V"), false),
            (1.0, -0.5, None, false),
            (250.0, 0.0, Some("mm"), false),
        ] {
            let (_, mut seen) = shown(turn, low);
            seen.iter_mut().filter(|_| counts).for_each(|y| *y = y.floor());
            let found = Wrap::of(&[&seen], unit).map(|wrap| wrap.turn);
            assert!(
                found.is_some_and(|found| (found / turn - 1.0).abs() < 1e-9),
                "{found:?} {turn}"
            );
        }
        // At rest where a turn begins, with noise.
        let rests = |k: i32| {
            (f64::from(k - 300).max(0.0) * 9.0 + 2.0 * f64::from(k * 7919 % 5 - 2)).floor()
        };
        let truth: Vec<f64> = (0..4000).map(rests).collect();
        let mut seen: Vec<f64> = truth.iter().map(|y| y.rem_euclid(3600.0)).collect();
        let wrap = Wrap::of(&[&seen], None).unwrap();
        wrap.unwrap(&mut seen);
        let offset = seen[0] - truth[0];
        assert!(seen.iter().zip(&truth).all(|(a, b)| (a - b - offset).abs() < 1e-9), "{wrap:?}");
        let stroke = |k: i32| if k % 900 < 450 { 0.2 * f64::from(k % 450) } else { 0.0 };
        let returns: Vec<f64> = (0..4000).map(stroke).collect();
        assert_eq!(Wrap::of(&[&returns], None), None, "an output that falls back and rests");
    }
}
