//! A function of MATLAB and GNU Octave.

use super::ExportError;
use super::body::{Around, Body, places};
use super::description::{Export, Exported, Parameter};
use super::language::{File, Language};
use super::notation::{Notation, lines, result, usual_operator};
use super::template::{filled, indented};
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

    fn written(&self, export: &Export, name: &str) -> Result<Vec<File>, ExportError> {
        Ok(vec![File::of("m", function(export, name))])
    }
}

fn function(export: &Export, name: &str) -> String {
    let mut places = places(&Notes, export);
    places.extend([
        ("JOINT", export.joint.clone()),
        ("ORIGIN", export.commented("%   ")),
        ("UPPER", name.to_uppercase()),
        ("NAME", name.to_owned()),
    ]);
    filled(FUNCTION, &places)
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
            Operator::Pow => "real_pow",
            Operator::Min => "min",
            Operator::Max => "max",
            _ => usual_operator(operator),
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
}

impl Body for Notes {
    fn indent(&self) -> &'static str {
        "  "
    }

    fn declare(&self, parameter: &Parameter) -> String {
        let Parameter { name, value, .. } = parameter;
        format!("%     p.{name}: {}; {value:?}\n", parameter.described())
    }

    fn begin(&self, memory: &str) -> String {
        format!("s.{memory} = 0;")
    }

    fn call(&self, id: &str) -> String {
        format!("[at.signal, s] = effect_{id}(s, at);")
    }

    fn settle(&self, id: &str) -> String {
        format!("s = effect_{id}_settle(s, at);")
    }

    fn delay(&self, id: &str) -> String {
        format!("delay = delay + effect_{id}(s, at);")
    }

    fn load(&self) -> Around {
        Around {
            before: "  commanded = at.signal;
  at.position = at.position + 0.5 * dt * (commanded + s.load_adds);
  at.time = at.time + 0.5 * dt;\n",
            indent: self.indent(),
            after: "  s.load_adds = at.signal - commanded;\n",
        }
    }

    fn limits(&self) -> Around {
        Around {
            before: "  at = moment(s, s.angle, time, dt);\n",
            indent: self.indent(),
            after: "  if at.signal ~= s.angle
    s.velocity = 0;
  end
  s.angle = at.signal;\n",
        }
    }

    fn transport(&self) -> Around {
        Around {
            before: "  at = struct('before', s.before, 'after', level, 'held', now_s - s.since, ...
              'time', s.p.start_s + now_s);\n",
            indent: self.indent(),
            after: "",
        }
    }

    fn functions(&self, effect: &Exported) -> String {
        let Exported { id, summary, equation, .. } = effect;
        let body = |program| indented(lines(self, effect, program), self.indent());
        let (out, step) = (result(&effect.step), body(&effect.step));
        let step = format!(
            "\n% {id}: {summary}\n%   {equation}\nfunction [{out}, s] = effect_{id}(s, at)\n{step}end\n"
        );
        if effect.settle.lines.is_empty() {
            return step;
        }
        step + &format!("\nfunction s = effect_{id}_settle(s, at)\n{}end\n", body(&effect.settle))
    }
}
