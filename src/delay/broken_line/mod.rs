//! Lines that break once: between equally spaced samples, among scattered points, and at both
//! ends of a stroke.

mod frame;
mod gains;
mod piece;
mod regression;
mod stroke;
mod window;

pub(crate) use frame::Bends;
pub use regression::{BrokenRegression, broken_regression};
pub use stroke::{Stroke, stroke};
pub use window::{BrokenLine, broken_line};
pub(crate) use window::{Evidence, FEWEST, PARAMETERS, Window, median, p_value};
