//! Schema `tauscope/effects/1`: the catalogue.

use serde_json::{Value, json};

use super::document::{document, joined};
use crate::effect::{Effect, Parameter};

/// The document of `effects --format json`; `units` are in the order of the parameters.
pub(crate) fn effects_json(effects: &[&dyn Effect]) -> Value {
    let effects: Value = effects.iter().map(|effect| effect_json(*effect)).collect();
    document("tauscope/effects/1", json!({ "effects": effects }))
}

fn effect_json(effect: &dyn Effect) -> Value {
    let spec = effect.spec();
    let unit = |parameter: &Parameter| parameter.dimension.unit(None, None);
    let units: Vec<_> = spec.parameters.iter().map(unit).collect();
    joined([json!(spec), json!({ "units": units })])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::REGISTRY;

    #[test]
    fn the_data_have_a_schema_and_units() {
        let json = effects_json(REGISTRY);
        assert_eq!(json["schema"], "tauscope/effects/1");
        let effects = json["effects"].as_array().unwrap();
        let of = |id: &str| effects.iter().find(|effect| effect["id"] == id).unwrap();
        assert_eq!(of("variable_delay")["units"][0], "s/input unit");
        assert_eq!(of("variable_delay")["parameters"][0]["dimension"], "seconds_per_input");
        assert_eq!(of("end_stop")["parameters"][1]["neutral"], 1e12);
    }
}
