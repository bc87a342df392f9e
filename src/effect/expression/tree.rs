//! An expression that is ready to be computed, or to be written in another language.

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Abs,
    Sign,
    Sqrt,
    Exp,
    Expm1,
    Ln,
    Ln1p,
    Sin,
    Cos,
    Tan,
    Atan,
    Tanh,
    Floor,
    /// 1 where it is a number and not infinite, else 0.
    IsFinite,
    /// The sign turned.
    Neg,
    /// 1 of zero, 0 of every other number.
    Not,
}

/// What a function of one number computes.
type OfOne = fn(f64) -> f64;

/// Each function with its name in expressions and what it computes, in their order.
pub(super) const FUNCTIONS: [(Function, &str, OfOne); 16] = [
    (Function::Abs, "abs", f64::abs),
    (Function::Sign, "sign", sign),
    (Function::Sqrt, "sqrt", f64::sqrt),
    (Function::Exp, "exp", f64::exp),
    (Function::Expm1, "expm1", f64::exp_m1),
    (Function::Ln, "ln", f64::ln),
    (Function::Ln1p, "ln1p", f64::ln_1p),
    (Function::Sin, "sin", f64::sin),
    (Function::Cos, "cos", f64::cos),
    (Function::Tan, "tan", f64::tan),
    (Function::Atan, "atan", f64::atan),
    (Function::Tanh, "tanh", f64::tanh),
    (Function::Floor, "floor", f64::floor),
    (Function::IsFinite, "is_finite", |x| f64::from(x.is_finite())),
    (Function::Neg, "-", |x| -x),
    (Function::Not, "!", |x| f64::from(!is_true(x))),
];

impl Function {
    /// Its value at `x`.
    pub(super) fn value(self, x: f64) -> f64 {
        (FUNCTIONS[self as usize].2)(x)
    }
}

/// −1, 0 or 1.
fn sign(number: f64) -> f64 {
    if number > 0.0 {
        1.0
    } else if number < 0.0 {
        -1.0
    } else {
        number
    }
}

/// A function of two numbers; those of comparison and logic are 1 or 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Min,
    Max,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    And,
    Or,
}

impl Operator {
    /// Its value at `a` and `b`.
    #[expect(clippy::float_cmp, reason = "the one who writes `==` means it")]
    pub(super) fn value(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Sub => a - b,
            Self::Mul => a * b,
            Self::Div => a / b,
            Self::Pow => a.powf(b),
            Self::Min => a.min(b),
            Self::Max => a.max(b),
            Self::Less => f64::from(a < b),
            Self::LessOrEqual => f64::from(a <= b),
            Self::Greater => f64::from(a > b),
            Self::GreaterOrEqual => f64::from(a >= b),
            Self::Equal => f64::from(a == b),
            Self::And => f64::from(is_true(a) && is_true(b)),
            Self::Or => f64::from(is_true(a) || is_true(b)),
        }
    }
}

/// A number with a name, by its index in the list of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Name {
    /// Of the stage.
    Signal(usize),
    /// Of the effect.
    Parameter(usize),
    /// What the effect remembers.
    Memory(usize),
    /// Of a line before.
    Local(usize),
}

/// The numbers that have names.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Scope<'a> {
    pub(super) signals: &'a [f64],
    pub(super) parameters: &'a [f64],
    pub(super) memory: &'a [f64],
    pub(super) locals: &'a [f64],
}

impl Scope<'_> {
    fn value(&self, name: Name) -> f64 {
        let (values, index) = match name {
            Name::Signal(index) => (self.signals, index),
            Name::Parameter(index) => (self.parameters, index),
            Name::Memory(index) => (self.memory, index),
            Name::Local(index) => (self.locals, index),
        };
        values.get(index).copied().unwrap_or(f64::NAN)
    }
}

/// A part of an expression.
#[derive(Clone, Debug)]
pub(crate) enum Node {
    Number(f64),
    Named(Name),
    Unary(Function, Box<Self>),
    Binary(Operator, Box<[Self; 2]>),
    /// A condition, the value where it holds, and the value where it does not.
    If(Box<[Self; 3]>),
}

impl Node {
    pub(super) fn unary(function: Function, argument: Self) -> Self {
        Self::Unary(function, Box::new(argument))
    }

    pub(super) fn binary(operator: Operator, left: Self, right: Self) -> Self {
        Self::Binary(operator, Box::new([left, right]))
    }

    /// The value in this scope; no number where one of its names is missing.
    pub(super) fn value(&self, scope: &Scope<'_>) -> f64 {
        let of = |node: &Self| node.value(scope);
        match self {
            Self::Number(number) => *number,
            Self::Named(name) => scope.value(*name),
            Self::Unary(function, argument) => function.value(of(argument)),
            Self::Binary(operator, arguments) => {
                let [left, right] = arguments.as_ref();
                operator.value(of(left), of(right))
            }
            Self::If(parts) => {
                let [condition, then, otherwise] = parts.as_ref();
                if is_true(of(condition)) { of(then) } else { of(otherwise) }
            }
        }
    }

    /// Whether it, or a part of it, is such a node.
    pub(crate) fn has(&self, is_such: &impl Fn(&Self) -> bool) -> bool {
        let has = |node: &Self| node.has(is_such);
        let below = match self {
            Self::Number(_) | Self::Named(_) => false,
            Self::Unary(_, argument) => has(argument),
            Self::Binary(_, arguments) => arguments.iter().any(has),
            Self::If(parts) => parts.iter().any(has),
        };
        below || is_such(self)
    }
}

/// What counts as true: every number but zero.
fn is_true(number: f64) -> bool {
    number != 0.0
}
