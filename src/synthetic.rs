//! Logs of joints with known delays and effects: the crate `tauscope-synthetic`, whose records are
//! joints here. Nothing of it is used by what is estimated, nor the other way round.
//!
//! # Examples
//! ```
//! use tauscope::synthetic::{DelayLaw, InputSpec, JointSpec, PlantSpec, simulate};
//!
//! let input = InputSpec::Levels { levels: vec![-1.0, 1.0], hold_s: [1.0, 2.0] };
//! let delay = DelayLaw::Uniform { min: 0.05, max: 0.3 };
//! let made = simulate(&PlantSpec::new(1, 60.0, vec![JointSpec::new("elbow", input, delay)]))?;
//! assert_eq!(made.joints[0].trials[0].len(), 6000);
//! assert!(made.truth.iter().all(|step| (0.05..0.3).contains(&step.delay_s)));
//! # Ok::<(), tauscope::synthetic::PlantError>(())
//! ```

use std::io::Write;

pub use tauscope_synthetic::{
    CylinderSpec, DelayLaw, InputSpec, JointSpec, Part, Place, PlantError, PlantSpec, Ringing,
    SCHEMA, Spikes, StepTruth, effects, scenario, write_truth,
};
use tauscope_synthetic::{Recorded, Simulated, TRIAL};

use crate::experiment::{Joint, Trial};
use crate::units::SamplePeriod;

/// Simulated joints and the truth about them.
#[derive(Clone, Debug, PartialEq)]
pub struct Synthetic {
    /// The joints in the order of the plant, each with one trial labelled `1`.
    pub joints: Vec<Joint>,
    /// The steps of the first joint in the order of time, those of the second, …
    pub truth: Vec<StepTruth>,
}

impl From<Simulated> for Synthetic {
    fn from(made: Simulated) -> Self {
        Self { joints: made.joints.into_iter().map(joint).collect(), truth: made.truth }
    }
}

/// Drives the joints of `spec` and records them, as [`tauscope_synthetic::simulate`] does.
///
/// # Errors
/// [`PlantError`].
pub fn simulate(spec: &PlantSpec) -> Result<Synthetic, PlantError> {
    tauscope_synthetic::simulate(spec).map(Synthetic::from)
}

/// Writes the first trial of each joint as one CSV table, as long as the first joint's and with
/// times from its first sample on, as [`tauscope_synthetic::write_log`] does.
///
/// # Errors
/// What writing to `out` gives.
pub fn write_log(made: &Synthetic, out: impl Write) -> Result<(), csv::Error> {
    let joints: Vec<_> = made.joints.iter().filter_map(recorded).collect();
    tauscope_synthetic::write_log(&joints, out)
}

/// A record as a joint. Its samples are finite and as many of input as of output, so that they
/// make a trial.
fn joint(made: Recorded) -> Joint {
    let trial = SamplePeriod::from_seconds(made.period_s)
        .and_then(|period| Trial::new(TRIAL, 0.0, period, made.input, made.output).ok());
    Joint::new(made.name, trial.into_iter().collect::<Vec<_>>())
        .with_units(made.input_unit, made.output_unit)
}

/// The first trial of a joint as a record.
fn recorded(joint: &Joint) -> Option<Recorded> {
    let trial = joint.trials.first()?;
    Some(Recorded {
        name: joint.name.clone(),
        input_unit: joint.input_unit.clone().unwrap_or_default(),
        output_unit: joint.output_unit.clone().unwrap_or_default(),
        period_s: trial.period().seconds(),
        input: trial.input().to_vec(),
        output: trial.output().to_vec(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_a_joint_and_back() {
        let input = InputSpec::Steps { steps: vec![(2, 0.5)], initial: 0.1 };
        let spec = JointSpec::new("arm", input, DelayLaw::Constant { seconds: 0.0 });
        let made = tauscope_synthetic::simulate(&PlantSpec::new(1, 0.05, vec![spec])).unwrap();
        let synthetic = Synthetic::from(made.clone());
        assert_eq!(synthetic.joints[0].trials[0].label(), "1");
        assert_eq!(synthetic.joints.iter().filter_map(recorded).collect::<Vec<_>>(), made.joints);
    }
}
