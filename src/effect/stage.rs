//! Where an effect acts.

use serde::Serialize;

/// Where an effect acts, in the order the stages are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// On the time at which a change of the input arrives.
    Transport,
    /// On the delayed input, in input units, as the spool follows it with time.
    Spool,
    /// On the opening of the spool, in input units, without memory of time.
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
    /// All stages, in the order they are computed.
    pub const ALL: [Self; 6] =
        [Self::Transport, Self::Spool, Self::Input, Self::Dynamics, Self::Load, Self::Output];

    /// Its name in files and tables.
    pub fn id(self) -> &'static str {
        match self {
            Self::Transport => "transport",
            Self::Spool => "spool",
            Self::Input => "input",
            Self::Dynamics => "dynamics",
            Self::Load => "load",
            Self::Output => "output",
        }
    }
}
