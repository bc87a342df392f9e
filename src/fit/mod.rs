//! Models fitted to measurements: nonlinear least squares on the simulated output.
//!
//! - [`FitRecord`]: a joint's trials, cut into windows for training and for validation
//! - [`fit`]: the parameters that make the training error least, with standard errors
//!
//! What the numbers mean for the model is the business of the module `diagnosis`.

mod bounds;
mod covariance;
mod least_squares;
mod problem;
mod record;
mod run;
mod score;
mod search;
mod space;
mod speed;
mod starts;
mod thin;

pub use least_squares::{
    Fit, FitError, Parameter, Status, Survey, Termination, assess, fit, fit_to_compare, survey,
};
pub use record::{Evaluation, FitRecord, Horizon, Part, Split, Window};
pub use score::{Directions, Score};
