//! Equations in the notation of a language.

use super::description::Exported;
use crate::effect::expression::{Function, Line, Name, Node, Operator, Program};

/// How a language writes what an equation is made of. Arguments are text already, in
/// parentheses where they need some.
pub(super) trait Notation {
    /// A parameter of the model.
    fn parameter(&self, name: &str) -> String;
    /// A number that an effect remembers.
    fn memory(&self, name: &str) -> String;
    /// What an effect sees of the joint at an instant.
    fn at(&self, name: &str) -> String {
        format!("at.{name}")
    }
    /// What an effect sees of the joint.
    fn signal(&self, name: &str) -> String {
        match name {
            "radians" => self.parameter("radians_per_output_unit"),
            _ => self.at(name),
        }
    }
    /// The name of a function of one number, which is called as in mathematics.
    fn function(&self, function: Function) -> &'static str;
    /// Sign of a comparison or of logic, or the name of a function of two numbers.
    fn operator(&self, operator: Operator) -> &'static str {
        usual_operator(operator)
    }
    /// The opposite of a condition.
    fn not(&self, condition: &str) -> String;
    /// A number, as a condition: whether it is not zero.
    fn is_true(&self, number: &str) -> String;
    /// One of two numbers.
    fn choice(&self, condition: &str, then: &str, otherwise: &str) -> String;
    /// A line that gives a value to a name of its own.
    fn local(&self, name: &str, value: &str) -> String {
        self.remember(name, value)
    }
    /// A line that gives a value to what is remembered.
    fn remember(&self, name: &str, value: &str) -> String {
        format!("{name} = {value};")
    }
}

/// The operator in C, and in most languages.
pub(super) fn usual_operator(operator: Operator) -> &'static str {
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
pub(super) fn lines(notation: &dyn Notation, effect: &Exported, program: &Program) -> Vec<String> {
    let scope = Scope { notation, effect, program };
    let line = |line: &Line| {
        let value = scope.number(&line.value).text;
        match line.to {
            Name::Memory(_) => notation.remember(&scope.name(line.to), &value),
            _ => notation.local(&scope.name(line.to), &value),
        }
    };
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
    notation: &'a dyn Notation,
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
