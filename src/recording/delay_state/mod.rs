//! What the delay depends on: a small plot per quantity, the strongest first.
//!
//! Each accepted step is a point in every plot, and the step under the cursor is marked in
//! all of them. Its numbers are logged beside.

mod page;
mod placed;
mod quantity;

pub(super) use page::{HEIGHT, add};
