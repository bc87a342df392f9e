//! All joints of an experiment: what is done with each, by any [`Workers`](crate::explain::Workers).
//!
//! - [`estimate_joints`]: the delays of every joint
//! - [`sweep_joints`]: the delays with every setting of a grid
//! - [`Review`]: what persons say of decisions
//! - [`JointDifferences`]: decisions beside those of [`OtherResult`], read or estimated
//! - [`compare_joints`], [`explain_joints`], [`add_to_joints`], [`improve_joints`]: the model of
//!   every joint, under a [`Protocol`]
//! - [`know_joints`], [`suspect_joints`]: what an experiment is designed from
//!
//! Results come back in the order of the joints; a joint that fails does not stop the others.

mod difference;
mod earlier;
mod estimate;
mod models;
mod protocol;
mod review;
mod sheet;
mod start;
mod sweep;

pub use difference::{JointDifferences, JointResult, OtherResult, StepPair, StepResult, Verdicts};
pub(crate) use estimate::estimate_each;
pub use estimate::{JointEstimate, estimate_joints};
pub(crate) use models::{Known, OfJoints, explain_unknown_joints, others_of};
pub use models::{
    add_to_joints, compare_joints, explain_joints, improve_joints, know_joints, suspect_joints,
};
pub(crate) use protocol::Watch;
pub use protocol::{Mode, Protocol, Watched};
pub use review::Review;
pub use sheet::FileError;
pub use sweep::{SweptJoint, sweep_joints};
