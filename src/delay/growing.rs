//! The part of a growing trial, and of its estimate, that is final.
//!
//! Algorithm 1 goes step by step, so that a decision is final as soon as its segment is
//! complete: up to `p_(i+1) + α`, and so much further that the low-pass has forgotten the end.

use super::estimate::{EstimateError, TrialEstimate};
use super::profile::DelayProfile;
use super::settings::Settings;
use crate::experiment::Trial;
use crate::numerics::FilterError;

/// Why decisions are not final while a record grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Growing {
    /// The method looks at the whole record before it decides on any step.
    #[error("`{method}` needs the whole record before it can decide on a step")]
    Method {
        /// Its id.
        method: &'static str,
    },
    /// Whether a reaction is more than noise is judged by the noise of the whole record.
    #[error("the confidence of a reaction is judged by the noise of the whole record")]
    Confidence,
}

/// Whether decisions with `settings` are final before the record ends.
///
/// # Errors
/// [`Growing`] when they depend on the whole record.
pub(crate) fn check_growing(settings: &Settings) -> Result<(), Growing> {
    if settings.method.spec().has_intervals {
        return Err(Growing::Method { method: settings.method.id() });
    }
    if settings.confidence.is_some() {
        return Err(Growing::Confidence);
    }
    Ok(())
}

/// The part of `trial` and its `estimate` that more samples cannot change: the samples whose
/// smoothed value is final, and the decisions within them. `None` where nothing is yet.
///
/// # Errors
/// [`EstimateError::Filter`] when the filter does not fit this trial.
pub(crate) fn final_part(
    trial: &Trial,
    estimate: &TrialEstimate,
    settings: &Settings,
) -> Result<Option<(Trial, TrialEstimate)>, EstimateError> {
    let settings = &settings.at(trial.period());
    let held_back = held_back(trial, settings)?;
    let samples = trial.len().saturating_sub(held_back);
    let Some(beginning) = trial.beginning(samples) else { return Ok(None) };
    let is_whole = |next: usize| next.saturating_add(settings.alpha) <= samples;
    // The last step of a trial may be the last of all, which is rejected.
    // Until there are more than a few, the first may yet be judged.
    let is_open = settings.first_last.are_judged(estimate.decisions.len())
        && !settings.first_last.are_judged(usize::MAX);
    let decisions = if is_open { &[][..] } else { &estimate.decisions[..] };
    let all_but_last = decisions.split_last().map_or(&[][..], |(_, others)| others);
    let decisions = all_but_last.iter().take_while(|decision| is_whole(decision.next_sample()));
    let decisions: Vec<_> = decisions.cloned().collect();
    let profile = DelayProfile::of(&decisions, samples, settings.interpolation);
    let smoothed = estimate.smoothed.as_ref();
    let smoothed = smoothed.map(|all| all.iter().copied().take(samples).collect());
    let (label, onset_model) = (estimate.label.clone(), estimate.onset_model.clone());
    let tracking = estimate.tracking;
    let estimate = TrialEstimate { label, smoothed, decisions, profile, onset_model, tracking };
    Ok(Some((beginning, estimate)))
}

/// How many of the last samples may still change.
fn held_back(trial: &Trial, settings: &Settings) -> Result<usize, FilterError> {
    let low_pass = settings.low_pass_at(trial.period());
    low_pass.map_or(Ok(0), |low_pass| low_pass.reach(trial.period()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Method;
    use crate::delay::estimate;
    use crate::units::SamplePeriod;

    /// A joint that follows its steps 12 samples late, with a ripple on it.
    fn trial(samples: u32) -> Trial {
        let level = |k: u32| [0.0, 1.0, -0.5, 0.5][(k / 70) as usize % 4];
        let mut angle = 0.0;
        let output = (0..samples).map(|k| {
            angle += 0.2 * level(k.saturating_sub(12));
            angle + 0.01 * (f64::from(k) * 1.7).sin()
        });
        let output = output.collect();
        let period = SamplePeriod::from_seconds(0.01).unwrap();
        Trial::new("1", 0.0, period, (0..samples).map(level).collect(), output).unwrap()
    }

    #[test]
    fn final_decisions_are_those_of_the_whole_record() {
        let smoothed = Settings { beta: 2, ..Settings::of(Method::TWO_LINE) };
        let plain = Settings { low_pass: None, ..smoothed.clone() };
        for settings in [smoothed, plain] {
            let whole = trial(1400);
            let all = estimate(&whole, &settings).unwrap();
            let mut most = 0;
            for samples in (100..1400).step_by(37) {
                let part = whole.beginning(samples).unwrap();
                let found = estimate(&part, &settings).unwrap();
                let Some((kept, found)) = final_part(&part, &found, &settings).unwrap() else {
                    continue;
                };
                assert!(kept.len() <= samples && found.profile.iter().count() == kept.len());
                assert!(found.decisions.len() >= most, "none is taken back");
                most = found.decisions.len();
                for (early, late) in found.decisions.iter().zip(&all.decisions) {
                    assert_eq!((early.verdict(), early.delay()), (late.verdict(), late.delay()));
                    assert_eq!(early.segment, late.segment);
                }
            }
            assert!(most >= 12, "{most}");
        }
    }

    #[test]
    fn what_depends_on_the_whole_record_is_refused() {
        assert_eq!(check_growing(&Settings::of(Method::TWO_LINE)), Ok(()));
        let hinge = Settings::of(Method::HINGE);
        assert_eq!(check_growing(&hinge), Err(Growing::Method { method: "hinge" }));
        let judged = Settings { confidence: Some(0.99), ..Settings::of(Method::TWO_LINE) };
        assert_eq!(check_growing(&judged), Err(Growing::Confidence));
    }
}
