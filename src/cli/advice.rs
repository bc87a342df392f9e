//! What to do on the command line about an error: the library speaks of values, and the option
//! to use is said here.

use std::error::Error;

use super::typed::mapping_options;
use crate::delay::{EstimateError, Growing, Method};
use crate::design::{NotKept, PlanError, SuspectsError, rounded};
use crate::experiment::{ReadError, ReadErrorKind};
use crate::explain::AddError;
use crate::numerics::FilterError;

/// What follows the message of `error`, where an option helps; else nothing.
pub(crate) fn advice(error: &(dyn Error + 'static)) -> String {
    if let Some(error) = error.downcast_ref::<ReadError>() {
        return on_reading(error);
    }
    if let Some(error) = error.downcast_ref::<Growing>() {
        return on_growing(*error);
    }
    if let Some(error) = error.downcast_ref::<PlanError>() {
        return on_plan(error);
    }
    let text = match error.downcast_ref::<EstimateError>() {
        Some(EstimateError::Filter(error)) => on_filter(error),
        Some(EstimateError::TooFewSamples { .. }) => "; choose a smaller `--beta`",
        Some(EstimateError::Continuous) => {
            "; `tauscope estimate` gives it, and `--input steps` takes each change for a step"
        }
        _ => "",
    };
    let text = match error.downcast_ref::<AddError>() {
        Some(AddError::AlreadyThere { .. }) => "; `tauscope compare --fit` fits it again",
        _ => text,
    };
    match error.downcast_ref::<SuspectsError>() {
        Some(SuspectsError::NoNoise) => "; give it with `--noise`",
        _ => text,
    }
    .to_owned()
}

fn on_reading(error: &ReadError) -> String {
    let text = match &error.kind {
        ReadErrorKind::NoJoints(likely) if !likely.1.is_empty() => {
            let (time, mappings) = likely.as_ref();
            let options =
                |joints: &Vec<_>| format!("`{}`", mapping_options([time.as_deref(), None], joints));
            let options: Vec<String> = mappings.iter().map(options).collect();
            return format!(
                "; the data suggest {}; `tauscope columns` says why, and `tauscope columns -w` \
                 saves it",
                options.join(" or ")
            );
        }
        ReadErrorKind::NoJoints(_) => {
            "; name those of a joint with `--joint NAME=INPUT_COLUMN:OUTPUT_COLUMN`; `tauscope \
             columns` shows which they may be"
        }
        ReadErrorKind::NoTime(Some(index)) => {
            return format!(
                "; `--time '{index}'` takes the first column, which has no name of its own, or give the \
                 period with `--sample-period SECONDS`"
            );
        }
        ReadErrorKind::NoTime(None) => {
            "; name one with `--time COLUMN`, or give the period with `--sample-period SECONDS`"
        }
        ReadErrorKind::Times => ", or give the period with `--sample-period SECONDS`",
        ReadErrorKind::NotATime => " and give `--sample-period SECONDS`",
        ReadErrorKind::Missing => {
            "; `--fill SECONDS` fills gaps up to that length and splits the trial at longer ones"
        }
        ReadErrorKind::NotUniform { step, period } => return on_uneven_times(*step, *period),
        ReadErrorKind::TrialNotContiguous => {
            ", or choose `--trial none` if the column does not name trials"
        }
        ReadErrorKind::TooLarge => ", or allow more with `--max-memory`",
        ReadErrorKind::TooManySamples => ", or choose a longer `--resample`",
        _ => "",
    };
    text.to_owned()
}

/// A step of several periods looks like lost rows, which `--fill` mends.
fn on_uneven_times(step: f64, period: f64) -> String {
    let periods = step / period;
    let lost_rows = periods > 1.5 && (periods - periods.round()).abs() < 0.01;
    let fill = if lost_rows { ", `--fill SECONDS` fills lost rows" } else { "" };
    format!("; `--resample {period}` puts the log on a uniform grid{fill}")
}

fn on_growing(error: Growing) -> String {
    let expected = match error {
        Growing::Method { .. } => {
            let alone = Method::all().filter(|method| !method.spec().has_intervals);
            format!("--method {}", alone.map(Method::id).collect::<Vec<_>>().join("|"))
        }
        Growing::Confidence => "--confidence none".to_owned(),
    };
    format!("; expected `{expected}`")
}

fn on_plan(error: &PlanError) -> String {
    let text = match error {
        PlanError::TooFewLevels => "; `--levels` says which there are",
        PlanError::HoldTooLong { .. } => "; choose a shorter `--hold`, or a longer `--duration`",
        PlanError::ErrorUnknown => "; give a longer log, or `--model` alone",
        PlanError::Elsewhere { .. } => "; give an `--output-range` there, or a log of this range",
        PlanError::SettlesElsewhere { .. } => "; give an `--output-range` about two of these",
        PlanError::OneSign { .. } => "; give a log with inputs of either sign, or `--levels`",
        PlanError::Start { range, .. } => {
            return format!("; choose a `--start` near {}", rounded(0.5 * (range.0 + range.1)));
        }
        PlanError::NotKept { why, .. } => return on_range(why),
    };
    text.to_owned()
}

fn on_range(NotKept { shorter_s, wider, .. }: &NotKept) -> String {
    let shorter = shorter_s.map(|s| format!("`--duration {s}`"));
    let wider = wider.map(|(low, high)| format!("`--output-range={low},{high}`"));
    match (shorter, wider) {
        (Some(shorter), Some(wider)) => {
            format!("; give {shorter}, or {wider}, or go without `--trials`")
        }
        (Some(shorter), None) => format!("; give {shorter}, or go without `--trials`"),
        (None, Some(wider)) => format!("; give {wider}"),
        (None, None) => ": give a log in which the joint is driven for longer without \
                         interruption, or smaller levels (`--largest`)"
            .to_owned(),
    }
}

fn on_filter(error: &FilterError) -> &'static str {
    match error {
        FilterError::AboveNyquist { .. } => "; choose a lower `--passband`, or `--passband none`",
        FilterError::TooLow { .. } => ", or `--passband none`",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_kept_for_shorter_or_in_a_wider_one() {
        let why = |shorter_s, wider| {
            on_range(&NotKept { duration_s: 30.0, trial_s: None, margin: None, shorter_s, wider })
        };
        let both = "; give `--duration 11`, or `--output-range=-15,15`, or go without `--trials`";
        assert_eq!(why(Some(11.0), Some((-15.0, 15.0))), both);
        assert_eq!(why(None, Some((-15.0, 15.0))), "; give `--output-range=-15,15`");
        assert!(why(Some(11.0), None).ends_with("without `--trials`"));
        assert!(why(None, None).contains("`--largest`"));
    }

    #[test]
    fn lost_rows_can_be_filled_and_a_jitter_cannot() {
        assert!(on_uneven_times(0.03, 0.01).contains("--fill"));
        assert!(!on_uneven_times(0.013, 0.01).contains("--fill"));
    }
}
