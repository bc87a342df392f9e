//! The catalogue: one line for each effect.

use super::signal_gain::{is_signal_gain, signal_gain};
use super::within_trials::{OF_CONDITIONS, is_word, parts_of, within_trials};
use super::{
    AccumulatorDroop, ActuatorLag, AsymmetricFriction, AsymmetricSaturation, AsymmetricStiction,
    Backlash, CoulombFriction, Creep, DeadBand, DirectionGain, Effect, EndStop, FlowCurve,
    GravityLoad, InputOffset, InputQuantization, InputSaturation, Leakage, OilColumn, PositionGain,
    PositionRipple, RateLimit, Resonance, SpoolLag, SpoolRateLimit, Stiction, SupplyDroop,
    ThermalDrift, ValveCurve, ValveHysteresis, VariableDelay,
};
use crate::experiment::{did_you_mean, nearest_name};

/// Every built-in effect, in the order the documentation lists them.
pub const REGISTRY: &[&dyn Effect] = &[
    &InputOffset,
    &DeadBand,
    &Stiction,
    &AsymmetricStiction,
    &ValveHysteresis,
    &InputQuantization,
    &InputSaturation,
    &AsymmetricSaturation,
    &FlowCurve,
    &DirectionGain,
    &ValveCurve,
    &RateLimit,
    &SpoolRateLimit,
    &VariableDelay,
    &ActuatorLag,
    &SpoolLag,
    &Creep,
    &Resonance,
    &OilColumn,
    &CoulombFriction,
    &AsymmetricFriction,
    &GravityLoad,
    &PositionGain,
    &PositionRipple,
    &ThermalDrift,
    &SupplyDroop,
    &AccumulatorDroop,
    &Leakage,
    &EndStop,
    &Backlash,
];

/// No effect has this id.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no effect `{id}`{}", did_you_mean(nearest_name(id, [*nearest])))]
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

/// The effect with this id, built in or one of `others`; in the trials of one condition, or of one
/// measured signal, where the id says so, as `gravity_load[H]` and `signal_gain[pressure]` do.
///
/// # Errors
/// [`UnknownEffect`] when none has it.
pub(crate) fn find_among(
    id: &str,
    others: &[&'static dyn Effect],
) -> Result<&'static dyn Effect, UnknownEffect> {
    match parts_of(id) {
        Some((effect, signal)) if is_signal_gain(effect) => return Ok(signal_gain(signal)),
        Some((effect, word)) if is_word(word) => {
            let of_conditions = |known: &&dyn Effect| known.spec().id == effect;
            let known = OF_CONDITIONS.iter().copied().find(of_conditions);
            let effect = known.map_or_else(|| find_among(effect, others), Ok)?;
            return Ok(within_trials(effect, word));
        }
        _ => {}
    }
    let all = || REGISTRY.iter().chain(others).copied();
    let likeness = |known: &str| strsim::jaro_winkler(id, known);
    let ids = all().map(|effect| effect.spec().id);
    let nearest = ids.max_by(|a, b| likeness(a).total_cmp(&likeness(b))).unwrap_or_default();
    let unknown = || UnknownEffect { id: id.to_owned(), nearest };
    all().find(|effect| effect.spec().id == id).ok_or_else(unknown)
}

#[cfg(test)]
mod tests {
    use super::super::Stage;
    use super::*;

    #[test]
    fn ids_that_model_files_rely_on_are_there_in_order() {
        let promised = [
            "input_offset",
            "dead_band",
            "stiction",
            "asymmetric_stiction",
            "valve_hysteresis",
            "input_quantization",
            "input_saturation",
            "asymmetric_saturation",
            "flow_curve",
            "direction_gain",
            "valve_curve",
            "rate_limit",
            "spool_rate_limit",
            "variable_delay",
            "actuator_lag",
            "spool_lag",
            "creep",
            "resonance",
            "oil_column",
            "coulomb_friction",
            "asymmetric_friction",
            "gravity_load",
            "position_gain",
            "position_ripple",
            "thermal_drift",
            "supply_droop",
            "accumulator_droop",
            "leakage",
            "end_stop",
            "backlash",
        ];
        let ids = REGISTRY.iter().map(|effect| effect.spec().id);
        let kept: Vec<_> = ids.filter(|id| promised.contains(id)).collect();
        assert_eq!(kept, promised);
    }

    /// What a command is before it comes to the valve: a bias and rounding may act first in any model.
    #[test]
    fn a_bias_and_rounding_may_act_before_all_that_the_valve_does() {
        let passes = |first: &str, second: &str| {
            first == second || by_id(first).unwrap().spec().upstream_of.contains(&second)
        };
        for effect in REGISTRY.iter().map(|effect| effect.spec()) {
            match effect.stage {
                Stage::Input => assert!(passes("input_offset", effect.id), "{}", effect.id),
                Stage::Spool => assert!(passes("input_quantization", effect.id), "{}", effect.id),
                _ => {}
            }
        }
    }

    #[test]
    fn an_unknown_id_names_the_nearest() {
        assert_eq!(find("couloumb").unwrap_err().nearest, "coulomb_friction");
        assert_eq!(find("gravity").unwrap_err().nearest, "gravity_load");
        assert!(by_id("").is_none());
        assert_eq!(find("gravity[H]").unwrap_err().nearest, "gravity_load");
    }

    #[test]
    fn an_id_may_name_a_condition() {
        let heavy = find("gravity_load[heavy]").unwrap();
        let of = heavy.within_trials().unwrap();
        assert_eq!((of.effect.spec().id, of.word), ("gravity_load", "heavy"));
        assert_eq!(find("gain[H]").unwrap().spec().id, "gain[H]");
        assert!(find("gain").is_err());
        assert_eq!(find("gravity_load[a b]").unwrap_err().nearest, "gravity_load");
    }

    #[test]
    fn an_id_may_name_a_signal() {
        let supply = find("signal_gain[supply_pressure]").unwrap();
        assert_eq!(supply.measured_signal(), Some("supply_pressure"));
        assert!(find("signal_gain").is_err());
    }
}
