//! An expression that is ready to be computed.

/// A function of one number.
pub(super) type Unary = fn(f64) -> f64;

/// A function of two numbers.
pub(super) type Binary = fn(f64, f64) -> f64;

/// A part of an expression.
#[derive(Clone, Debug)]
pub(super) enum Node {
    Number(f64),
    /// A signal, by its index in the list of the stage.
    Signal(usize),
    /// A parameter, by its index in the definition.
    Parameter(usize),
    Unary(Unary, Box<Self>),
    Binary(Binary, Box<[Self; 2]>),
    /// A condition, the value where it holds, and the value where it does not.
    If(Box<[Self; 3]>),
}

impl Node {
    pub(super) fn unary(function: Unary, argument: Self) -> Self {
        Self::Unary(function, Box::new(argument))
    }

    pub(super) fn binary(function: Binary, left: Self, right: Self) -> Self {
        Self::Binary(function, Box::new([left, right]))
    }

    /// The value at these signals and parameters; no number where one of them is missing.
    pub(super) fn value(&self, signals: &[f64], parameters: &[f64]) -> f64 {
        let of = |node: &Self| node.value(signals, parameters);
        match self {
            Self::Number(number) => *number,
            Self::Signal(index) => at(signals, *index),
            Self::Parameter(index) => at(parameters, *index),
            Self::Unary(function, argument) => function(of(argument)),
            Self::Binary(function, arguments) => {
                let [left, right] = arguments.as_ref();
                function(of(left), of(right))
            }
            Self::If(parts) => {
                let [condition, then, otherwise] = parts.as_ref();
                if is_true(of(condition)) { of(then) } else { of(otherwise) }
            }
        }
    }

    /// Whether it, or a part of it, is such a node.
    pub(super) fn has(&self, is_such: &impl Fn(&Self) -> bool) -> bool {
        let has = |node: &Self| node.has(is_such);
        let below = match self {
            Self::Number(_) | Self::Signal(_) | Self::Parameter(_) => false,
            Self::Unary(_, argument) => has(argument),
            Self::Binary(_, arguments) => arguments.iter().any(has),
            Self::If(parts) => parts.iter().any(has),
        };
        below || is_such(self)
    }
}

fn at(values: &[f64], index: usize) -> f64 {
    values.get(index).copied().unwrap_or(f64::NAN)
}

/// What counts as true: every number but zero.
pub(super) fn is_true(number: f64) -> bool {
    number != 0.0
}
