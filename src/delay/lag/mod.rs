//! The lag that all steps of a joint share, and the regressions that find it.
//!
//! - [`LagModel`]: which poles, and where
//! - [`Response`]: what they make of a step of the speed; [`Basis`]: products of it over any piece
//! - [`FitWindow`]: a few onsets fitted together behind a lag; [`Linearised`]: what is found there
//! - [`LagSearch`]: the lag under which all windows of a joint fit best
//! - [`FreeMotion`]: what earlier steps left, where no new one acts
//! - [`Lag`]: what is reported

mod basis;
mod estimate;
mod fit_window;
mod free_motion;
mod information;
mod linearised;
mod model;
mod motion;
mod response;
mod search;
mod starts;

pub(crate) use basis::Basis;
pub use estimate::{Lag, LagPart};
pub(crate) use fit_window::{FINE, FitWindow};
pub(crate) use free_motion::FreeMotion;
pub(crate) use linearised::Linearised;
pub(crate) use model::LagModel;
pub(crate) use response::Response;
pub(crate) use search::LagSearch;
