//! Which view shows what of a recording of decisions and models.

mod joint;
mod recording;

pub(super) use recording::{in_words, messages};
