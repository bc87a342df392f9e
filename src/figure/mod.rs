//! What is drawn, as data: panels with axes and marks, coloured by what they mean.
//!
//! What is drawn, and in which role, stands here once: a segment with its lines, shares of an error,
//! the errors of revisions, delays by level. A report draws a [`Panel`] as SVG; a recording draws the
//! same data in Rerun's own views, which scale and label themselves.

#[cfg(feature = "rrd")]
pub(crate) mod correlogram;
#[cfg(feature = "rrd")]
pub(crate) mod course;
#[cfg(feature = "rrd")]
pub(crate) mod delay_against;
pub(crate) mod delay_levels;
pub(crate) mod error_share;
mod panel;
mod role;
pub(crate) mod segment;
mod span;

pub(crate) use panel::{Axis, Mark, Panel, Place, Shape};
pub(crate) use role::{Revision, Role};
#[cfg(feature = "rrd")]
pub(crate) use span::power_of_ten;
pub(crate) use span::{Span, thinned_to};
