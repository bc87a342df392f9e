//! By what rules models are judged.

use clap::Args;

use super::data::DataArgs;
use crate::cli::typed::quoted;
use crate::experiment::Joint;
use crate::fit::{Horizon, Split};
use crate::study::{Mode, Protocol};

/// By what rules models are judged.
#[derive(Args, Debug)]
#[command(next_help_heading = "Which model, and how it is fitted")]
pub(crate) struct ProtocolArgs {
    /// How long a simulation runs before its angle is set to the measured one: `free`
    /// (never), `steps` (at every step of the input, in long holds every 2 s), seconds, or
    /// `auto`: free where the output follows its input, as a speed or a pressure does, else steps,
    /// where an error counts where it is made [default: auto]
    #[arg(long, value_name = "auto|free|steps|SECONDS", value_parser = horizon)]
    horizon: Option<Horizon>,

    /// Share of each trial's time that is for training; `blocks`: every third block of four runs
    /// is for validation; or `trials`: every third trial is [default: trials from six on, else
    /// blocks]
    #[arg(long, value_name = "SHARE|blocks|trials", value_parser = split)]
    split: Option<Split>,
}

impl ProtocolArgs {
    /// The rules, with this mode.
    pub(crate) fn with(&self, mode: Mode) -> Protocol {
        Protocol { mode, split: self.split, horizon: self.horizon.unwrap_or(Horizon::Auto) }
    }
}

/// What follows the effect in the command that adds it to the model of a joint, for each of
/// `joints`; the model is in the file `model`.
pub(crate) fn add_arguments(data: &DataArgs, model: &str, joints: &[Joint]) -> Vec<String> {
    let of_joint = |joint: &Joint| {
        let one_of_several = (joints.len() > 1).then_some(joint.name.as_str());
        let mut words = data.words(one_of_several, &["horizon", "split"]);
        words.extend(["--model".to_owned(), model.to_owned()]);
        quoted(&words)
    };
    joints.iter().map(of_joint).collect()
}

fn horizon(text: &str) -> Result<Horizon, String> {
    match text {
        "auto" => Ok(Horizon::Auto),
        "free" => Ok(Horizon::FreeRun),
        "steps" => Ok(Horizon::Steps),
        _ => {
            let seconds = text.parse().ok().filter(|s: &f64| s.is_finite() && *s > 0.0);
            seconds
                .map(Horizon::Seconds)
                .ok_or_else(|| "expected auto, free, steps, or seconds".to_owned())
        }
    }
}

fn split(text: &str) -> Result<Split, String> {
    match text {
        "blocks" => return Ok(Split::Blocks),
        "trials" => return Ok(Split::Trials),
        _ => {}
    }
    let share = text.parse().ok().filter(|share: &f64| *share > 0.0 && *share <= 1.0);
    share
        .map(Split::Time)
        .ok_or_else(|| "expected a share above 0 and up to 1, blocks, or trials".to_owned())
}
