//! C99: a header and a source, without allocation and without dependencies but `math.h`.

use super::ExportError;
use super::description::{Export, Exported, Parameter};
use super::language::{File, Language};
use super::notation::{Notation, lines, result};
use super::template::{filled, indented, is_name};
use crate::effect::Stage;
use crate::effect::expression::{Function, Operator};

const HEADER: &str = include_str!("template/model.h");
const SOURCE: &str = include_str!("template/model.c");

/// A function that C does not have.
const SIGN: &str = "\
static double @NAME@_sign(double x)
{
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x;
}

";

/// C99.
#[derive(Clone, Copy, Debug)]
pub(super) struct C;

impl Language for C {
    fn endings(&self) -> &'static [&'static str] {
        &["c", "h"]
    }

    fn name(&self) -> &'static str {
        "C"
    }

    fn files(&self, export: &Export, name: &str) -> Result<Vec<File>, ExportError> {
        if !is_name(name) {
            return Err(ExportError::Name { name: name.to_owned(), language: self.name() });
        }
        let (source, header) = sources(export, name);
        Ok(vec![File::of("c", source), File::of("h", header)])
    }
}

/// Source and header of `export`, whose functions begin with `name`.
pub(super) fn sources(export: &Export, name: &str) -> (String, String) {
    let upper = name.to_uppercase();
    let joint = commentable(&export.joint);
    let all = |template: &str, places: &[(&str, &str)]| {
        let named = [("JOINT", joint.as_str()), ("FILE", name), ("UPPER", &upper), ("NAME", name)];
        filled(&filled(template, places), &named)
    };
    (source(export, &all), header(export, &all))
}

/// Fills the places of a template, and the names.
type Fill<'a> = dyn Fn(&str, &[(&str, &str)]) -> String + 'a;

fn header(export: &Export, all: &Fill<'_>) -> String {
    let parameters: String = export.parameters.iter().map(parameter).collect();
    let memory = export.effects.iter().flat_map(|effect| &effect.memory);
    let memory = indented(memory.map(|name| format!("double {name};")), "    ");
    let others = if export.uses_others() { "" } else { "; this model has no use for it" };
    all(
        HEADER,
        &[
            ("ORIGIN", &commentable(&export.commented(" * "))),
            ("PARAMETERS", &parameters),
            ("MEMORY", &memory),
            ("OTHERS", others),
        ],
    )
}

fn parameter(parameter: &Parameter) -> String {
    let Parameter { name, meaning, unit, value } = parameter;
    let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
    format!("    double {name}; /* {}{}; {value:?} */\n", commentable(meaning), commentable(&unit))
}

fn source(export: &Export, all: &Fill<'_>) -> String {
    let effects: String = export.effects.iter().map(functions).collect();
    let helpers = if effects.contains("@NAME@_sign(") { SIGN } else { "" };
    let default = |p: &Parameter| format!("p.{} = {:?};", p.name, p.value);
    let output = || export.limits().chain(export.sensor());
    all(
        SOURCE,
        &[
            ("HELPERS", helpers),
            ("EFFECTS", &effects),
            ("DEFAULTS", &indented(export.parameters.iter().map(default), "    ")),
            ("SENSOR", &calls(export.sensor(), "    ")),
            ("SETTLE_DRIVE", &settled(export.drive())),
            ("SETTLE_OUTPUT", &settled(output())),
            ("SETTLE_SENSOR", &settled(export.sensor())),
            ("DRIVE", &calls(export.drive(), "    ")),
            ("LOAD", &load(export)),
            ("LIMITS", &limits(export)),
            ("TRANSPORT", &transport(export)),
        ],
    )
}

/// The signal after each of `effects`.
fn calls<'a>(effects: impl Iterator<Item = &'a Exported>, indent: &str) -> String {
    indented(effects.map(|e| format!("at.signal = @NAME@_effect_{}(model, &at);", e.id)), indent)
}

/// As [`calls`], each after it has settled.
fn settled<'a>(effects: impl Iterator<Item = &'a Exported>) -> String {
    let both = |effect: &Exported| {
        let id = &effect.id;
        let settle = format!("@NAME@_effect_{id}_settle(model, &at);");
        let settle = (!effect.settle.lines.is_empty()).then_some(settle);
        settle.into_iter().chain([format!("at.signal = @NAME@_effect_{id}(model, &at);")])
    };
    indented(effects.flat_map(both), "    ")
}

/// Half an interval ahead the joint is where it comes if the load does what it did before.
fn load(export: &Export) -> String {
    if export.stage(Stage::Load).next().is_none() {
        return String::new();
    }
    format!(
        "    {{\n\
         {}    }}\n",
        [
            "        const double commanded = at.signal;\n".to_owned(),
            "        at.position += 0.5 * dt * (commanded + model->load_adds);\n".to_owned(),
            "        at.time += 0.5 * dt;\n".to_owned(),
            calls(export.stage(Stage::Load), "        "),
            "        model->load_adds = at.signal - commanded;\n".to_owned(),
        ]
        .concat()
    )
}

fn limits(export: &Export) -> String {
    if export.limits().next().is_none() {
        return String::new();
    }
    [
        "    at = @NAME@_at(model, model->angle, time, dt);\n".to_owned(),
        calls(export.limits(), "    "),
        "    if (at.signal != model->angle) {\n        model->velocity = 0.0;\n    }\n".to_owned(),
        "    model->angle = at.signal;\n".to_owned(),
    ]
    .concat()
}

fn transport(export: &Export) -> String {
    if export.stage(Stage::Transport).next().is_none() {
        return String::new();
    }
    let call = |effect: &Exported| format!("arrives += @NAME@_effect_{}(model, &at);", effect.id);
    format!(
        "    {{\n        @NAME@_change at;\n        at.before = model->before;\n        \
         at.after = level;\n        at.held = now - model->since;\n        \
         at.time = model->p.start_s + now;\n{}    }}\n",
        indented(export.stage(Stage::Transport).map(call), "        ")
    )
}

/// The functions of an effect.
fn functions(effect: &Exported) -> String {
    let Exported { id, summary, equation, .. } = effect;
    let about = commentable(&format!("{id}: {summary}\n *     {equation}"));
    let kind = if effect.stage == Stage::Transport { "change" } else { "moment" };
    let body = |of: &[String]| {
        let text = indented(of.iter().cloned(), "    ");
        let unused = [("model->", "(void)model;"), ("at->", "(void)at;")];
        let unused = unused.into_iter().filter(|(used, _)| !text.contains(used));
        indented(unused.map(|(_, line)| line.to_owned()), "    ") + &text
    };
    let arguments = format!("(@NAME@_state *model, const @NAME@_{kind} *at)");
    let step = body(&lines(&Notes, effect, &effect.step));
    let step = format!(
        "/* {about} */\nstatic double @NAME@_effect_{id}{arguments}\n{{\n{step}    return {};\n}}\n\n",
        result(&effect.step)
    );
    if effect.settle.lines.is_empty() {
        return step;
    }
    let settle = body(&lines(&Notes, effect, &effect.settle));
    step + &format!("static void @NAME@_effect_{id}_settle{arguments}\n{{\n{settle}}}\n\n")
}

/// A text that ends no comment.
fn commentable(text: &str) -> String {
    text.replace("*/", "* /").replace("/*", "/ *")
}

/// The notation of C.
struct Notes;

impl Notation for Notes {
    fn parameter(&self, name: &str) -> String {
        format!("model->p.{name}")
    }

    fn memory(&self, name: &str) -> String {
        format!("model->{name}")
    }

    fn signal(&self, name: &str) -> String {
        match name {
            "radians" => "model->p.radians_per_output_unit".to_owned(),
            _ => format!("at->{name}"),
        }
    }

    fn function(&self, function: Function) -> &'static str {
        match function {
            Function::Abs => "fabs",
            Function::Sign => "@NAME@_sign",
            Function::Sqrt => "sqrt",
            Function::Exp => "exp",
            Function::Expm1 => "expm1",
            Function::Ln => "log",
            Function::Ln1p => "log1p",
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Tan => "tan",
            Function::Atan => "atan",
            Function::Tanh => "tanh",
            Function::Floor => "floor",
            Function::IsFinite => "isfinite",
            Function::Neg => "-",
            Function::Not => "!",
        }
    }

    fn operator(&self, operator: Operator) -> &'static str {
        match operator {
            Operator::Add => "+",
            Operator::Sub => "-",
            Operator::Mul => "*",
            Operator::Div => "/",
            Operator::Pow => "pow",
            Operator::Min => "fmin",
            Operator::Max => "fmax",
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
        format!("!({condition})")
    }

    fn is_true(&self, number: &str) -> String {
        format!("{number} != 0.0")
    }

    fn choice(&self, condition: &str, then: &str, otherwise: &str) -> String {
        format!("({condition} ? {then} : {otherwise})")
    }

    fn local(&self, name: &str, value: &str) -> String {
        format!("const double {name} = {value};")
    }

    fn remember(&self, name: &str, value: &str) -> String {
        format!("{name} = {value};")
    }
}
