//! Outputs that settle: a speed, a pressure, a servo's position, each an exponential behind its
//! dead time and not a ramp.

mod constants;
mod curvature;
mod following;
mod law;
mod response;
mod search;
mod trial;
mod window;

pub(crate) use following::{FirstOrder, followed};
pub use law::Settling;
pub(super) use law::SettlingOnset;
pub use response::Response;
