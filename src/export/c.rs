//! C99: a header and a source, without allocation and without dependencies but `math.h`.

use super::ExportError;
use super::body::{Around, Body, places};
use super::description::{Export, Exported, Parameter};
use super::language::{File, Language};
use super::notation::{Notation, lines, result};
use super::template::{filled, indented};
use crate::effect::Stage;
use crate::effect::expression::Function;

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

    fn written(&self, export: &Export, name: &str) -> Result<Vec<File>, ExportError> {
        let (source, header) = sources(export, name);
        Ok(vec![File::of("c", source), File::of("h", header)])
    }
}

/// Source and header of `export`, whose functions begin with `name`.
pub(super) fn sources(export: &Export, name: &str) -> (String, String) {
    let mut places = places(&Notes, export);
    let uses_sign = places.iter().any(|(_, text)| text.contains("@NAME@_sign("));
    let others = if export.uses_others() { "" } else { "; this model has no use for it" };
    places.extend([
        ("HELPERS", if uses_sign { SIGN } else { "" }.to_owned()),
        ("ORIGIN", commentable(&export.commented(" * "))),
        ("OTHERS", others.to_owned()),
        ("JOINT", commentable(&export.joint)),
    ]);
    // These are identifiers: where a text of the user's names them, nothing but a word changes.
    let upper = name.to_uppercase();
    let named = [("FILE", name), ("UPPER", &upper), ("NAME", name)];
    let all = |template: &str| filled(&filled(template, &places), &named);
    (all(SOURCE), all(HEADER))
}

/// A text that ends no comment, nor joins what stands before the end of a line to what follows it.
pub(super) fn commentable(text: &str) -> String {
    let unspliced = text.replace("??/", "?? /").replace('\\', "|");
    unspliced.replace("*/", "* /").replace("/*", "/ *")
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

    fn at(&self, name: &str) -> String {
        format!("at->{name}")
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
}

impl Body for Notes {
    fn indent(&self) -> &'static str {
        "    "
    }

    fn declare(&self, parameter: &Parameter) -> String {
        let Parameter { name, value, .. } = parameter;
        format!("    double {name}; /* {}; {value:?} */\n", commentable(&parameter.described()))
    }

    fn begin(&self, memory: &str) -> String {
        format!("double {memory};")
    }

    fn call(&self, id: &str) -> String {
        format!("at.signal = @NAME@_effect_{id}(model, &at);")
    }

    fn settle(&self, id: &str) -> String {
        format!("@NAME@_effect_{id}_settle(model, &at);")
    }

    fn delay(&self, id: &str) -> String {
        format!("arrives += @NAME@_effect_{id}(model, &at);")
    }

    fn load(&self) -> Around {
        Around {
            before: "    {
        const double commanded = at.signal;
        at.position += 0.5 * dt * (commanded + model->load_adds);
        at.time += 0.5 * dt;\n",
            indent: "        ",
            after: "        model->load_adds = at.signal - commanded;\n    }\n",
        }
    }

    fn limits(&self) -> Around {
        Around {
            before: "    at = @NAME@_at(model, model->angle, time, dt);\n",
            indent: self.indent(),
            after: "    if (at.signal != model->angle) {
        model->velocity = 0.0;
    }
    model->angle = at.signal;\n",
        }
    }

    fn transport(&self) -> Around {
        Around {
            before: "    {
        @NAME@_change at;
        at.before = model->before;
        at.after = level;
        at.held = now - model->since;
        at.time = model->p.start_s + now;\n",
            indent: "        ",
            after: "    }\n",
        }
    }

    fn functions(&self, effect: &Exported) -> String {
        let Exported { id, summary, equation, .. } = effect;
        let about = commentable(&format!("{id}: {summary}\n *     {equation}"));
        let kind = if effect.stage == Stage::Transport { "change" } else { "moment" };
        let body = |program| {
            let text = indented(lines(self, effect, program), self.indent());
            let unused = [("model->", "(void)model;"), ("at->", "(void)at;")];
            let unused = unused.into_iter().filter(|(used, _)| !text.contains(used));
            indented(unused.map(|(_, line)| line.to_owned()), self.indent()) + &text
        };
        let arguments = format!("(@NAME@_state *model, const @NAME@_{kind} *at)");
        let step = format!(
            "/* {about} */\nstatic double @NAME@_effect_{id}{arguments}\n{{\n{}    return {};\n}}\n\n",
            body(&effect.step),
            result(&effect.step)
        );
        if effect.settle.lines.is_empty() {
            return step;
        }
        let settle = body(&effect.settle);
        step + &format!("static void @NAME@_effect_{id}_settle{arguments}\n{{\n{settle}}}\n\n")
    }
}
