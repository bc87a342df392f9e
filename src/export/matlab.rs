//! A function of MATLAB and GNU Octave.

use super::ExportError;
use super::description::{Export, Exported, Parameter};
use super::language::{File, Language};
use super::notation::{Notation, lines, result};
use super::template::{filled, indented, is_name};
use crate::effect::Stage;
use crate::effect::expression::{Function, Operator};

const FUNCTION: &str = include_str!("template/model.m");

/// MATLAB.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matlab;

impl Language for Matlab {
    fn endings(&self) -> &'static [&'static str] {
        &["m"]
    }

    fn name(&self) -> &'static str {
        "MATLAB"
    }

    fn files(&self, export: &Export, name: &str) -> Result<Vec<File>, ExportError> {
        if !is_name(name) {
            return Err(ExportError::Name { name: name.to_owned(), language: self.name() });
        }
        Ok(vec![File::of("m", function(export, name))])
    }
}

fn function(export: &Export, name: &str) -> String {
    let memory = export.effects.iter().flat_map(|effect| &effect.memory);
    let memory = memory.map(|name| format!("s.{name} = 0;"));
    let default = |p: &Parameter| format!("p.{} = {:?};", p.name, p.value);
    let output = || export.limits().chain(export.sensor());
    let effects: String = export.effects.iter().map(functions).collect();
    filled(
        FUNCTION,
        &[
            ("JOINT", &export.joint),
            ("ORIGIN", &export.commented("%   ")),
            ("PARAMETERS", &export.parameters.iter().map(parameter).collect::<String>()),
            ("DEFAULTS", &indented(export.parameters.iter().map(default), "  ")),
            ("MEMORY", &indented(memory, "  ")),
            ("SENSOR", &calls(export.sensor())),
            ("SETTLE_DRIVE", &settled(export.drive())),
            ("SETTLE_OUTPUT", &settled(output())),
            ("SETTLE_SENSOR", &settled(export.sensor())),
            ("DRIVE", &calls(export.drive())),
            ("LOAD", &load(export)),
            ("LIMITS", &limits(export)),
            ("TRANSPORT", &transport(export)),
            ("EFFECTS", &effects),
            ("UPPER", &name.to_uppercase()),
            ("NAME", name),
        ],
    )
}

fn parameter(parameter: &Parameter) -> String {
    let Parameter { name, meaning, unit, value } = parameter;
    let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
    format!("%     p.{name}: {meaning}{unit}; {value:?}\n")
}

fn calls<'a>(effects: impl Iterator<Item = &'a Exported>) -> String {
    indented(effects.map(|e| format!("[at.signal, s] = effect_{}(s, at);", e.id)), "  ")
}

/// As [`calls`], each after it has settled.
fn settled<'a>(effects: impl Iterator<Item = &'a Exported>) -> String {
    let both = |effect: &Exported| {
        let id = &effect.id;
        let settle = format!("s = effect_{id}_settle(s, at);");
        let settle = (!effect.settle.lines.is_empty()).then_some(settle);
        settle.into_iter().chain([format!("[at.signal, s] = effect_{id}(s, at);")])
    };
    indented(effects.flat_map(both), "  ")
}

/// Half an interval ahead the joint is where it comes if the load does what it did before.
fn load(export: &Export) -> String {
    if export.stage(Stage::Load).next().is_none() {
        return String::new();
    }
    let begin = "  commanded = at.signal;
  at.position = at.position + 0.5 * dt * (commanded + s.load_adds);
  at.time = at.time + 0.5 * dt;\n";
    [begin, &calls(export.stage(Stage::Load)), "  s.load_adds = at.signal - commanded;\n"].concat()
}

fn limits(export: &Export) -> String {
    if export.limits().next().is_none() {
        return String::new();
    }
    let begin = "  at = moment(s, s.angle, time, dt);\n";
    let end = "  if at.signal ~= s.angle\n    s.velocity = 0;\n  end\n  s.angle = at.signal;\n";
    [begin, &calls(export.limits()), end].concat()
}

fn transport(export: &Export) -> String {
    if export.stage(Stage::Transport).next().is_none() {
        return String::new();
    }
    let begin = "  at = struct('before', s.before, 'after', level, 'held', now_s - s.since, ...
              'time', s.p.start_s + now_s);\n";
    let call = |effect: &Exported| format!("delay = delay + effect_{}(s, at);", effect.id);
    begin.to_owned() + &indented(export.stage(Stage::Transport).map(call), "  ")
}

/// The functions of an effect.
fn functions(effect: &Exported) -> String {
    let Exported { id, summary, equation, .. } = effect;
    let body = |program| indented(lines(&Notes, effect, program), "  ");
    let out = result(&effect.step);
    let step = body(&effect.step);
    let step = format!(
        "\n% {id}: {summary}\n%   {equation}\nfunction [{out}, s] = effect_{id}(s, at)\n{step}end\n"
    );
    if effect.settle.lines.is_empty() {
        return step;
    }
    step + &format!("\nfunction s = effect_{id}_settle(s, at)\n{}end\n", body(&effect.settle))
}

/// The notation of MATLAB.
struct Notes;

impl Notation for Notes {
    fn parameter(&self, name: &str) -> String {
        format!("s.p.{name}")
    }

    fn memory(&self, name: &str) -> String {
        format!("s.{name}")
    }

    fn signal(&self, name: &str) -> String {
        match name {
            "radians" => "s.p.radians_per_output_unit".to_owned(),
            _ => format!("at.{name}"),
        }
    }

    fn function(&self, function: Function) -> &'static str {
        match function {
            Function::Abs => "abs",
            Function::Sign => "sign",
            Function::Sqrt => "real_sqrt",
            Function::Exp => "exp",
            Function::Expm1 => "expm1",
            Function::Ln => "real_log",
            Function::Ln1p => "real_log1p",
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Tan => "tan",
            Function::Atan => "atan",
            Function::Tanh => "tanh",
            Function::Floor => "floor",
            Function::IsFinite => "isfinite",
            Function::Neg => "-",
            Function::Not => "~",
        }
    }

    fn operator(&self, operator: Operator) -> &'static str {
        match operator {
            Operator::Add => "+",
            Operator::Sub => "-",
            Operator::Mul => "*",
            Operator::Div => "/",
            Operator::Pow => "real_pow",
            Operator::Min => "min",
            Operator::Max => "max",
            Operator::Less => "<",
            Operator::LessOrEqual => "<=",
            Operator::Greater => ">",
            Operator::GreaterOrEqual => ">=",
            Operator::Equal => "==",
            Operator::And => "&&",
            Operator::Or => "||",
        }
    }

    fn not(&self, condition: &str) -> String {
        format!("~({condition})")
    }

    fn is_true(&self, number: &str) -> String {
        format!("{number} ~= 0")
    }

    fn choice(&self, condition: &str, then: &str, otherwise: &str) -> String {
        format!("pick({condition}, {then}, {otherwise})")
    }

    fn local(&self, name: &str, value: &str) -> String {
        format!("{name} = {value};")
    }

    fn remember(&self, name: &str, value: &str) -> String {
        format!("{name} = {value};")
    }
}
