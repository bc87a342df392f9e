//! The grammar of expressions, and what is said where one does not follow it.

use winnow::Parser;
use winnow::ascii::{float, multispace0};
use winnow::combinator::Infix::{Left, Neither, Right};
use winnow::combinator::{
    Infix, Prefix, alt, eof, expression, opt, peek, preceded, separated, terminated,
};
use winnow::error::{ErrMode, ModalResult, ParserError};
use winnow::stream::{Stateful, Stream as _};
use winnow::token::{one_of, take_while};

use super::tree::{FUNCTIONS, Function, Name, Node, Operator};
use crate::experiment::{did_you_mean, nearest_name};

/// The longest expression, in bytes: longer than anyone reads.
///
/// The parser calls itself; this and the next two see to it that it does not run out of
/// stack, on whatever thread.
const LONGEST: usize = 1000;

/// Parentheses within parentheses.
const DEEPEST: usize = 16;

/// Signs and powers in one expression.
const MOST_SIGNS: usize = 50;

/// How strongly signs bind: more than a product, less than a power, so that `-x^2` is
/// `-(x^2)`.
const SIGN: i64 = 60;

/// Names of numbers.
const CONSTANTS: [(&str, f64); 1] = [("pi", std::f64::consts::PI)];

/// Functions of two numbers or more.
const SEVERAL: [(&str, Operator); 2] = [("min", Operator::Min), ("max", Operator::Max)];

/// The function of a condition and two values.
const CONDITIONAL: &str = "if";

/// Whether `name` is that of a function or a constant.
pub(super) fn is_taken(name: &str) -> bool {
    functions().chain(CONSTANTS.map(|(name, _)| name)).any(|taken| taken == name)
}

fn functions() -> impl Iterator<Item = &'static str> {
    // The signs are no names.
    let of_one = FUNCTIONS.iter().map(|(_, name, _)| *name);
    let of_one = of_one.filter(|name| name.starts_with(char::is_alphabetic));
    of_one.chain(SEVERAL.map(|(name, _)| name)).chain([CONDITIONAL])
}

/// Why an expression cannot be computed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("column {column} of `{text}`: {problem}")]
pub struct SyntaxError {
    /// The expression.
    pub text: String,
    /// Where, in characters from 1.
    pub column: usize,
    /// What is wrong there.
    pub problem: Problem,
}

/// What is wrong at a column of an expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Something else must be there.
    #[error("expected {0}")]
    Expected(&'static str),
    /// There is no signal, parameter, constant or function of this name.
    #[error("`{name}` is not known{}; known: {known}", did_you_mean(nearest_name(name, [nearest.as_str()])))]
    Unknown {
        /// The name.
        name: String,
        /// The name that is most like it.
        nearest: String,
        /// All names there are.
        known: String,
    },
    /// A number has parentheses after it.
    #[error("`{0}` is not a function; a product is written with `*`")]
    NotAFunction(String),
    /// A function has none.
    #[error("`{0}` is a function, and needs its values in parentheses")]
    NotANumber(String),
    /// A function has too few arguments, or too many.
    #[error("`{function}` takes {expected}, not {found}")]
    Arguments {
        /// The function.
        function: String,
        /// How many it takes, in words.
        expected: &'static str,
        /// How many there are.
        found: usize,
    },
    /// It is longer than any that can be read.
    #[error("it has {0} characters; at most {LONGEST} are allowed")]
    TooLong(usize),
    /// Too many parentheses within one another.
    #[error("more than {DEEPEST} parentheses are open")]
    TooDeep,
    /// Too many signs and powers.
    #[error("more than {MOST_SIGNS} of `-`, `!` and `^`")]
    TooManySigns,
}

/// The names an expression may use besides functions and constants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Names<'a> {
    pub(super) signals: &'a [&'static str],
    pub(super) parameters: &'a [&'a str],
    pub(super) memory: &'a [&'a str],
    /// Of the lines before.
    pub(super) locals: &'a [&'a str],
}

impl<'a> Names<'a> {
    fn all(&self) -> impl Iterator<Item = &'a str> {
        let given = self.signals.iter().chain(self.parameters);
        given.chain(self.memory).chain(self.locals).copied()
    }

    pub(super) fn find(&self, name: &str) -> Option<Name> {
        let place = |names: &[&str]| names.iter().position(|known| *known == name);
        let signal = place(self.signals).map(Name::Signal);
        let parameter = || place(self.parameters).map(Name::Parameter);
        let memory = || place(self.memory).map(Name::Memory);
        let local = || place(self.locals).map(Name::Local);
        signal.or_else(parameter).or_else(memory).or_else(local)
    }
}

#[derive(Clone, Copy, Debug)]
struct State<'a> {
    names: Names<'a>,
    /// Parentheses that are open.
    depth: usize,
    /// Signs and powers so far.
    signs: usize,
}

type Input<'a> = Stateful<&'a str, State<'a>>;
type Parsed<T> = ModalResult<T, Problem>;
type InfixOf<'a> = Infix<Input<'a>, Node, ErrMode<Problem>>;
type PrefixOf<'a> = Prefix<Input<'a>, Node, ErrMode<Problem>>;

/// What a parser says that is only ever an alternative to another.
impl<'a> ParserError<Input<'a>> for Problem {
    type Inner = Self;

    fn from_input(_input: &Input<'a>) -> Self {
        Self::Expected("a value")
    }

    fn into_inner(self) -> Result<Self, Self> {
        Ok(self)
    }
}

/// The expression in `text`.
pub(super) fn parse(text: &str, names: Names<'_>) -> Result<Node, SyntaxError> {
    let error = |column, problem| SyntaxError { text: text.to_owned(), column, problem };
    if text.len() > LONGEST {
        return Err(error(LONGEST + 1, Problem::TooLong(text.chars().count())));
    }
    let input = Input { input: text, state: State { names, depth: 0, signs: 0 } };
    let end = must(eof.void(), "an operator or the end");
    preceded(multispace0, terminated(whole, end)).parse(input).map_err(|found| {
        let before = text.get(..found.offset()).unwrap_or(text);
        error(before.chars().count() + 1, found.into_inner())
    })
}

/// `parser`, which is the only way to go on.
fn must<'a, T>(
    mut parser: impl Parser<Input<'a>, T, ErrMode<Problem>>,
    expected: &'static str,
) -> impl Parser<Input<'a>, T, ErrMode<Problem>> {
    move |input: &mut Input<'a>| {
        let start = input.checkpoint();
        let found = parser.parse_next(input).ok();
        found.ok_or_else(|| {
            input.reset(&start);
            ErrMode::Cut(Problem::Expected(expected))
        })
    }
}

/// Operands with operators between them.
fn whole(input: &mut Input<'_>) -> Parsed<Node> {
    expression(operand).prefix(prefix).infix(infix).parse_next(input)
}

fn operand(input: &mut Input<'_>) -> Parsed<Node> {
    terminated(alt((number, parentheses, named)), multispace0).parse_next(input)
}

fn number(input: &mut Input<'_>) -> Parsed<Node> {
    peek(one_of(('0'..='9', '.'))).parse_next(input)?;
    let finite = float.verify(|number: &f64| number.is_finite());
    must(finite, "a finite number").map(Node::Number).parse_next(input)
}

fn parentheses(input: &mut Input<'_>) -> Parsed<Node> {
    opening(input)?;
    let inside = whole(input)?;
    closing(input, "an operator or `)`")?;
    Ok(inside)
}

/// A number that has a name, or a function of some.
fn named(input: &mut Input<'_>) -> Parsed<Node> {
    let start = input.checkpoint();
    let letters = |c: char| c.is_ascii_alphanumeric() || c == '_';
    peek(one_of(('a'..='z', 'A'..='Z', '_'))).parse_next(input)?;
    let name = terminated(take_while(1.., letters), multispace0).parse_next(input)?;
    let found = if opt(opening).parse_next(input)?.is_some() {
        let arguments = separated(1.., whole, (',', multispace0)).parse_next(input)?;
        closing(input, "an operator, `,` or `)`")?;
        call(name, arguments, input.state.names)
    } else {
        look_up(name, input.state.names)
    };
    found.map_err(|problem| {
        input.reset(&start);
        ErrMode::Cut(problem)
    })
}

/// `(`, and one more parenthesis is open.
fn opening(input: &mut Input<'_>) -> Parsed<()> {
    let start = input.checkpoint();
    ('(', multispace0).void().parse_next(input)?;
    input.state.depth += 1;
    if input.state.depth > DEEPEST {
        input.reset(&start);
        return Err(ErrMode::Cut(Problem::TooDeep));
    }
    Ok(())
}

fn closing(input: &mut Input<'_>, expected: &'static str) -> Parsed<()> {
    must(')', expected).parse_next(input)?;
    input.state.depth -= 1;
    Ok(())
}

fn look_up(name: &str, names: Names<'_>) -> Result<Node, Problem> {
    let constant = CONSTANTS.iter().find(|(known, _)| *known == name);
    let constant = constant.map(|(_, value)| Node::Number(*value));
    let found = constant.or_else(|| names.find(name).map(Node::Named));
    if found.is_none() && functions().any(|function| function == name) {
        return Err(Problem::NotANumber(name.to_owned()));
    }
    found.ok_or_else(|| unknown(name, names.all().chain(CONSTANTS.map(|(name, _)| name))))
}

fn unknown<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Problem {
    let known: Vec<_> = known.collect();
    let likeness = |known: &str| strsim::jaro_winkler(name, known);
    let nearest = known.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    let nearest = nearest.copied().unwrap_or_default().to_owned();
    Problem::Unknown { name: name.to_owned(), nearest, known: known.join(", ") }
}

fn call(name: &str, arguments: Vec<Node>, names: Names<'_>) -> Result<Node, Problem> {
    let found = arguments.len();
    let wrong = |expected| Problem::Arguments { function: name.to_owned(), expected, found };
    if name == CONDITIONAL {
        let parts = <[Node; 3]>::try_from(arguments).ok();
        let parts = parts.ok_or_else(|| wrong("a condition and two values"))?;
        return Ok(Node::If(Box::new(parts)));
    }
    if let Some((_, function)) = SEVERAL.iter().find(|(known, _)| *known == name) {
        let pair = |left, right| Node::binary(*function, left, right);
        let all = arguments.into_iter().reduce(pair).filter(|_| found > 1);
        return all.ok_or_else(|| wrong("two values or more"));
    }
    if let Some((function, ..)) = FUNCTIONS.iter().find(|(_, known, _)| *known == name) {
        let argument = <[Node; 1]>::try_from(arguments).ok();
        let [argument] = argument.ok_or_else(|| wrong("one value"))?;
        return Ok(Node::unary(*function, argument));
    }
    if look_up(name, names).is_ok() {
        return Err(Problem::NotAFunction(name.to_owned()));
    }
    Err(unknown(name, functions()))
}

/// A sign, or `!` for "not"; nothing else may stand where a value does.
fn prefix<'a>(input: &mut Input<'a>) -> Parsed<PrefixOf<'a>> {
    let symbol = must(one_of(['-', '!']), "a value").parse_next(input)?;
    multispace0.parse_next(input)?;
    count_sign(input)?;
    Ok(match symbol {
        '-' => Prefix(SIGN, |_, value| Ok(Node::unary(Function::Neg, value))),
        _ => Prefix(SIGN, |_, value| Ok(Node::unary(Function::Not, value))),
    })
}

fn count_sign(input: &mut Input<'_>) -> Parsed<()> {
    input.state.signs += 1;
    if input.state.signs > MOST_SIGNS { Err(ErrMode::Cut(Problem::TooManySigns)) } else { Ok(()) }
}

/// The operators, by how strongly they bind.
fn infix<'a>(input: &mut Input<'a>) -> Parsed<InfixOf<'a>> {
    let double = alt(("||", "&&", "<=", ">=", "==", "!="));
    let symbol = alt((double, "<", ">", "+", "-", "*", "/", "^"));
    let symbol: &str = terminated(symbol, multispace0).parse_next(input)?;
    if symbol == "^" {
        count_sign(input)?;
    }
    Ok(match symbol {
        "||" => Left(10, |_, a, b| Ok(Node::binary(Operator::Or, a, b))),
        "&&" => Left(20, |_, a, b| Ok(Node::binary(Operator::And, a, b))),
        "<" => Neither(30, |_, a, b| Ok(Node::binary(Operator::Less, a, b))),
        ">" => Neither(30, |_, a, b| Ok(Node::binary(Operator::Greater, a, b))),
        "<=" => Neither(30, |_, a, b| Ok(Node::binary(Operator::LessOrEqual, a, b))),
        ">=" => Neither(30, |_, a, b| Ok(Node::binary(Operator::GreaterOrEqual, a, b))),
        "==" => Neither(30, |_, a, b| Ok(Node::binary(Operator::Equal, a, b))),
        "!=" => Neither(30, |_, a, b| {
            Ok(Node::unary(Function::Not, Node::binary(Operator::Equal, a, b)))
        }),
        "+" => Left(40, |_, a, b| Ok(Node::binary(Operator::Add, a, b))),
        "-" => Left(40, |_, a, b| Ok(Node::binary(Operator::Sub, a, b))),
        "*" => Left(50, |_, a, b| Ok(Node::binary(Operator::Mul, a, b))),
        "/" => Left(50, |_, a, b| Ok(Node::binary(Operator::Div, a, b))),
        _ => Right(70, |_, a, b| Ok(Node::binary(Operator::Pow, a, b))),
    })
}

#[cfg(test)]
mod tests {
    use super::super::tree::Scope;
    use proptest::prelude::*;

    use super::*;

    const NAMES: Names<'static> = Names {
        signals: &["signal", "position"],
        parameters: &["slope", "start"],
        memory: &[],
        locals: &[],
    };

    /// The value where signal, position, slope and start are 3, 5, 7 and 2.
    fn value(text: &str) -> f64 {
        let (signals, parameters) = (&[3.0, 5.0], &[7.0, 2.0]);
        parse(text, NAMES).unwrap().value(&Scope { signals, parameters, ..Scope::default() })
    }

    fn problem(text: &str) -> (usize, String) {
        let error = parse(text, NAMES).unwrap_err();
        (error.column, error.problem.to_string())
    }

    #[test]
    fn operators_bind_as_in_mathematics() {
        for (text, expected) in [
            ("1 + 2 * 3", 7.0),
            ("(1 + 2) * 3", 9.0),
            ("8 / 4 / 2", 1.0),
            ("8 - 4 - 2", 2.0),
            ("2^3^2", 512.0),
            ("-signal^2", -9.0),
            ("2 * -signal", -6.0),
            ("2^-1", 0.5),
            ("- -signal", 3.0),
            ("signal - -1", 4.0),
            (" 1.5e1 + .5 + 1. ", 16.5),
            ("pi", std::f64::consts::PI),
        ] {
            assert!((value(text) - expected).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn conditions_are_one_or_zero() {
        for (text, expected) in [
            ("signal > start", 1.0),
            ("signal >= 3 && position <= 5", 1.0),
            ("signal < 3 || position != 5", 0.0),
            ("1 || 0 && 0", 1.0),
            ("!(signal == 3)", 0.0),
            ("!signal == 0", 1.0),
            ("if(signal > start, start + slope * (signal - start), signal)", 9.0),
            ("if(signal > 4, 1, if(signal > 2, 2, 3))", 2.0),
            ("if(signal - 3, 1 / (signal - 3), 4)", 4.0),
        ] {
            assert!((value(text) - expected).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn functions_are_called_with_as_many_values_as_they_take() {
        for (text, expected) in [
            ("abs(-signal)", 3.0),
            ("sign(-signal) + sign(0)", -1.0),
            ("min(signal, position, slope)", 3.0),
            ("max(min(signal, 1), start)", 2.0),
            ("sqrt(4) + floor(2.7) + exp(0) + ln(1)", 5.0),
            ("sin(0) + cos(0) + tan(0) + atan(0) + tanh(0)", 1.0),
        ] {
            assert!((value(text) - expected).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        for (text, column, part) in [
            ("", 1, "expected a value"),
            ("signal +", 9, "expected a value"),
            ("signal * / 2", 10, "expected a value"),
            ("2 signal", 3, "expected an operator or the end"),
            ("signal = 2", 8, "expected an operator or the end"),
            ("1 < 2 < 3", 7, "expected an operator or the end"),
            ("(signal", 8, "expected an operator or `)`"),
            ("signal)", 7, "expected an operator or the end"),
            ("min(1, 2", 9, "expected an operator, `,` or `)`"),
            ("min(1, )", 8, "expected a value"),
            ("abs()", 5, "expected a value"),
            ("1e999", 1, "expected a finite number"),
            ("1 + .", 5, "expected a finite number"),
            ("α + 1", 1, "expected a value"),
            (
                "1 + sgnal",
                5,
                "`sgnal` is not known (did you mean `signal`?); known: signal, position, slope, start, pi",
            ),
            ("maks(1, 2)", 1, "known: abs, sign, sqrt"),
            ("slope (signal)", 1, "`slope` is not a function"),
            ("abs(1, 2)", 1, "`abs` takes one value, not 2"),
            ("max(1)", 1, "`max` takes two values or more, not 1"),
            ("if(1, 2)", 1, "`if` takes a condition and two values, not 2"),
            ("abs + 1", 1, "`abs` is a function"),
        ] {
            let (found, said) = problem(text);
            assert!(found == column && said.contains(part), "{text}: column {found}, {said}");
        }
    }

    proptest! {
        #[test]
        fn no_text_is_too_odd(text in "([-+*/^!<>=&|(),. ]|[0-9e]{1,3}|signal|slope|if|min|abs|α){0,30}") {
            if let Err(error) = parse(&text, NAMES) {
                prop_assert!((1..=text.chars().count() + 1).contains(&error.column), "{}", error);
            }
        }
    }

    #[test]
    fn no_length_and_no_depth_is_too_much() {
        let all = "1||1&&1<1+1*-1^(";
        for (open, close) in
            [("(", ")"), ("-", ""), ("1^", ""), ("1^-", ""), ("1+", ""), ("abs(", ")"), (all, ")")]
        {
            let parsed = |count: usize| {
                let text = open.repeat(count) + "1" + &close.repeat(count);
                parse(&text, NAMES).map(|node| node.value(&Scope::default()))
            };
            for count in 1..=550 {
                assert!(parsed(count).is_err() || parsed(count).unwrap().is_finite());
            }
            assert!(parsed(10).is_ok(), "{open}");
            assert!(parsed(100_000).is_err(), "{open}");
        }
        assert_eq!(problem(&"(".repeat(40)).1, Problem::TooDeep.to_string());
        assert_eq!(problem(&"-".repeat(60)).1, Problem::TooManySigns.to_string());
        assert_eq!(problem(&"1+".repeat(600)).1, Problem::TooLong(1200).to_string());
    }
}
