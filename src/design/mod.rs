//! The next experiment: an input to play.
//!
//! - [`random_steps`]: a finite set of levels, repeated, held for random times, as Albrecht and
//!   Taylor advise; the joint stays in its range as far as a model can predict
//! - [`shortest`]: the shortest input that separates two [`Suspects`], and how surely
//! - [`TestRig`], [`Uncertain`]: where it is played, and what is known of the joint
//! - [`Expected`]: how likely it is that two models are separated
//!
//! An input is good where the best fit of the wrong model is far from what the right one does
//! (T-optimality; Atkinson and Fedorov 1975): see [`Expected`].

mod distance;
mod explore;
mod family;
mod free_run;
mod judge;
mod known;
mod left_out;
mod levels;
mod limits;
mod logged;
mod plan;
mod planned;
mod power;
mod predict;
mod problem;
mod queue;
mod random;
mod refusal;
mod rehearsal;
mod response;
mod result;
mod schedule;
mod screen;
mod search;
mod stops;
mod suspects;
mod trend;
mod within_range;

pub use free_run::{FreeRunError, RESERVE};
pub(crate) use levels::{default_hold_s, default_largest, default_levels};
pub use limits::Limits;
pub use logged::{Logged, Settling};
pub(crate) use plan::DURATION_S;
pub use plan::plan;
pub use planned::{Plan, PlanRequest};
pub use power::{Distance, Expected};
pub use predict::{Prediction, TestRig, Uncertain};
pub use random::{RandomSteps, random_steps, transitions};
pub(crate) use refusal::rounded;
pub use refusal::{NotKept, PlanError};
pub(crate) use response::response_s;
pub use result::{Design, DesignError, OpenThreshold, Order, Rehearsal, Side};
pub use schedule::{Hold, Schedule};
pub use search::shortest;
pub use suspects::{Suspects, SuspectsError};
pub use trend::Travel;
pub use within_range::reach;
