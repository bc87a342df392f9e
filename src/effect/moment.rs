//! What an effect is given to compute with.

/// What an effect sees of one interval of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The signal of its [`Stage`](super::Stage), after the effects before it.
    pub signal: f64,
    /// Angle of the joint, in output units.
    pub position: f64,
    /// Speed of the joint in the interval before, in output units per second.
    pub velocity: f64,
    /// Seconds since the start of the record.
    pub time_s: f64,
    /// Length of the interval in seconds, above zero.
    pub dt_s: f64,
    /// Activity of the other joints, from 0 (at rest) to 1 (all at full speed).
    pub others: f64,
    /// The measured signal on which the effect depends, where it does on one; NaN where it was
    /// not measured.
    pub measured: f64,
    /// The angle in radians of one output unit: π/180 where the output is in degrees.
    pub radians_per_output_unit: f64,
}

impl Moment {
    /// A signal over 10 ms at the start of a record, of a joint that rests at zero and is measured
    /// in degrees, beside others at rest.
    pub fn of(signal: f64) -> Self {
        Self {
            signal,
            position: 0.0,
            velocity: 0.0,
            time_s: 0.0,
            dt_s: 0.01,
            others: 0.0,
            measured: f64::NAN,
            radians_per_output_unit: 1_f64.to_radians(),
        }
    }
}

/// A change of the input, as the transport stage sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputChange {
    /// Level before, in input units.
    pub before: f64,
    /// Level after, in input units.
    pub after: f64,
    /// Seconds for which the level before was held.
    pub held_s: f64,
    /// Seconds from the start of the record to the change.
    pub time_s: f64,
}
