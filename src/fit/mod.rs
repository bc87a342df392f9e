//! Models fitted to measurements: nonlinear least squares on the simulated output.
//!
//! - [`FitRecord`]: a joint's trials, cut into windows for training and for validation
//! - [`fit`]: the parameters that make the training error least, with standard errors
//! - [`assess`]: a model as it is, with the standard errors that a fit would find
//!
//! What the numbers mean for the model is the business of the module `diagnosis`.

mod beginning;
mod bounds;
mod coarse;
mod covariance;
mod descent;
mod evaluation;
mod excerpt;
mod extent;
mod first_order;
mod least_squares;
mod mended;
mod problem;
mod record;
mod result;
mod ripple;
mod run;
mod score;
mod search;
mod space;
mod speed;
mod starts;
mod survey;
mod turn;
mod unlogged;
mod window;

pub use evaluation::Evaluation;
pub(crate) use excerpt::Excerpt;
pub(crate) use extent::starts_s;
pub(crate) use first_order::{follows_input, makes_first_order, time_constant_s};
pub use least_squares::{assess, fit, fit_surveyed, fit_to_compare};
pub(crate) use mended::Mended;
pub use record::FitRecord;
pub(crate) use record::is_rounding;
pub use result::{AssessedModel, Assessment, Fit, FitError, Parameter, Status, Termination};
pub use score::{Directions, Score};
pub use survey::{RoughSurvey, Survey, end_survey, rough_survey, survey};
pub use window::{Horizon, Part, Split, Window};
