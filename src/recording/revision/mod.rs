//! The revisions of a model, along a timeline of their own: the error falls, and one sees
//! why.
//!
//! What is drawn lies on the other timelines too, at their first moment, so that the page is
//! never empty; there the last revision is seen.

mod ladder;
mod pages;

pub(super) use ladder::judged;
pub(super) use pages::add;
