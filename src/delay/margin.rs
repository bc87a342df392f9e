//! How near a verdict was: what would have accepted a step, and what came second.

use super::condition::{Check, Condition};
use super::decision::Decision;
use super::settings::Settings;
use crate::numerics::{limits, to_digits_by};

/// The smallest change of a setting with which one condition would have been met, all else
/// being as it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Remedy {
    /// The first and the last step are judged like the others.
    KeepFirstLast,
    /// Wider limits of the output: the lower and the upper one.
    OutputLimits(f64, f64),
    /// A smaller change of slope is accepted, output units per sample.
    MinSlopeChange(f64),
    /// A shorter hold is accepted, samples.
    MinDelay(usize),
    /// A larger squared error is accepted, output units squared.
    MaxSse(f64),
    /// A smaller β, samples.
    Beta(usize),
    /// A reaction needs to be less sure; none for an untested one.
    Confidence(Option<f64>),
    /// No setting helps against this condition.
    None(Condition),
}

/// The second-best breakpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunnerUp {
    /// First sample after it.
    pub breakpoint: usize,
    /// Its squared error, output units squared.
    pub sse: f64,
    /// By how much its squared error is larger than that of the best, as a part of it;
    /// infinite when the best one has none.
    pub margin: f64,
}

impl Decision {
    /// What would have accepted this step: one remedy for each condition that failed, none
    /// for an accepted step. `output` is what the method looked at.
    pub(crate) fn remedies(&self, settings: &Settings, output: &[f64]) -> Vec<Remedy> {
        self.failed_checks().map(|check| self.remedy(&check, settings, output)).collect()
    }

    fn remedy(&self, check: &Check, settings: &Settings, output: &[f64]) -> Remedy {
        let value = check.value.unwrap_or(f64::NAN);
        let none = Remedy::None(check.condition);
        match check.condition {
            Condition::FirstOrLast => Remedy::KeepFirstLast,
            Condition::OutputLimit => self.wider_limits(settings, output).unwrap_or(none),
            Condition::BeforeInput | Condition::AtRest | Condition::Reviewer => none,
            Condition::SlopeChange => Remedy::MinSlopeChange(at_most(value)),
            Condition::ShortHold => Remedy::MinDelay(self.hold),
            Condition::Sse => Remedy::MaxSse(above(value)),
            // M = 2 rows are the fewest that have a candidate.
            Condition::TooShort => match self.segment.len() / 2 {
                beta if beta > 0 => Remedy::Beta(beta),
                _ => none,
            },
            Condition::NothingHappened => check.value.map_or(none, |p_value| {
                let confidence = at_most(1.0 - p_value);
                Remedy::Confidence((confidence > 0.0).then_some(confidence))
            }),
        }
    }

    fn wider_limits(&self, settings: &Settings, output: &[f64]) -> Option<Remedy> {
        let (low, high) = settings.output_limits?;
        let (least, most) = limits(output.get(self.segment.indices())?.iter().copied());
        let low = if least > low { low } else { -above(-least) };
        let high = if most < high { high } else { above(most) };
        Some(Remedy::OutputLimits(low, high))
    }

    /// The best breakpoint in another valley of the squared error; where there is only one
    /// valley, the better neighbour of the best.
    pub fn runner_up(&self) -> Option<RunnerUp> {
        let (best, second) = (self.candidates.best()?, self.candidates.second()?);
        let margin = if best.sse > 0.0 { second.sse / best.sse - 1.0 } else { f64::INFINITY };
        Some(RunnerUp { breakpoint: second.breakpoint, sse: second.sse, margin })
    }
}

/// Digits of a limit that is proposed.
const DIGITS: i32 = 6;

/// A number of six digits that is `value` or just below.
fn at_most(value: f64) -> f64 {
    let rounded = to_digits_by(value, DIGITS, f64::floor);
    if rounded <= value { rounded } else { value }
}

/// A number of six digits just above `value`.
fn above(value: f64) -> f64 {
    let rounded = to_digits_by(value, DIGITS, |digits| digits.floor() + 1.0);
    if rounded > value { rounded } else { value.next_up() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Method;
    use crate::delay::{FirstLast, Verdict, estimate};
    use crate::experiment::Trial;
    use crate::units::SamplePeriod;

    /// Two steps, 12 samples late, with a ripple as noise; the second is small.
    fn trial() -> Trial {
        let input = |k: i32| if k < 100 { 0.0 } else { 1.0 + 0.1 * f64::from(k / 200) };
        let turn = |k: i32| 0.2 * f64::from((k - 112).max(0)) + 0.02 * f64::from((k - 212).max(0));
        let ripple = |k: i32| 0.05 * f64::from((k * 7919) % 101 - 50) / 50.0;
        let input = (0..300).map(input).collect();
        let output = (0..300).map(|k| turn(k) + ripple(k)).collect();
        Trial::new("1", 0.0, SamplePeriod::from_seconds(0.01).unwrap(), input, output).unwrap()
    }

    /// `settings` after a remedy whose number is `factor` times as large.
    fn remedied(settings: &Settings, remedy: Remedy, factor: f64) -> Settings {
        let mut changed = settings.clone();
        match remedy {
            Remedy::MinSlopeChange(value) => changed.min_slope_change = value * factor,
            Remedy::MaxSse(value) => changed.max_sse = Some(value * factor),
            Remedy::MinDelay(samples) => {
                changed.min_delay = if factor > 1.0 { samples + 1 } else { samples };
            }
            Remedy::OutputLimits(low, high) => changed.output_limits = Some((low, high)),
            other => panic!("{other:?}"),
        }
        changed
    }

    #[test]
    fn what_would_have_accepted_a_step_does() {
        let trial = trial();
        let kept = Settings {
            first_last: FirstLast::Keep,
            low_pass: None,
            ..Settings::of(Method::TWO_LINE)
        };
        let cases = [
            (Settings { min_slope_change: 0.5, ..kept.clone() }, 1.02),
            (Settings { max_sse: Some(1e-6), ..kept.clone() }, 0.999),
            (Settings { min_delay: 150, ..kept.clone() }, 1.02),
        ];
        for (settings, too_little) in cases {
            let found = estimate(&trial, &settings).unwrap();
            let remedies = found.decisions[0].remedies(&settings, trial.output());
            assert_eq!(remedies.len(), 1, "{remedies:?}");
            let verdict = |factor: f64| {
                let changed = remedied(&settings, remedies[0], factor);
                estimate(&trial, &changed).unwrap().decisions[0].verdict()
            };
            assert_eq!(verdict(1.0), Verdict::Accepted, "{remedies:?}");
            assert_ne!(verdict(too_little), Verdict::Accepted, "{remedies:?}");
        }
    }

    #[test]
    fn wider_limits_hold_the_whole_segment() {
        let trial = trial();
        let mut settings = Settings {
            first_last: FirstLast::Keep,
            low_pass: None,
            ..Settings::of(Method::TWO_LINE)
        };
        settings.output_limits = Some((-0.01, 3.0));
        let found = estimate(&trial, &settings).unwrap();
        let remedies = found.decisions[0].remedies(&settings, trial.output());
        let again = estimate(&trial, &remedied(&settings, remedies[0], 1.0)).unwrap();
        assert_eq!(again.decisions[0].verdict(), Verdict::Accepted);
    }

    #[test]
    fn the_second_best_is_in_another_valley() {
        let found =
            estimate(&trial(), &Settings { low_pass: None, ..Settings::of(Method::TWO_LINE) })
                .unwrap();
        let decision = &found.decisions[0];
        let best = decision.breakpoint().unwrap().candidate;
        let second = decision.runner_up().unwrap();
        assert_ne!(second.breakpoint, best.breakpoint);
        assert!(second.margin > 0.0);
        assert!((second.sse / best.sse - 1.0 - second.margin).abs() < 1e-12);
    }

    #[test]
    fn rounding_is_on_the_safe_side() {
        for value in [0.012_345_678_9, 123_456_789.0, 1e-300, 3.0, -0.4] {
            assert!(at_most(value) <= value && above(value) > value, "{value}");
            assert!((at_most(value) - value).abs() <= 1e-5 * value.abs());
            assert!((above(value) - value).abs() <= 1e-4 * value.abs());
        }
    }
}
