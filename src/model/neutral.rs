//! The input at which a joint stands still, where that is a number of its own.
//!
//! The width of a servo's pulse is 1000 to 2000 µs with 1500 as neutral, a duty 5 to 10 %, a
//! joystick's voltage or a share of its range half of it. Such an input has one sign, and the output
//! goes both ways. An integrator from zero on has nothing to do with such a record, and a search
//! that begins there would first have to find the neutral among all effects.

use crate::delay::{Neutral, followed};
use crate::experiment::{Property, Record, Trial};
use crate::numerics::NormalEquations;
use crate::units::ceil_to_index;

/// How far from both ends of the input the neutral is at least, in parts of its range.
const INSIDE: f64 = 0.05;

/// How far from a held neutral the input may be that is held there, in parts of its range.
const NEAR: f64 = 0.01;

/// The neutral of a coded input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CodedNeutral {
    /// In input units.
    pub(crate) level: f64,
    /// Whether it is a level at which the joint rests, and not only where a line crosses zero.
    pub(crate) is_held: bool,
}

/// The neutral of an input that is coded: of one sign, between its ends, and not zero. None where it
/// is not so, where the output follows the input itself, or where the record does not show it.
pub(crate) fn coded_neutral(record: &Record) -> Option<CodedNeutral> {
    *record.property()
}

impl Property for Option<CodedNeutral> {
    fn find(trials: &Record) -> Self {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let inputs = trials.iter().flat_map(Trial::input);
        let (low, high) = inputs.fold(ends, |(low, high), u| (low.min(*u), high.max(*u)));
        let margin = INSIDE * (high - low);
        if low < 0.0 && high > 0.0 || margin <= 0.0 || followed(trials).is_some() {
            return None;
        }
        let is_inside = |level: &f64| (low + margin..=high - margin).contains(level);
        let held = Neutral::of(trials).map(|neutral| neutral.level);
        let held = held.filter(is_inside).map(|level| CodedNeutral {
            level,
            is_held: is_usual(trials, level, NEAR * (high - low)),
        });
        held.or_else(|| {
            let level = balanced(trials).filter(is_inside)?;
            Some(CodedNeutral { level, is_held: false })
        })
    }
}

/// Whether the input is for a good part of the time within `near` of `level`: a stick that swings
/// through it is there for 1 %.
fn is_usual(trials: &[Trial], level: f64, near: f64) -> bool {
    /// The part of the time (chosen).
    const PART: f64 = 0.1;
    let there = |input: &[f64]| input.iter().filter(|u| (**u - level).abs() <= near).count();
    let samples: usize = trials.iter().map(Trial::len).sum();
    trials.iter().map(|trial| there(trial.input())).sum::<usize>() as f64 >= PART * samples as f64
}

/// The input at which the speed changes its sign, by the line
///
/// `v_k = b (u_(k−d) − u₀)`
///
/// of the speed on the input a delay before, where that is shown: the output goes both ways, the
/// squared error is well below that of a line through zero input and that of a mean speed, and not
/// much above that of a speed that depends on the output, too, as of a tank that runs full.
fn balanced(trials: &[Trial]) -> Option<f64> {
    /// Longest delay that is tried, in samples and as a part of the trial, and how many are.
    const LONGEST: usize = 200;
    const PART: usize = 10;
    const TRIED: usize = 40;
    let trial = trials.iter().max_by_key(|trial| trial.len())?;
    let longest = LONGEST.min(trial.len() / PART);
    let lines = (0..=longest).step_by((longest / TRIED).max(1)).filter_map(|d| Line::of(trial, d));
    let best = lines.min_by(|a, b| a.error.total_cmp(&b.error))?;
    best.is_shown().then_some(best.neutral)
}

/// The line of the speed on the input a delay before, and the squared errors of what is compared
/// with it.
struct Line {
    neutral: f64,
    error: f64,
    /// Of a line through zero input.
    through_zero: f64,
    /// Of a mean speed.
    constant: f64,
    /// Of a speed that depends on the output, too.
    with_output: f64,
}

impl Line {
    /// None where there are too few samples, or the output goes one way only.
    fn of(trial: &Trial, delay: usize) -> Option<Self> {
        /// Seconds over which a speed is taken, and as samples at least.
        const SPEED_S: f64 = 0.2;
        const FEWEST: usize = 3;
        /// Samples that are enough.
        const ENOUGH: usize = 5000;
        let (input, output) = (trial.input(), trial.output());
        let span = ceil_to_index(SPEED_S / trial.period().seconds()).max(FEWEST);
        let samples = trial.len().checked_sub(delay + span)?;
        let taken: Vec<usize> = (0..samples).step_by((samples / ENOUGH).max(1)).collect();
        let level = |k: usize| input[k..k + span].iter().sum::<f64>() / span as f64;
        let speed = |k: usize| (output[k + delay + span] - output[k + delay]) / span as f64;
        let column = |value: &dyn Fn(usize) -> f64| taken.iter().map(|k| value(*k)).collect();
        let [levels, speeds]: [Vec<f64>; 2] = [column(&level), column(&speed)];
        let outputs: Vec<f64> = column(&|k| output[k + delay] - output[0]);
        let goes = |sign: f64| speeds.iter().any(|v| v * sign > 0.0);
        if taken.len() <= 2 * FEWEST || !goes(1.0) || !goes(-1.0) {
            return None;
        }
        let zero = [&levels[..], &speeds].concat();
        let mut zero = NormalEquations::of(&zero, taken.len());
        zero.eliminate(0);
        let all = [&vec![1.0; taken.len()][..], &levels, &outputs, &speeds].concat();
        let mut all = NormalEquations::of(&all, taken.len());
        all.eliminate(0);
        let constant = all.error();
        all.eliminate(1);
        let error = all.error();
        let neutral = match all.coefficients(2).as_slice() {
            [at_zero, slope] => -at_zero / slope,
            _ => return None,
        };
        all.eliminate(2);
        let (through_zero, with_output) = (zero.error(), all.error());
        let found = Self { neutral, error, through_zero, constant, with_output };
        neutral.is_finite().then_some(found)
    }

    fn is_shown(&self) -> bool {
        /// Largest parts of the squared error of a line through zero, and of the mean (chosen).
        const OF_ZERO: f64 = 0.5;
        const OF_MEAN: f64 = 0.7;
        /// Least part of it that a dependence on the output leaves of one that integrates (chosen).
        const INTEGRATES: f64 = 0.9;
        /// Part of the squared error of the mean below which nothing is left to explain: what a
        /// part of a sample of delay leaves of a smooth input, the output explains, too (chosen).
        const CLEAR: f64 = 0.02;
        self.error <= OF_ZERO * self.through_zero
            && self.error <= OF_MEAN * self.constant
            && (self.with_output > INTEGRATES * self.error || self.error <= CLEAR * self.constant)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::SamplePeriod;

    /// A stick that moves about `centre`, and a joint that follows it 10 samples later, or an
    /// output that runs to a level of its own at the rate `regulates` per sample.
    fn trial(centre: f64, regulates: f64) -> Vec<Trial> {
        let stick = |k: usize| {
            let t = 0.02 * k as f64;
            centre + 200.0 * (t.sin() + (0.37 * t + 1.0).sin() + (2.3 * t).sin())
        };
        let input: Vec<f64> = (0..3000).map(stick).collect();
        let mut angle = 0.0;
        let output = (0..3000_usize).map(|k| {
            angle += 0.001 * (k.checked_sub(10).map_or(centre, stick) - centre) - regulates * angle;
            angle
        });
        let (output, period) = (output.collect(), SamplePeriod::from_seconds(0.02).unwrap());
        vec![Trial::new("1", 0.0, period, input, output).unwrap()]
    }

    #[test]
    fn a_stick_about_a_pulse_width_is_neutral_there() {
        let record = trial(1500.0, 0.0);
        let [found, by_speed] = [
            coded_neutral(&Record::from(record.clone())).map(|neutral| neutral.level),
            balanced(&record),
        ]
        .map(Option::unwrap);
        // A slow turn of the stick is a level that is held; it is where a fit starts.
        assert!((found - 1500.0).abs() < 60.0, "{found}");
        assert!((by_speed - 1500.0).abs() < 5.0, "{by_speed}");
    }

    #[test]
    fn zero_and_what_an_output_settles_at_are_no_coded_neutral() {
        assert_eq!(coded_neutral(&Record::from(trial(0.0, 0.0))), None);
        assert_eq!(coded_neutral(&Record::from(trial(1500.0, 0.02))), None);
    }
}
