//! Equations in the notation of a language.

use super::description::Exported;
use crate::effect::expression::{Function, Line, Name, Node, Operator, Program};

/// A language in which equations are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Notation {
    C,
    Python,
    Matlab,
}

impl Notation {
    /// The text of this language, of one in each: C, Python, MATLAB.
    fn of<T>(self, [c, python, matlab]: [T; 3]) -> T {
        match self {
            Self::C => c,
            Self::Python => python,
            Self::Matlab => matlab,
        }
    }

    /// A parameter of the model.
    fn parameter(self, name: &str) -> String {
        self.of(["model->p.", "self.p.", "s.p."]).to_owned() + name
    }

    /// A number that an effect remembers.
    fn memory(self, name: &str) -> String {
        self.of(["model->", "self.", "s."]).to_owned() + name
    }

    /// What an effect sees of the joint.
    fn signal(self, name: &str) -> String {
        match name {
            "radians" => self.parameter("radians_per_output_unit"),
            _ => self.of(["at->", "at.", "at."]).to_owned() + name,
        }
    }

    /// The name of a function of one number, which is called as in mathematics. What C and MATLAB do not
    /// have is a function of their templates.
    fn function(self, function: Function) -> &'static str {
        self.of(match function {
            Function::Abs => ["fabs", "abs", "abs"],
            Function::Sign => ["sign_of", "np.sign", "sign"],
            Function::Sqrt => ["sqrt", "np.sqrt", "real_sqrt"],
            Function::Exp => ["exp", "np.exp", "exp"],
            Function::Expm1 => ["expm1", "np.expm1", "expm1"],
            Function::Ln => ["log", "np.log", "real_log"],
            Function::Ln1p => ["log1p", "np.log1p", "real_log1p"],
            Function::Sin => ["sin", "np.sin", "sin"],
            Function::Cos => ["cos", "np.cos", "cos"],
            Function::Tan => ["tan", "np.tan", "tan"],
            Function::Atan => ["atan", "np.arctan", "atan"],
            Function::Tanh => ["tanh", "np.tanh", "tanh"],
            Function::Floor => ["floor", "np.floor", "floor"],
            Function::IsFinite => ["isfinite", "np.isfinite", "isfinite"],
            Function::Neg => ["-"; 3],
            Function::Not => ["!", "not ", "~"],
        })
    }

    /// Sign of a comparison or of logic, or the name of a function of two numbers.
    fn operator(self, operator: Operator) -> &'static str {
        self.of(match operator {
            Operator::Add => ["+"; 3],
            Operator::Sub => ["-"; 3],
            Operator::Mul => ["*"; 3],
            Operator::Div => ["/"; 3],
            Operator::Pow => ["pow", "np.float_power", "real_pow"],
            Operator::Min => ["fmin", "np.fmin", "min"],
            Operator::Max => ["fmax", "np.fmax", "max"],
            Operator::Less => ["<"; 3],
            Operator::LessOrEqual => ["<="; 3],
            Operator::Greater => [">"; 3],
            Operator::GreaterOrEqual => [">="; 3],
            Operator::Equal => ["=="; 3],
            Operator::And => ["&&", "and", "&&"],
            Operator::Or => ["||", "or", "||"],
        })
    }

    /// The opposite of a condition.
    fn not(self, condition: &str) -> String {
        match self {
            Self::C => format!("!({condition})"),
            Self::Python => format!("(not ({condition}))"),
            Self::Matlab => format!("~({condition})"),
        }
    }

    /// A number, as a condition: whether it is not zero.
    fn is_true(self, number: &str) -> String {
        number.to_owned() + self.of([" != 0.0", " != 0.0", " ~= 0"])
    }

    /// One of two numbers.
    fn choice(self, condition: &str, then: &str, otherwise: &str) -> String {
        match self {
            Self::C => format!("({condition} ? {then} : {otherwise})"),
            Self::Python => format!("({then} if {condition} else {otherwise})"),
            Self::Matlab => format!("pick({condition}, {then}, {otherwise})"),
        }
    }

    /// A line that gives a value to what is remembered, or to a name of its own.
    fn line(self, to: Name, name: &str, value: &str) -> String {
        let is_declared = self == Self::C && !matches!(to, Name::Memory(_));
        let declared = if is_declared { "const double " } else { "" };
        format!("{declared}{name} = {value}{}", self.of([";", "", ";"]))
    }
}

/// How strongly a text holds together; less than its surroundings needs parentheses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Logic,
    Comparison,
    Sum,
    Product,
    Sign,
    Whole,
}

/// A text and what kind of value it has.
#[derive(Debug)]
struct Written {
    text: String,
    binding: Binding,
    is_condition: bool,
}

impl Written {
    fn whole(text: String) -> Self {
        Self { text, binding: Binding::Whole, is_condition: false }
    }

    /// The text, in parentheses unless it binds more strongly than `binding`.
    fn within(self, binding: Binding) -> String {
        if self.binding > binding { self.text } else { format!("({})", self.text) }
    }
}

/// The lines of `program`, an equation of `effect`.
pub(super) fn lines(notation: Notation, effect: &Exported, program: &Program) -> Vec<String> {
    let scope = Scope { notation, effect, program };
    let line =
        |line: &Line| notation.line(line.to, &scope.name(line.to), &scope.number(&line.value).text);
    program.lines.iter().map(line).collect()
}

/// What a program gives, by the name that it has in its lines.
pub(super) fn result(program: &Program) -> String {
    program.locals.last().map_or_else(String::new, |name| local(name))
}

/// A local name as a variable that none of the templates has.
fn local(name: &str) -> String {
    const TAKEN: [&str; 5] = ["at", "model", "np", "s", "self"];
    let name = name.to_lowercase();
    if TAKEN.contains(&name.as_str()) { name + "_" } else { name }
}

#[derive(Clone, Copy)]
struct Scope<'a> {
    notation: Notation,
    effect: &'a Exported,
    program: &'a Program,
}

impl Scope<'_> {
    fn name(&self, name: Name) -> String {
        let of = |names: &[String], index: usize| names.get(index).cloned().unwrap_or_default();
        match name {
            Name::Signal(index) => {
                self.notation.signal(self.program.signals.get(index).copied().unwrap_or_default())
            }
            Name::Parameter(index) => self.notation.parameter(&of(&self.effect.parameters, index)),
            Name::Memory(index) => self.notation.memory(&of(&self.effect.memory, index)),
            Name::Local(index) => local(&of(&self.program.locals, index)),
        }
    }

    /// `node` as a number.
    fn number(&self, node: &Node) -> Written {
        let written = self.written(node);
        if written.is_condition {
            Written::whole(self.notation.choice(&written.text, "1.0", "0.0"))
        } else {
            written
        }
    }

    /// `node` as a condition.
    fn condition(&self, node: &Node) -> Written {
        let written = self.written(node);
        if written.is_condition {
            return written;
        }
        let text = self.notation.is_true(&written.within(Binding::Comparison));
        Written { text, binding: Binding::Comparison, is_condition: true }
    }

    fn written(&self, node: &Node) -> Written {
        match node {
            Node::Number(number) => Written::whole(format!("{number:?}")),
            Node::Named(name) => Written::whole(self.name(*name)),
            Node::Unary(function, argument) => self.unary(*function, argument),
            Node::Binary(operator, arguments) => self.binary(*operator, arguments),
            Node::If(parts) => {
                let [condition, then, otherwise] = parts.as_ref();
                let condition = self.condition(condition).text;
                let (then, otherwise) = (self.number(then).text, self.number(otherwise).text);
                Written::whole(self.notation.choice(&condition, &then, &otherwise))
            }
        }
    }

    fn unary(&self, function: Function, argument: &Node) -> Written {
        match function {
            Function::Not => {
                let text = self.notation.not(&self.condition(argument).text);
                Written { text, binding: Binding::Whole, is_condition: true }
            }
            Function::Neg => {
                let text = format!("-{}", self.number(argument).within(Binding::Sign));
                Written { text, binding: Binding::Sign, is_condition: false }
            }
            _ => {
                let argument = self.number(argument).text;
                let text = format!("{}({argument})", self.notation.function(function));
                let is_condition = function == Function::IsFinite;
                Written { text, binding: Binding::Whole, is_condition }
            }
        }
    }

    fn binary(&self, operator: Operator, arguments: &[Node; 2]) -> Written {
        let [left, right] = arguments;
        let name = self.notation.operator(operator);
        let binding = match operator {
            Operator::Pow | Operator::Min | Operator::Max => {
                let (left, right) = (self.number(left).text, self.number(right).text);
                return Written::whole(format!("{name}({left}, {right})"));
            }
            Operator::And | Operator::Or => {
                // Each in parentheses: who binds more strongly is not the same everywhere.
                let side = |node| self.condition(node).within(Binding::Logic);
                let text = format!("{} {name} {}", side(left), side(right));
                return Written { text, binding: Binding::Logic, is_condition: true };
            }
            Operator::Add | Operator::Sub => Binding::Sum,
            Operator::Mul | Operator::Div => Binding::Product,
            _ => Binding::Comparison,
        };
        // From the left: `a - b - c` needs no parentheses, `a - (b - c)` does.
        let left = self.number(left);
        let left = if left.binding == binding { left.text } else { left.within(binding) };
        let text = format!("{left} {name} {}", self.number(right).within(binding));
        Written { text, binding, is_condition: binding == Binding::Comparison }
    }
}
