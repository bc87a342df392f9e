//! What is drawn, as data: panels with axes and marks, coloured by what they mean.
//!
//! What is drawn, and in which role, stands here once: a segment with its lines, shares of an error,
//! the errors of revisions, delays by level. A report draws a [`Panel`] as SVG; a recording draws the
//! same data in Rerun's own views, which scale and label themselves.
//!
//! Recordings show some of it that is not shown elsewhere, which is unused in a program without them.

#![cfg_attr(not(feature = "rrd"), expect(dead_code, reason = "what only recordings show"))]

pub(crate) mod correlogram;
pub(crate) mod curves;
pub(crate) mod delay_levels;
pub(crate) mod error_share;
pub(crate) mod ladder;
mod panel;
pub(crate) mod segment;
mod span;

pub(crate) use panel::{Axis, Mark, Panel, Place, Revision, Role, Shape, within};
pub(crate) use span::{Span, thinned_places, thinned_to};
