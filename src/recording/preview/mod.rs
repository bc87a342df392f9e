//! What is to be played and what is expected of it, before it is played.
//!
//! A page per joint shows the input, what the model or either suspect would make of it with
//! the margin of that, and where the two differ beyond the noise. On `segment` a cursor goes
//! from hold to hold, on `time` and `sample` through all samples.

mod data;
mod expected;
mod recording;
mod sheet;
mod words;

pub(crate) use recording::PreviewRecording;
