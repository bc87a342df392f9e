//! A module of Python for NumPy.

use super::ExportError;
use super::description::{Export, Exported, Parameter};
use super::language::{File, Language};
use super::notation::{Notation, lines, result};
use super::template::{filled, indented, is_name};
use crate::effect::Stage;
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

    fn files(&self, export: &Export, name: &str) -> Result<Vec<File>, ExportError> {
        if !is_name(name) {
            return Err(ExportError::Name { name: name.to_owned(), language: self.name() });
        }
        Ok(vec![File::of("py", module(export))])
    }
}

fn module(export: &Export) -> String {
    const INDENT: &str = "        ";
    let memory = export.effects.iter().flat_map(|effect| &effect.memory);
    let memory = memory.map(|name| format!("self.{name} = np.float64(0.0)"));
    let output = || export.limits().chain(export.sensor());
    let effects: String = export.effects.iter().map(functions).collect();
    filled(
        MODULE,
        &[
            ("JOINT", &quotable(&export.joint)),
            ("ORIGIN", &quotable(&export.commented(""))),
            ("PARAMETERS", &export.parameters.iter().map(parameter).collect::<String>()),
            ("MEMORY", &indented(memory, INDENT)),
            ("SENSOR", &calls(export.sensor())),
            ("SETTLE_DRIVE", &settled(export.drive())),
            ("SETTLE_OUTPUT", &settled(output())),
            ("SETTLE_SENSOR", &settled(export.sensor())),
            ("DRIVE", &calls(export.drive())),
            ("LOAD", &load(export)),
            ("LIMITS", &limits(export)),
            ("TRANSPORT", &transport(export)),
            ("EFFECTS", &effects),
        ],
    )
}

fn parameter(parameter: &Parameter) -> String {
    let Parameter { name, meaning, unit, value } = parameter;
    let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
    format!("    #: {meaning}{unit}\n    {name}: float = {value:?}\n")
}

fn calls<'a>(effects: impl Iterator<Item = &'a Exported>) -> String {
    indented(effects.map(|e| format!("at.signal = self._effect_{}(at)", e.id)), "        ")
}

/// As [`calls`], each after it has settled.
fn settled<'a>(effects: impl Iterator<Item = &'a Exported>) -> String {
    let both = |effect: &Exported| {
        let id = &effect.id;
        let settle = format!("self._effect_{id}_settle(at)");
        let settle = (!effect.settle.lines.is_empty()).then_some(settle);
        settle.into_iter().chain([format!("at.signal = self._effect_{id}(at)")])
    };
    indented(effects.flat_map(both), "        ")
}

/// Half an interval ahead the joint is where it comes if the load does what it did before.
fn load(export: &Export) -> String {
    if export.stage(Stage::Load).next().is_none() {
        return String::new();
    }
    let begin = "\
        commanded = at.signal
        at.position = at.position + 0.5 * dt * (commanded + self.load_adds)
        at.time = at.time + 0.5 * dt\n";
    let end = "        self.load_adds = at.signal - commanded\n";
    ["        ", begin, &calls(export.stage(Stage::Load)), end].concat()
}

fn limits(export: &Export) -> String {
    if export.limits().next().is_none() {
        return String::new();
    }
    let begin = "        at = _Moment(self, self.angle, time, dt)\n";
    let end = "        if at.signal != self.angle:
            self.velocity = np.float64(0.0)
        self.angle = at.signal\n";
    [begin, &calls(export.limits()), end].concat()
}

fn transport(export: &Export) -> String {
    if export.stage(Stage::Transport).next().is_none() {
        return String::new();
    }
    let call = |effect: &Exported| format!("delay = delay + self._effect_{}(at)", effect.id);
    let begin =
        "        at = _Change(self.before, level, now - self.since, self.p.start_s + now)\n";
    begin.to_owned() + &indented(export.stage(Stage::Transport).map(call), "        ")
}

/// The methods of an effect.
fn functions(effect: &Exported) -> String {
    let Exported { id, summary, equation, .. } = effect;
    let about = quotable(&format!("{summary}: {equation}"));
    let body = |program| indented(lines(&Notes, effect, program), "        ");
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

    fn signal(&self, name: &str) -> String {
        match name {
            "radians" => "self.p.radians_per_output_unit".to_owned(),
            _ => format!("at.{name}"),
        }
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
            Operator::Add => "+",
            Operator::Sub => "-",
            Operator::Mul => "*",
            Operator::Div => "/",
            Operator::Pow => "np.float_power",
            Operator::Min => "np.fmin",
            Operator::Max => "np.fmax",
            Operator::Less => "<",
            Operator::LessOrEqual => "<=",
            Operator::Greater => ">",
            Operator::GreaterOrEqual => ">=",
            Operator::Equal => "==",
            Operator::And => "and",
            Operator::Or => "or",
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

    fn local(&self, name: &str, value: &str) -> String {
        format!("{name} = {value}")
    }

    fn remember(&self, name: &str, value: &str) -> String {
        format!("{name} = {value}")
    }
}
