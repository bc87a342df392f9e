//! A module of Python for NumPy.

use super::ExportError;
use super::body::{Around, Body, places};
use super::description::{Export, Exported, Parameter};
use super::language::{File, Language};
use super::notation::{Notation, lines, result, usual_operator};
use super::template::{filled, indented};
use crate::effect::expression::{Function, Operator};

const MODULE: &str = include_str!("template/model.py");

/// A module of Python 3.
#[derive(Clone, Copy, Debug)]
pub(super) struct Python;

impl Language for Python {
    fn endings(&self) -> &'static [&'static str] {
        &["py"]
    }

    fn name(&self) -> &'static str {
        "Python"
    }

    fn written(&self, export: &Export, _: &str) -> Result<Vec<File>, ExportError> {
        Ok(vec![File::of("py", module(export))])
    }
}

fn module(export: &Export) -> String {
    let mut places = places(&Notes, export);
    let origin = quotable(&export.commented(""));
    places.extend([("JOINT", quotable(&export.joint)), ("ORIGIN", origin)]);
    filled(MODULE, &places)
}

/// A text that ends no docstring.
fn quotable(text: &str) -> String {
    text.replace('\\', "/").replace('"', "'")
}

/// The notation of Python.
struct Notes;

impl Notation for Notes {
    fn parameter(&self, name: &str) -> String {
        format!("self.p.{name}")
    }

    fn memory(&self, name: &str) -> String {
        format!("self.{name}")
    }

    fn function(&self, function: Function) -> &'static str {
        match function {
            Function::Abs => "abs",
            Function::Sign => "np.sign",
            Function::Sqrt => "np.sqrt",
            Function::Exp => "np.exp",
            Function::Expm1 => "np.expm1",
            Function::Ln => "np.log",
            Function::Ln1p => "np.log1p",
            Function::Sin => "np.sin",
            Function::Cos => "np.cos",
            Function::Tan => "np.tan",
            Function::Atan => "np.arctan",
            Function::Tanh => "np.tanh",
            Function::Floor => "np.floor",
            Function::IsFinite => "np.isfinite",
            Function::Neg => "-",
            Function::Not => "not ",
        }
    }

    fn operator(&self, operator: Operator) -> &'static str {
        match operator {
            Operator::Pow => "np.float_power",
            Operator::Min => "np.fmin",
            Operator::Max => "np.fmax",
            Operator::And => "and",
            Operator::Or => "or",
            _ => usual_operator(operator),
        }
    }

    fn not(&self, condition: &str) -> String {
        format!("(not ({condition}))")
    }

    fn is_true(&self, number: &str) -> String {
        format!("{number} != 0.0")
    }

    fn choice(&self, condition: &str, then: &str, otherwise: &str) -> String {
        format!("({then} if {condition} else {otherwise})")
    }

    fn remember(&self, name: &str, value: &str) -> String {
        format!("{name} = {value}")
    }
}

impl Body for Notes {
    fn indent(&self) -> &'static str {
        "        "
    }

    fn declare(&self, parameter: &Parameter) -> String {
        let Parameter { name, value, .. } = parameter;
        format!("    #: {}\n    {name}: float = {value:?}\n", parameter.described())
    }

    fn begin(&self, memory: &str) -> String {
        format!("self.{memory} = np.float64(0.0)")
    }

    fn call(&self, id: &str) -> String {
        format!("at.signal = self._effect_{id}(at)")
    }

    fn settle(&self, id: &str) -> String {
        format!("self._effect_{id}_settle(at)")
    }

    fn delay(&self, id: &str) -> String {
        format!("delay = delay + self._effect_{id}(at)")
    }

    fn load(&self) -> Around {
        Around {
            before: "        commanded = at.signal
        at.position = at.position + 0.5 * dt * (commanded + self.load_adds)
        at.time = at.time + 0.5 * dt\n",
            indent: self.indent(),
            after: "        self.load_adds = at.signal - commanded\n",
        }
    }

    fn limits(&self) -> Around {
        Around {
            before: "        at = _Moment(self, self.angle, time, dt)\n",
            indent: self.indent(),
            after: "        if at.signal != self.angle:
            self.velocity = np.float64(0.0)
        self.angle = at.signal\n",
        }
    }

    fn transport(&self) -> Around {
        let before =
            "        at = _Change(self.before, level, now - self.since, self.p.start_s + now)\n";
        Around { before, indent: self.indent(), after: "" }
    }

    fn functions(&self, effect: &Exported) -> String {
        let Exported { id, summary, equation, .. } = effect;
        let about = quotable(&format!("{summary}: {equation}"));
        let body = |program| indented(lines(self, effect, program), self.indent());
        let step = format!(
            "\n    def _effect_{id}(self, at):\n        \"\"\"{about}\"\"\"\n{}        return {}\n",
            body(&effect.step),
            result(&effect.step)
        );
        if effect.settle.lines.is_empty() {
            return step;
        }
        step + &format!("\n    def _effect_{id}_settle(self, at):\n{}", body(&effect.settle))
    }
}
