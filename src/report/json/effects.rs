//! Schema `tauscope/effects/1`: the catalogue.

use serde::Serialize;

use super::header::Header;
use crate::effect::{Effect, Parameter, Spec};

/// The document of `effects --format json`.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct EffectsJson {
    #[serde(flatten)]
    header: Header,
    effects: Vec<EffectJson>,
}

#[derive(Clone, Debug, Serialize)]
struct EffectJson {
    id: &'static str,
    summary: &'static str,
    equation: &'static str,
    source: &'static str,
    stage: &'static str,
    drawing: Option<&'static str>,
    parameters: Vec<ParameterJson>,
    memory: usize,
    confused_with: &'static [&'static str],
    absorbs: &'static [&'static str],
    refines: Option<&'static str>,
    acts_on_state: bool,
    units: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
struct ParameterJson {
    name: &'static str,
    meaning: &'static str,
    dimension: &'static str,
    neutral: f64,
    min: f64,
    max: f64,
    typical: f64,
    fitted: bool,
}

impl EffectsJson {
    /// Collects `effects`; `units` are in the order of the parameters.
    pub(crate) fn new(effects: &[&dyn Effect]) -> Self {
        let effects = effects.iter().map(|effect| effect.spec().into()).collect();
        Self { header: Header::of("tauscope/effects/1"), effects }
    }
}

impl From<&'static Spec> for EffectJson {
    fn from(spec: &'static Spec) -> Self {
        let unit = |parameter: &Parameter| parameter.dimension.unit(None, None);
        Self {
            id: spec.id,
            summary: spec.summary,
            equation: spec.equation,
            source: spec.source,
            stage: spec.stage.id(),
            drawing: spec.drawing,
            parameters: spec.parameters.iter().map(Into::into).collect(),
            memory: spec.memory,
            confused_with: spec.confused_with,
            absorbs: spec.absorbs,
            refines: spec.refines,
            acts_on_state: spec.acts_on_state,
            units: spec.parameters.iter().map(unit).collect(),
        }
    }
}

impl From<&Parameter> for ParameterJson {
    fn from(parameter: &Parameter) -> Self {
        let &Parameter { name, meaning, neutral, min, max, typical, fitted, .. } = parameter;
        let dimension = parameter.dimension.id();
        Self { name, meaning, dimension, neutral, min, max, typical, fitted }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::REGISTRY;

    #[test]
    fn the_data_have_a_schema_and_units() {
        let json = serde_json::to_value(EffectsJson::new(REGISTRY)).unwrap();
        assert_eq!(json["schema"], "tauscope/effects/1");
        let effects = json["effects"].as_array().unwrap();
        let of = |id: &str| effects.iter().find(|effect| effect["id"] == id).unwrap();
        assert_eq!(of("variable_delay")["units"][0], "s/input unit");
        assert_eq!(of("variable_delay")["parameters"][0]["dimension"], "seconds_per_input");
        assert_eq!(of("end_stop")["parameters"][1]["neutral"], 1e12);
    }
}
