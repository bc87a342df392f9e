//! The catalogue as text for people, and schema `tauscope/effects/1`.

use serde_json::{Value, json};

use super::json::{document, joined};
use crate::effect::{Effect, Parameter, REGISTRY, Spec, UNLIMITED};
use crate::wording::lines;

/// Narrowest text, in columns: below it lines would hold a word or two.
const NARROWEST: usize = 40;

/// Columns by which everything under an effect's name is moved in.
const INDENT: usize = 4;

/// The whole catalogue as text, in lines of at most `width` columns where words allow.
pub(crate) fn listing(width: usize) -> String {
    let entries = REGISTRY.iter().map(|effect| lines_of(effect.spec(), width).join("\n"));
    entries.map(|entry| entry + "\n").collect::<Vec<_>>().join("\n")
}

/// One effect as text, with its drawing and its source.
pub(crate) fn sheet(effect: &dyn Effect, width: usize) -> String {
    let spec = effect.spec();
    let mut lines = lines_of(spec, width);
    lines.push(String::new());
    if let Some(drawing) = spec.drawing {
        lines.extend(drawing.lines().map(|line| format!("{:INDENT$}{line}", "")));
        lines.push(String::new());
    }
    lines.extend(below(&format!("source: {}", spec.source), width));
    lines.join("\n") + "\n"
}

fn lines_of(spec: &Spec, width: usize) -> Vec<String> {
    let mut texts = vec![spec.summary.to_owned(), spec.equation.to_owned()];
    texts.extend(spec.parameters.iter().map(parameter));
    if !spec.confused_with.is_empty() {
        texts.push(format!("confused with: {}", spec.confused_with.join(", ")));
    }
    if let Some(coarser) = spec.refines {
        texts.push(format!("finer form of {coarser}; tried after that was found"));
    }
    let head = format!("{} ({})", spec.id, spec.stage.id());
    let below = texts.iter().flat_map(|text| below(text, width));
    std::iter::once(head).chain(below).collect()
}

/// `upper [input unit]: upper end of the band, at least 0, neutral 0`
fn parameter(parameter: &Parameter) -> String {
    let Parameter { name, meaning, neutral, .. } = parameter;
    let unit = match unit(parameter) {
        unit if unit.is_empty() => unit,
        unit => format!(" [{unit}]"),
    };
    let neutral = if neutral.abs() < UNLIMITED {
        format!("neutral {neutral}")
    } else {
        "neutral without limit".to_owned()
    };
    let not_fitted = (!parameter.fitted).then(|| "not fitted".to_owned());
    let head = format!("{name}{unit}: {meaning}");
    let parts = [Some(head), range(parameter), Some(neutral), not_fitted];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn unit(parameter: &Parameter) -> String {
    parameter.dimension.unit(None, None)
}

fn range(parameter: &Parameter) -> Option<String> {
    let Parameter { min, max, .. } = parameter;
    match (*min > -UNLIMITED, *max < UNLIMITED) {
        (true, true) => Some(format!("{min} to {max}")),
        (true, false) => Some(format!("at least {min}")),
        (false, true) => Some(format!("at most {max}")),
        (false, false) => None,
    }
}

/// `text` below the head of a sheet.
fn below(text: &str, width: usize) -> Vec<String> {
    lines(text, width.max(NARROWEST), [INDENT, 2 * INDENT])
}

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
    use crate::effect::{InputSaturation, OilColumn, PositionGain};

    #[test]
    fn a_sheet_reads_so() {
        let expected = "\
input_saturation (input)
    flow limit, hard or with a soft knee
    abs(out) = min(abs(in), limit), rounded within limit (1
        -+ softness)
    limit [input unit]: largest magnitude that passes, at
        least 0, neutral without limit
    softness: half the width of the knee, as a part of the
        limit, 0 to 1, neutral 0
    confused with: flow_curve, rate_limit

              out |    ______ limit
                  |  .'  softness rounds the knee
                  | /
    --------------+---------- in
                / |
      ______ .'   |

    source: Jelali and Kroll, 2003, Hydraulic Servo-systems
";
        assert_eq!(sheet(&InputSaturation, 60), expected);
    }

    #[test]
    fn what_is_not_fitted_says_so() {
        let text = sheet(&PositionGain, 200);
        assert!(text.contains("slope [1/output unit]: relative change of the gain"));
        assert!(text.contains("reference [output unit]: angle at which"));
        assert!(text.contains(", not fitted\n"));
    }

    #[test]
    fn a_finer_form_says_of_what() {
        let text = sheet(&OilColumn, 200);
        assert!(text.contains("\n    finer form of resonance; tried after that was found\n"));
    }

    #[test]
    fn the_listing_keeps_the_width_and_names_all() {
        for width in [40, 80, 120] {
            let text = listing(width);
            assert!(text.lines().all(|line| line.chars().count() <= width), "{text}");
            assert!(REGISTRY.iter().all(|effect| text.contains(effect.spec().id)));
        }
    }
}

#[cfg(test)]
mod effects_tests {
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
