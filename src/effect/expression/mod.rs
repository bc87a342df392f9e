//! Effects of a user's own, written as an expression in a model file.
//!
//! ```text
//! if(signal > start, start + slope * (signal - start), signal)
//! ```
//!
//! An expression is made of numbers, `pi`, the parameters of the effect, the signals of its
//! stage, and, from the weakest to the strongest binding:
//!
//! ```text
//! ||    &&    < <= > >= == !=    + -    * /    - ! (sign, not)    ^
//! if(condition, value, other)  min(a, b, …)  max(a, b, …)
//! abs sign sqrt exp expm1 ln ln1p sin cos tan atan tanh floor is_finite, each of one value
//! ```
//!
//! `-x^2` is `-(x^2)`, `2^3^2` is `2^(3^2)`. A condition is 1 or 0, and every number but 0
//! counts as true.
//!
//! The result is the signal after the effect: of the transport stage the seconds by which
//! a change of the input arrives later, 0 being neutral. Where the result is not a finite
//! number, the effect does nothing.
//!
//! An effect may have states, which go on from moment to moment: see
//! [`OwnState`](super::OwnState). An expression is compiled once and takes 20 to 40 ns to compute.
//!
//! Without a value for each parameter at which it changes nothing, models with and without
//! the effect do not nest; [`Effect::nests`](crate::effect::Effect::nests) says so.

mod compiled;
mod error;
mod grammar;
mod program;
mod signals;
mod tree;

pub(crate) use compiled::KIND;
pub use compiled::define;
pub use error::DefinitionError;
pub use grammar::{Problem, SyntaxError};
pub(crate) use program::{Line, Program};
pub(crate) use tree::{Function, Name, Node, Operator};
