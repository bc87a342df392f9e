//! What is drawn, as data: rendered as SVG for reports and in Rerun for recordings.

pub(crate) mod ladder;
