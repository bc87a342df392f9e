//! The project itself: which module may use which, and what the dependencies may be.

mod dependencies;
mod layering;
mod programs;
