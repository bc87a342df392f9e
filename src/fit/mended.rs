//! What models are compared with: a record without what its sensors added.

use crate::delay::held_inputs;
use crate::experiment::{Property, Record, Spikes, Trial};

/// What models are compared with in a record.
#[derive(Debug)]
pub(crate) struct Mended {
    /// The record with lines in the place of the spikes of its output, and with the levels that its
    /// input holds in the place of its noise, which a model would take for changes of the command; none
    /// where it has neither.
    pub(super) record: Option<Record>,
    /// Per trial and sample 0 for a spike of the sensor or what was not logged, and else 1; none
    /// where all are 1.
    pub(super) weights: Option<Vec<Vec<f64>>>,
    /// Whether the input has noise or glitches.
    pub(crate) has_noisy_input: bool,
}

impl Property for Mended {
    fn find(record: &Record) -> Self {
        let spikes = Spikes::of(record);
        let without_spikes = spikes.taken_out(record);
        let inputs = held_inputs(record);
        let has_noisy_input = inputs.is_some();
        let mended = match inputs {
            None => without_spikes,
            Some(inputs) => {
                let trials = without_spikes.as_ref().unwrap_or(record).iter().zip(inputs);
                let held = |(trial, input): (&Trial, _)| trial.clone().with_input(input);
                Some(trials.map(held).collect())
            }
        };
        Self { record: mended, weights: spikes.weights(record), has_noisy_input }
    }
}
