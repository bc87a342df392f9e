//! Joints and their trials: what drove them, what they did.

use super::record::Record;

/// One joint: what drove it and what it did, in every trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name, as in the log.
    pub name: String,
    /// Unit of the input, where the log states it.
    pub input_unit: Option<String>,
    /// Unit of the output, where the log states it.
    pub output_unit: Option<String>,
    /// Name and unit of further signals; each trial holds them in this order.
    pub covariates: Vec<Signal>,
    /// The uninterrupted runs, in the order of the log.
    pub trials: Record,
}

impl Joint {
    /// A joint without further signals, whose units are not known.
    pub fn new(name: impl Into<String>, trials: impl Into<Record>) -> Self {
        let trials = trials.into();
        let (input_unit, output_unit, covariates) = (None, None, Vec::new());
        Self { name: name.into(), input_unit, output_unit, covariates, trials }
    }

    /// This joint with the units of its input and of its output.
    #[must_use]
    pub fn with_units(self, input: impl Into<String>, output: impl Into<String>) -> Self {
        Self { input_unit: Some(input.into()), output_unit: Some(output.into()), ..self }
    }

    /// Other `trials` of this joint, without its further signals.
    pub(crate) fn of_trials(&self, trials: impl Into<Record>) -> Self {
        let (input_unit, output_unit) = (self.input_unit.clone(), self.output_unit.clone());
        Self { input_unit, output_unit, ..Self::new(self.name.clone(), trials) }
    }
}

/// Name and unit of a further measured signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signal {
    /// Name, without the joint's.
    pub name: String,
    /// Unit, where the log states it.
    pub unit: Option<String>,
}
