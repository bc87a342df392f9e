//! The effects of a joint, stage by stage, in any language.

use super::description::{Export, Exported, Parameter};
use super::notation::Notation;
use super::template::indented;
use crate::effect::Stage;

/// What stands around the calls of the effects of a stage.
pub(super) struct Around {
    pub(super) before: &'static str,
    /// Of the calls between.
    pub(super) indent: &'static str,
    pub(super) after: &'static str,
}

/// How a language runs a signal through effects.
pub(super) trait Body: Notation {
    /// Of the lines of a function.
    fn indent(&self) -> &'static str;
    /// A parameter of the model with its meaning, unit and value.
    fn declare(&self, parameter: &Parameter) -> String;
    /// A number that an effect remembers, as it begins.
    fn begin(&self, memory: &str) -> String;
    /// The signal becomes what the effect `id` makes of it.
    fn call(&self, id: &str) -> String;
    /// The effect `id` remembers what it does of a signal that has long been held.
    fn settle(&self, id: &str) -> String;
    /// What the effect `id` adds to the delay of a change.
    fn delay(&self, id: &str) -> String;
    /// The load, half an interval ahead: the joint is where it comes if the load does what it did
    /// before.
    fn load(&self) -> Around;
    /// The limits of the angle, at which the joint stands still.
    fn limits(&self) -> Around;
    /// The delay of a change.
    fn transport(&self) -> Around;
    /// The functions of an effect.
    fn functions(&self, effect: &Exported) -> String;
}

/// What a template leaves to the effects, by the names of its places.
pub(super) fn places(body: &impl Body, export: &Export) -> Vec<(&'static str, String)> {
    let lines = |lines: &mut dyn Iterator<Item = String>| indented(lines, body.indent());
    let memory = export.effects.iter().flat_map(|effect| &effect.memory);
    let default = |p: &Parameter| format!("p.{} = {:?};", p.name, p.value);
    let call = |effect: &Exported| body.call(&effect.id);
    let settled = |effect: &Exported| {
        let settle = (!effect.settle.lines.is_empty()).then(|| body.settle(&effect.id));
        settle.into_iter().chain([body.call(&effect.id)])
    };
    let delay = |effect: &Exported| body.delay(&effect.id);
    vec![
        ("PARAMETERS", export.parameters.iter().map(|p| body.declare(p)).collect()),
        ("DEFAULTS", lines(&mut export.parameters.iter().map(default))),
        ("MEMORY", lines(&mut memory.map(|name| body.begin(name)))),
        ("SENSOR", lines(&mut export.sensor().map(call))),
        ("SETTLE_DRIVE", lines(&mut export.drive().flat_map(settled))),
        ("SETTLE_LIMITS", lines(&mut export.limits().flat_map(settled))),
        ("SETTLE_SENSOR", lines(&mut export.sensor().flat_map(settled))),
        ("DRIVE", lines(&mut export.drive().map(call))),
        ("LOAD", around(&body.load(), export.stage(Stage::Load).map(call))),
        ("LIMITS", around(&body.limits(), export.limits().map(call))),
        ("TRANSPORT", around(&body.transport(), export.stage(Stage::Transport).map(delay))),
        ("EFFECTS", export.effects.iter().map(|effect| body.functions(effect)).collect()),
    ]
}

/// Nothing where there are no `calls`.
fn around(around: &Around, calls: impl Iterator<Item = String>) -> String {
    let calls = indented(calls, around.indent);
    if calls.is_empty() { calls } else { [around.before, &calls, around.after].concat() }
}
