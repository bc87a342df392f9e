//! Where the output starts to react to each step: one path of onsets through a trial.

mod costs;
mod gradual;
mod locate;
mod onset;
mod path;
mod refine;
mod windows;

pub(crate) use gradual::{FromRest, GradualOnset};
pub(crate) use locate::{break_window, located};
pub(crate) use onset::Onset;
pub(crate) use path::OnsetPath;
pub(crate) use refine::{RefinedOnset, Refinement};
pub(crate) use windows::{Precision, fit_windows, thinned};
