//! How every delay moves with the settings.
//!
//! - [`Grid`]: every combination of some methods, passbands, α and β
//! - [`Told`]: what one of them tells of a step, and how finely
//! - [`Agreement`]: the delay that most combinations can agree on
//! - [`JointSweep`]: all steps of a joint: what most say, and what a delay hangs on

mod agreement;
mod grid;
mod joint;

pub use agreement::{Agreement, Told};
pub use grid::{Base, Combination, Factor, Grid};
pub use joint::{Hanging, JointSweep, LevelSummary, RunSummary, RunTold, Spread, SweptStep};
