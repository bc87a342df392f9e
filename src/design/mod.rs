//! The next experiment: an input to play.
//!
//! - [`random_steps`]: a finite set of levels, repeated, held for random times, as Albrecht and
//!   Taylor advise; the joint stays in its range as far as a model can tell
//! - [`shortest`]: the shortest input that tells two [`Suspects`] apart, and how surely
//! - [`Stand`], [`Uncertain`]: where it is played, and what is known of the joint
//! - [`Expected`]: how likely it is that two models are told apart
//!
//! An input is good where the best fit of the wrong model is far from what the right one does
//! (T-optimality; Atkinson and Fedorov 1975): see [`Expected`].

mod difference;
mod distance;
mod explore;
mod family;
mod glance;
mod glances;
mod known;
mod levels;
mod power;
mod predict;
mod random;
mod rehearsal;
mod response;
mod schedule;
mod search;
mod suspects;

pub use difference::{Apart, HoldApart, apart};
pub use explore::Open;
pub use family::Order;
pub use levels::{Band, default_hold_s, default_largest, default_levels};
pub use power::{Distance, Expected};
pub use predict::{Prediction, Stand, Uncertain};
pub use random::{RandomSteps, random_steps, transitions};
pub use rehearsal::Rehearsal;
pub use response::{response_s, resting_band};
pub use schedule::{Hold, Schedule};
pub use search::{Design, DesignError, Limits, Side, shortest};
pub use suspects::{Suspects, SuspectsError};
