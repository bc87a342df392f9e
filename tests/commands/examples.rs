//! The examples do what they say.

#[path = "../../examples/custom_effect.rs"]
mod custom_effect;
#[path = "../../examples/estimate_one_joint.rs"]
mod estimate_one_joint;
#[cfg(feature = "rrd")]
#[path = "../../examples/record_decisions.rs"]
mod record_decisions;
