//! What is drawn, as data: panels with axes and marks, coloured by what they mean.
//!
//! It is rendered twice: as SVG for the page of a report, and in Rerun for recordings. What
//! differs between the two, such as timelines and where plots lie, stays there.

#[cfg(feature = "rrd")]
pub(crate) mod correlogram;
#[cfg(feature = "rrd")]
pub(crate) mod course;
#[cfg(feature = "rrd")]
pub(crate) mod delay_against;
pub(crate) mod delay_levels;
pub(crate) mod error_share;
pub(crate) mod ladder;
mod panel;
mod role;
pub(crate) mod segment;
mod span;

pub(crate) use panel::{Axis, Mark, Panel, Place, Shape};
pub(crate) use role::Role;
pub(crate) use span::{Span, thinned_to};
