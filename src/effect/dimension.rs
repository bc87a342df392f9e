//! The unit of a parameter, whatever the units of the log.

use serde::Serialize;

/// The unit of a parameter, in terms of the units of the log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
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
    /// 1 / output unit³.
    PerOutputCubed,
    /// Units of the measured signal on which the effect depends.
    Signal,
    /// 1 / unit of that signal.
    PerSignal,
}

impl Dimension {
    /// All dimensions of parameters that a user's own effect may have.
    pub const ALL: [Self; 11] = [
        Self::One,
        Self::Seconds,
        Self::PerSecond,
        Self::Input,
        Self::PerInput,
        Self::SecondsPerInput,
        Self::Output,
        Self::OutputPerSecond,
        Self::PerOutput,
        Self::PerOutputSquared,
        Self::PerOutputCubed,
    ];

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
            Self::PerOutputCubed => "per_output_cubed",
            Self::Signal => "signal",
            Self::PerSignal => "per_signal",
        }
    }

    /// The unit in words, `input` and `output` being the units of the log: `s/V`. That of a
    /// [signal](Self::of_signal) is not known here.
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
            Self::PerOutputCubed => format!("1/{output}^3"),
            Self::Signal | Self::PerSignal => self.of_signal(None),
        }
    }

    /// The unit in words of what depends on a measured signal with this unit; that of anything else
    /// is empty.
    pub fn of_signal(self, signal: Option<&str>) -> String {
        let signal = signal.unwrap_or("signal unit");
        match self {
            Self::Signal => signal.to_owned(),
            Self::PerSignal => format!("1/{signal}"),
            _ => String::new(),
        }
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
}
