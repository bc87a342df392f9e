//! Is a model good enough, and if not, where does it fail?
//!
//! - [`compare()`]: all figures of one model on one record
//! - [`sensor_noise`]: the noise of the sensor, from the record alone
//! - [`lack_of_fit()`]: whether the residual is more than noise
//! - [`whiteness()`], [`input_correlation()`]: how the residual is correlated, with itself and
//!   with the input
//! - [`failure`]: where the error is

mod compare;
mod curves;
mod error;
pub mod failure;
mod input_correlation;
mod input_edges;
mod lack_of_fit;
mod lags;
mod local_misfit;
mod model_difference;
mod noise;
mod residual_size;
mod shapes;
mod speed_error;
mod step_error;
mod whiteness;

pub(crate) use compare::compare_unfitted;
pub use compare::{Comparison, compare};
pub(crate) use compare::{compare_knowing, lack_of};
pub use curves::{Curve, CurveOf};
pub use error::{ErrorFigures, RawErrors};
pub use input_correlation::{CrossCorrelation, InputCorrelation, input_correlation};
pub use input_edges::InputEdges;
pub use lack_of_fit::{Column, LackOfFit, NEGLIGIBLE, SIGNIFICANCE, TestColumns, lack_of_fit};
pub use lags::{CONFIDENCE, TrialSignals};
pub use local_misfit::LocalMisfit;
pub(crate) use model_difference::{ModelDifference, RegionPair};
pub use noise::sensor_noise;
pub(crate) use residual_size::{BEYOND_NOISE, NEAR_NOISE};
pub use residual_size::{ResidualSize, ShownBy};
pub use step_error::StepError;
pub use whiteness::{Whiteness, whiteness};
