//! How every delay moves with the settings.
//!
//! - [`Grid`]: every combination of some methods, passbands, α and β
//! - [`ReportedDelay`]: the delay that one of them reports of a step, and how finely
//! - [`Agreement`]: the delay that most combinations can agree on
//! - [`SweptStep`]: a step over all of them, with the setting that moves its delay
//! - [`JointSweep`]: all steps of a joint

mod agreement;
mod grid;
mod joint;
mod run;
mod step;

pub use agreement::{Agreement, ReportedDelay};
pub use grid::{Base, Combination, Factor, Grid};
pub use joint::JointSweep;
pub use run::{LevelSummary, RunDelays, RunSummary};
pub use step::{Sensitivity, Spread, SweptStep};
