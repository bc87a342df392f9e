//! Single decisions: the segment with both lines, and the error of every candidate.

use std::collections::HashSet;

use super::document::{Figure, NARROW};
use crate::delay::{Condition, Verdict};
use crate::experiment::Joint;
use crate::figure::segment::{Scale, SegmentFigure};
use crate::report::decisions::{doubted, step_line};
use crate::report::{Doubted, EstimatedJoint};

/// A decision that is worth a look, and why.
struct Choice<'a> {
    why: &'static str,
    found: Doubted<'a>,
}

/// The best, a typical and the most doubtful of the accepted decisions, and a rejected one.
pub(super) fn figures(estimated: EstimatedJoint<'_>) -> Vec<Figure> {
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
