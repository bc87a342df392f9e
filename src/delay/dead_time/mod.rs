//! The dead time of a joint whose input moves all the time, by a dynamic fit over the record.
//!
//! - [`dead_time`]: from the trials of a joint to its dead time, over the record and in windows
//! - [`DeadTime`]: the result
//!
//! Here, `response` is the structure in recursions, `curve` the static curve before it,
//! `record` and `moments` the regression, `search` and `profile` its minimum, `uncertainty`
//! the interval, `excitation`, `windows` and `feedback` what their names say.

mod curve;
mod excitation;
mod feedback;
mod fit;
mod moments;
mod profile;
mod record;
mod response;
mod result;
mod search;
mod uncertainty;
mod windows;

pub use fit::dead_time;
pub use result::{Bounds, DeadTime, ErrorPoint, Feedback, Finding, Unknown, Window};
