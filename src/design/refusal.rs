//! Why no random steps are planned, and what would do.

use crate::numerics::{decimal_exponent, to_multiple};

/// Why there are no such steps.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Fewer than two levels.
    #[error("fewer than two levels are left; an input needs at least two different ones")]
    TooFewLevels,
    /// No hold fits after the rest with which an input begins.
    #[error("an input of {duration_s} s is too short for a rest and a hold of {hold_s} s after it")]
    HoldTooLong {
        /// The shortest hold, seconds.
        hold_s: f64,
        /// The whole input, seconds.
        duration_s: f64,
    },
    /// Nothing is known of how far predictions are off.
    #[error("the log is too short to show how far predictions of the joint are off")]
    ErrorUnknown,
    /// The range lies where the joint has not been.
    #[error(
        "no input is planned from {} to {}: the log shows the joint only from {} to {}, and nothing \
         is known of it elsewhere",
        rounded(.range.0), rounded(.range.1), rounded(.extent.0), rounded(.extent.1)
    )]
    Elsewhere {
        /// The range.
        range: (f64, f64),
        /// Lowest and highest output of the log.
        extent: (f64, f64),
    },
    /// Fewer than two inputs of the log let an output that regulates itself rest in the range.
    #[error(
        "no input is planned from {} to {}: the output regulates itself, and fewer than two inputs \
         of the log let it rest there{}: it rests at {}",
        rounded(.range.0), rounded(.range.1), with_margin(*.margin), rounded_list(.outputs)
    )]
    SettlesElsewhere {
        /// The range.
        range: (f64, f64),
        /// How far a prediction may be off, output units.
        margin: f64,
        /// Where it rests at the levels of the log, output units.
        outputs: Vec<f64>,
    },
    /// The log has inputs of one sign only, and no model of it leads back.
    #[error(
        "no input is planned from {} to {}: the log has {} inputs only, so it does not show how \
         to drive the joint back",
        rounded(.range.0), rounded(.range.1), if *.is_positive { "positive" } else { "negative" }
    )]
    OneSign {
        /// The range.
        range: (f64, f64),
        /// Which sign they have, about rest.
        is_positive: bool,
    },
    /// It starts too near to an end of the range, or beyond.
    #[error(
        "a start at {start} is too near to the ends of the range, {} to {}, or beyond",
        rounded(.range.0), rounded(.range.1)
    )]
    Start {
        /// Where it starts.
        start: f64,
        /// Where the joint may be.
        range: (f64, f64),
    },
    /// The range cannot be kept.
    #[error("the range {} to {} {}", rounded(.range.0), rounded(.range.1), .why)]
    NotKept {
        /// The range.
        range: (f64, f64),
        /// Why, and what would do.
        why: NotKept,
    },
}

/// Why a range cannot be kept, and what would do.
#[derive(Clone, Debug, PartialEq)]
pub struct NotKept {
    /// How long it was to be kept, seconds.
    pub duration_s: f64,
    /// The shortest trial in which it was to be kept, seconds, where it might have several.
    pub trial_s: Option<f64>,
    /// How far a prediction may be off after that time even if the joint rests, output units, where
    /// a log shows that.
    pub margin: Option<f64>,
    /// A length for which the range can be kept in one trial, seconds, where one was asked for.
    pub shorter_s: Option<f64>,
    /// A range that can be kept for the whole time.
    pub wider: Option<(f64, f64)>,
}

impl std::fmt::Display for NotKept {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { duration_s, trial_s, margin, shorter_s, wider } = self;
        write!(f, "cannot be kept for {duration_s} s")?;
        if let Some(trial_s) = trial_s {
            write!(f, ", nor in trials of {} s", rounded(*trial_s))?;
        }
        if let Some(margin) = margin {
            let margin = rounded(*margin);
            write!(f, ": a prediction of this joint may be off by {margin} after that time")?;
        }
        match (shorter_s, wider) {
            (None, None) => f.write_str("; neither a shorter input nor a wider range helps"),
            _ => Ok(()),
        }
    }
}

/// `x` to four digits, as it is typed; whole digits are all kept.
pub(crate) fn rounded(x: f64) -> f64 {
    to_multiple(x, decimal_exponent(x.abs().max(f64::MIN_POSITIVE)).clamp(-9, 3) - 3)
}

fn with_margin(margin: f64) -> String {
    if margin > 0.0 { format!(" with a margin of {}", rounded(margin)) } else { String::new() }
}

fn rounded_list(values: &[f64]) -> String {
    values.iter().map(|x| rounded(*x).to_string()).collect::<Vec<_>>().join(", ")
}
