//! The catalogue of physical effects of hydraulic robot joints.
//!
//! The nominal joint integrates, `y' = gain · u(t − delay)`; an effect is what makes a
//! real one differ. Each is one file with its equation, its source and a unit struct
//! that implements [`Effect`]; [`REGISTRY`] holds them all. Whoever lists, ranks or
//! tests effects goes through the registry and knows none of them by name.
//!
//! An effect keeps no state of its own. It is a function of its parameters, of the
//! [`Moment`] and of a few numbers of memory that the caller owns, so that one effect
//! can serve many simulations at once. At its neutral parameters it changes nothing:
//! models with and without it nest.
//!
//! Within one simulated interval the delayed input is constant. It runs through the
//! stages in the order of [`Stage`].
//!
//! What is not here: the joint that the effects act on, its simulation and its fit.

pub mod actuator_lag;
pub mod backlash;
pub mod contract;
pub mod coulomb_friction;
pub mod dead_band;
mod decay;
pub mod direction_gain;
pub mod end_stop;
pub mod expression;
pub mod flow_curve;
pub mod gravity_load;
pub mod input_offset;
pub mod input_saturation;
pub mod leakage;
mod listing;
pub mod oil_column;
pub mod placebo;
pub mod position_gain;
pub mod rate_limit;
mod record;
pub mod resonance;
mod spec;
pub mod stiction;
pub mod supply_droop;
mod swing;
#[cfg(test)]
mod testing;
pub mod thermal_drift;
pub mod variable_delay;

use std::fmt::Debug;

pub use actuator_lag::ActuatorLag;
pub use backlash::Backlash;
pub use coulomb_friction::CoulombFriction;
pub use dead_band::DeadBand;
pub use direction_gain::DirectionGain;
pub use end_stop::EndStop;
pub use flow_curve::FlowCurve;
pub use gravity_load::GravityLoad;
pub use input_offset::InputOffset;
pub use input_saturation::InputSaturation;
pub use leakage::Leakage;
pub use listing::{EffectsJson, listing, sheet};
pub use oil_column::OilColumn;
pub use placebo::Placebo;
pub use position_gain::PositionGain;
pub use rate_limit::RateLimit;
pub use record::RecordRange;
pub use resonance::Resonance;
pub use spec::{Dimension, Parameter, Spec, Stage, UNLIMITED};
pub use stiction::Stiction;
pub use supply_droop::SupplyDroop;
pub use thermal_drift::ThermalDrift;
pub use variable_delay::VariableDelay;

/// Every built-in effect, in the order the documentation lists them.
pub const REGISTRY: &[&dyn Effect] = &[
    &InputOffset,
    &DeadBand,
    &Stiction,
    &InputSaturation,
    &FlowCurve,
    &DirectionGain,
    &RateLimit,
    &VariableDelay,
    &ActuatorLag,
    &Resonance,
    &OilColumn,
    &CoulombFriction,
    &GravityLoad,
    &PositionGain,
    &ThermalDrift,
    &SupplyDroop,
    &Leakage,
    &EndStop,
    &Backlash,
];

/// One physical effect.
///
/// The caller passes as many parameters and numbers of memory as the [`Spec`] says;
/// with another number an effect returns the signal unchanged.
pub trait Effect: Debug + Send + Sync {
    /// What it is, where it acts, and its parameters.
    fn spec(&self) -> &'static Spec;

    /// The signal after this effect; `at.signal` itself at the neutral parameters.
    ///
    /// Fresh memory is all zeros: at rest with no signal. In the dynamics stage the
    /// result is the mean of the effect's output over the interval `at.dt_s`, in which
    /// the signal is constant, and the memory then holds the state at its end. In the
    /// other stages it is the value at this moment.
    fn step(&self, parameters: &[f64], memory: &mut [f64], at: &Moment) -> f64;

    /// Puts the memory into the state it has when `at.signal` has long been held.
    fn settle(&self, _parameters: &[f64], _memory: &mut [f64], _at: &Moment) {}

    /// Seconds by which a change of the input arrives later than the joint's delay.
    ///
    /// May be negative; the caller keeps the whole delay at zero or above.
    fn extra_delay_s(&self, _parameters: &[f64], _change: &InputChange) -> f64 {
        0.0
    }

    /// Parameters with which each step's own delay, as it was measured, takes the place of the
    /// joint's; `None` where it has no such form.
    fn measured_delays(&self) -> Option<Vec<f64>> {
        None
    }

    /// Whether `parameters` are of that form.
    fn takes_measured_delays(&self, _parameters: &[f64]) -> bool {
        false
    }

    /// Whether it has neutral parameters, at which it changes nothing.
    ///
    /// If not, a model with it and the same without are not nested: one is not a special
    /// case of the other.
    fn nests(&self) -> bool {
        true
    }

    /// Whether a joint with it moves otherwise from another angle.
    ///
    /// A fit need not find the angle at which a record starts where nothing depends on it.
    fn depends_on_angle(&self) -> bool {
        matches!(self.spec().stage, Stage::Load | Stage::Output)
    }

    /// Whether a joint with it moves otherwise while other joints move.
    ///
    /// A record of one joint alone cannot show such an effect.
    fn depends_on_others(&self) -> bool {
        false
    }

    /// Whether a joint with it moves otherwise when the machine has worked for a while.
    fn depends_on_warmth(&self) -> bool {
        false
    }

    /// How a model file defines it, where it is not an effect of the program.
    fn definition(&self) -> Option<&expression::Definition> {
        None
    }

    /// Lowest and highest value of each parameter that a fit to `record` should try.
    ///
    /// They lie within those of the [`Spec`]; the neutral value may lie outside, where
    /// a value at the bound has no effect on this record either.
    fn bounds(&self, record: &RecordRange<'_>) -> Vec<(f64, f64)> {
        self.spec().parameters.iter().map(|parameter| parameter.bounds(record)).collect()
    }

    /// Parameters from which a fit to `record` may find the best ones.
    ///
    /// Several where the error has several valleys. They need not keep the bounds; a fit
    /// takes [`starts`](Self::starts).
    fn guesses(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        vec![self.spec().parameters.iter().map(|parameter| parameter.start(record)).collect()]
    }

    /// Where a fit to `record` should start: the [`guesses`](Self::guesses), each value
    /// moved into its [`bounds`](Self::bounds).
    fn starts(&self, record: &RecordRange<'_>) -> Vec<Vec<f64>> {
        let bounds = self.bounds(record);
        let mut starts = self.guesses(record);
        for start in &mut starts {
            for (value, (low, high)) in start.iter_mut().zip(&bounds) {
                *value = value.max(*low).min(*high);
            }
        }
        starts
    }
}

/// What an effect sees of one interval of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The signal of its [`Stage`], after the effects before it.
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
    /// The angle in radians of one output unit: π/180 where the output is in degrees.
    pub radians_per_output_unit: f64,
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

/// No effect has this id.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no effect `{id}`; the nearest is `{nearest}`")]
pub struct UnknownEffect {
    /// What was asked for.
    pub id: String,
    /// The id that is most like it.
    pub nearest: &'static str,
}

/// The built-in effect with this id.
pub fn by_id(id: &str) -> Option<&'static dyn Effect> {
    REGISTRY.iter().copied().find(|effect| effect.spec().id == id)
}

/// The built-in effect with this id, or an error that names the nearest.
///
/// # Errors
/// [`UnknownEffect`] when no built-in effect has it.
///
/// # Examples
/// ```
/// use tauscope::effect::find;
/// assert_eq!(find("dead_band")?.spec().parameters.len(), 2);
/// assert_eq!(find("deadband").unwrap_err().nearest, "dead_band");
/// # Ok::<(), tauscope::effect::UnknownEffect>(())
/// ```
pub fn find(id: &str) -> Result<&'static dyn Effect, UnknownEffect> {
    find_among(id, &[])
}

/// The effect with this id, built in or one of `others`.
///
/// # Errors
/// [`UnknownEffect`] when none has it.
pub fn find_among(
    id: &str,
    others: &[&'static dyn Effect],
) -> Result<&'static dyn Effect, UnknownEffect> {
    let all = || REGISTRY.iter().chain(others).copied();
    let likeness = |known: &str| strsim::jaro_winkler(id, known);
    let ids = all().map(|effect| effect.spec().id);
    let nearest = ids.max_by(|a, b| likeness(a).total_cmp(&likeness(b))).unwrap_or_default();
    let unknown = || UnknownEffect { id: id.to_owned(), nearest };
    all().find(|effect| effect.spec().id == id).ok_or_else(unknown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_catalogue_is_the_documented_one() {
        let documented = [
            "input_offset",
            "dead_band",
            "stiction",
            "input_saturation",
            "flow_curve",
            "direction_gain",
            "rate_limit",
            "variable_delay",
            "actuator_lag",
            "resonance",
            "oil_column",
            "coulomb_friction",
            "gravity_load",
            "position_gain",
            "thermal_drift",
            "supply_droop",
            "leakage",
            "end_stop",
            "backlash",
        ];
        let ids: Vec<_> = REGISTRY.iter().map(|effect| effect.spec().id).collect();
        assert_eq!(ids, documented);
    }

    #[test]
    fn an_unknown_id_names_the_nearest() {
        assert_eq!(find("couloumb").unwrap_err().nearest, "coulomb_friction");
        assert_eq!(find("gravity").unwrap_err().nearest, "gravity_load");
        assert!(by_id("").is_none());
    }
}
