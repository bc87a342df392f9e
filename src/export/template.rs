//! Templates that are filled in with a model.

use std::collections::BTreeSet;

use minijinja::syntax::SyntaxConfig;
use minijinja::{AutoEscape, Environment, Value, context};

use super::description::{Export, Exported, Parameter};
use super::error::ExportError;
use super::notation::{Notation, lines, result};
use crate::effect::Stage;
use crate::effect::expression::Program;

/// `template` with the values of `context` filled in; `plain` makes of a text of the user's one that ends
/// no comment.
pub(crate) fn filled(
    template: &str,
    plain: fn(&str) -> String,
    context: &Value,
) -> Result<String, ExportError> {
    let problem = |error: minijinja::Error| ExportError::Template { problem: error.to_string() };
    let mut syntax = SyntaxConfig::builder();
    syntax.trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(true);
    let mut environment = Environment::new();
    environment.set_syntax(syntax.build().map_err(problem)?);
    environment.set_auto_escape_callback(|_| AutoEscape::None);
    environment.add_filter("plain", move |text: &str| plain(text));
    environment.render_str(template, context.clone()).map_err(problem)
}

/// What the templates say of a joint.
pub(super) fn joint(notation: Notation, export: &Export, name: &str) -> Value {
    let Export { joint, origin, units, parameters, effects } = export;
    let program = |effect: &Exported, program: &Program| {
        let lines = lines(notation, effect, program);
        context! { lines => lines, result => result(program) }
    };
    let effect = |effect: &Exported| {
        let Exported { id, summary, equation, .. } = effect;
        let (settle, step) = (program(effect, &effect.settle), program(effect, &effect.step));
        context! { id, summary, equation, settle, step }
    };
    let values = |effects: &mut dyn Iterator<Item = &Exported>| effects.map(effect).collect();
    let of_stage = |stage| -> Vec<Value> { values(&mut export.stage(stage)) };
    let [drive, limits, sensor]: [Vec<Value>; 3] =
        [values(&mut export.drive()), values(&mut export.limits()), values(&mut export.sensor())];
    let memory: Vec<String> = effects.iter().flat_map(|effect| effect.memory.clone()).collect();
    let own = [units.input.as_deref(), units.output.as_deref()].map(Option::unwrap_or_default);
    let [input_unit, output_unit] = own;
    let named = parameters.iter().map(|parameter| parameter.unit.as_str()).chain(own).chain(["s"]);
    let units: BTreeSet<&str> = named.filter(|unit| !unit.is_empty()).collect();
    let units: Vec<String> = units.into_iter().map(str::to_owned).collect();
    let parameter = |parameter: &Parameter| {
        let Parameter { name, meaning, unit, value } = parameter;
        let described = parameter.described();
        context! { name, meaning, unit, described, value => format!("{value:?}") }
    };
    context! {
        name,
        joint,
        origin,
        memory,
        drive,
        limits,
        sensor,
        input_unit,
        output_unit,
        units,
        parameters => parameters.iter().map(parameter).collect::<Vec<_>>(),
        effects => effects.iter().map(effect).collect::<Vec<_>>(),
        load => of_stage(Stage::Load),
        transport => of_stage(Stage::Transport),
        uses_others => export.uses_others(),
        version => env!("CARGO_PKG_VERSION"),
    }
}
