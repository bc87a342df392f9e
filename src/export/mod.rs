//! Models that leave the program: source code with one step function, and FMUs.
//!
//! ```text
//! effect ──equations──▶ lines ──notation──▶ C99, Python, MATLAB
//! ```
//!
//! Each effect gives its [`Equations`](crate::effect::Equations); they are printed in the
//! notation of a language, and put into that language's template of the joint (`template/`), which does
//! what [`simulate`](crate::model::simulate()) does: it delays the input, runs it through the stages
//! and integrates the speed. The languages:
//!
//! - C99 without allocation, source and header
//! - a module of Python for `NumPy`
//! - a function of MATLAB and GNU Octave
//! - an FMU: FMI 3.0 for co-simulation, around the C
//!
//! What is not here: the delay table as a lookup, which [`estimate`](crate::report) writes.

mod description;
mod error;
mod fmu;
mod language;
mod notation;
mod template;

pub use description::{Export, Units};
pub use error::ExportError;
pub use language::{File, Language, by_ending, endings};
pub(crate) use template::filled;
