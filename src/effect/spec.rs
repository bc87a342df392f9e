//! What an effect says about itself, as data.

use serde::{Deserialize, Serialize};

use super::RecordRange;

/// Stands for "no limit" in a parameter, in any unit: finite, so that it can be written
/// to a file and computed with, and far from anything a joint reaches.
pub const UNLIMITED: f64 = 1e12;

/// What an effect is, where it acts, and its parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spec {
    /// Its name in files and on the command line, in snake case.
    pub id: &'static str,
    /// What it is, in one sentence without a full stop.
    pub summary: &'static str,
    /// Its equation in one line, with the names of the parameters.
    pub equation: &'static str,
    /// Where the equation comes from: author, year, title.
    pub source: &'static str,
    /// Where it acts.
    pub stage: Stage,
    /// The shape of a nonlinearity, in plain text.
    pub drawing: Option<&'static str>,
    /// Its parameters, in the order [`step`](super::Effect::step) takes them.
    pub parameters: &'static [Parameter],
    /// How many numbers it remembers.
    pub memory: usize,
    /// Ids of effects that look alike in a record.
    pub confused_with: &'static [&'static str],
    /// Ids of effects that it contains: to add it to a model is to put it in their
    /// place, with their values for the parameters of the same name.
    pub absorbs: &'static [&'static str],
    /// Id of an effect of which it is a finer form: where that is looked for, too, this one is
    /// only in models that have that.
    pub refines: Option<&'static str>,
    /// Whether an effect on the output changes where the joint is, and not only what
    /// is measured of it.
    pub acts_on_state: bool,
}

impl Spec {
    /// The neutral values of all parameters.
    pub fn neutral(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.neutral).collect()
    }
}

/// Where an effect acts, in the order the stages are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// On the time at which a change of the input arrives.
    Transport,
    /// On the delayed input, in input units, without memory of time.
    Input,
    /// On the effective input, in input units, as it changes with time. The gain
    /// follows.
    Dynamics,
    /// On the speed, in output units per second.
    Load,
    /// On the angle, in output units.
    Output,
}

impl Stage {
    /// Its name in files and tables.
    pub fn id(self) -> &'static str {
        match self {
            Self::Transport => "transport",
            Self::Input => "input",
            Self::Dynamics => "dynamics",
            Self::Load => "load",
            Self::Output => "output",
        }
    }
}

/// The unit of a parameter, in terms of the units of the log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Dimension {
    /// A number without a unit.
    #[default]
    One,
    /// Seconds.
    Seconds,
    /// 1 / s.
    PerSecond,
    /// Input units.
    Input,
    /// 1 / input unit.
    PerInput,
    /// Seconds per input unit.
    SecondsPerInput,
    /// Output units.
    Output,
    /// Output units per second.
    OutputPerSecond,
    /// 1 / output unit.
    PerOutput,
    /// 1 / output unit².
    PerOutputSquared,
}

impl Dimension {
    /// Its name in files.
    pub fn id(self) -> &'static str {
        match self {
            Self::One => "one",
            Self::Seconds => "seconds",
            Self::PerSecond => "per_second",
            Self::Input => "input",
            Self::PerInput => "per_input",
            Self::SecondsPerInput => "seconds_per_input",
            Self::Output => "output",
            Self::OutputPerSecond => "output_per_second",
            Self::PerOutput => "per_output",
            Self::PerOutputSquared => "per_output_squared",
        }
    }

    /// The unit in words, `input` and `output` being the units of the log: `s/V`.
    ///
    /// Empty for a number without a unit.
    pub fn unit(self, input: Option<&str>, output: Option<&str>) -> String {
        let input = input.unwrap_or("input unit");
        let output = output.unwrap_or("output unit");
        match self {
            Self::One => String::new(),
            Self::Seconds => "s".to_owned(),
            Self::PerSecond => "1/s".to_owned(),
            Self::Input => input.to_owned(),
            Self::PerInput => format!("1/{input}"),
            Self::SecondsPerInput => format!("s/{input}"),
            Self::Output => output.to_owned(),
            Self::OutputPerSecond => format!("{output}/s"),
            Self::PerOutput => format!("1/{output}"),
            Self::PerOutputSquared => format!("1/{output}^2"),
        }
    }
}

/// One parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name in files, in snake case.
    pub name: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// Its unit.
    pub dimension: Dimension,
    /// The value at which, with the others at theirs, the effect changes nothing.
    pub neutral: f64,
    /// Lowest value allowed.
    pub min: f64,
    /// Highest value allowed.
    pub max: f64,
    /// How far from neutral a fit starts, in parts of
    /// [`RecordRange::size`] of its dimension.
    pub typical: f64,
    /// Whether a fit may change it. If not it is a choice, such as a reference angle,
    /// and stays where the start put it.
    pub fitted: bool,
}

impl Parameter {
    /// A parameter that is neutral at zero, without limits.
    pub const fn new(name: &'static str, meaning: &'static str, dimension: Dimension) -> Self {
        let (min, max) = (-UNLIMITED, UNLIMITED);
        Self { name, meaning, dimension, neutral: 0.0, min, max, typical: 0.1, fitted: true }
    }

    /// The same between `min` and `max`.
    #[must_use]
    pub const fn between(self, min: f64, max: f64) -> Self {
        Self { min, max, ..self }
    }

    /// The same, neutral at `neutral`.
    #[must_use]
    pub const fn neutral(self, neutral: f64) -> Self {
        Self { neutral, ..self }
    }

    /// The same with another distance from neutral to start at.
    #[must_use]
    pub const fn typical(self, typical: f64) -> Self {
        Self { typical, ..self }
    }

    /// The same, left alone by a fit.
    #[must_use]
    pub const fn not_fitted(self) -> Self {
        Self { fitted: false, ..self }
    }

    /// Its own limits, narrowed to what a record of this size can tell.
    pub fn bounds(&self, record: &RecordRange<'_>) -> (f64, f64) {
        let (low, high) = record.extent(self.dimension);
        let (low, high) = (low.max(self.min), high.min(self.max));
        if low < high { (low, high) } else { (self.min, self.max) }
    }

    /// Neutral plus a typical distance, within its bounds.
    pub fn start(&self, record: &RecordRange<'_>) -> f64 {
        let (low, high) = self.bounds(record);
        (self.neutral + self.typical * record.size(self.dimension)).max(low).min(high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_those_of_the_log() {
        let unit = |dimension: Dimension| dimension.unit(Some("V"), Some("deg"));
        assert_eq!(unit(Dimension::SecondsPerInput), "s/V");
        assert_eq!(unit(Dimension::PerOutputSquared), "1/deg^2");
        assert_eq!(unit(Dimension::One), "");
        assert_eq!(Dimension::Input.unit(None, None), "input unit");
    }

    #[test]
    fn names_are_those_of_the_data() {
        for dimension in [Dimension::One, Dimension::SecondsPerInput, Dimension::PerOutputSquared] {
            assert_eq!(serde_json::to_value(dimension).unwrap(), dimension.id());
        }
    }

    #[test]
    fn bounds_are_as_wide_as_the_record_but_within_the_own_limits() {
        let record = RecordRange { input_abs_max: 5.0, ..RecordRange::default() };
        let parameter = Parameter::new("upper", "", Dimension::Input).between(0.0, UNLIMITED);
        assert_eq!(parameter.bounds(&record), (0.0, 5.0));
        assert!((parameter.start(&record) - 0.5).abs() < 1e-12);
        assert_eq!(parameter.typical(9.0).start(&record).to_bits(), 5.0_f64.to_bits());
    }
}
