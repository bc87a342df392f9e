//! Models: simulation, fits, comparison, the judgement of what is missing, design and export.
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

mod add;
mod compare;
mod conditions;
mod custom_effect;
mod cylinder;
mod design;
#[path = "../support/desk.rs"]
mod desk;
mod effect_dynamics;
mod emps;
mod explain;
mod export_models;
mod failure;
mod fits_never_worse;
mod fitting;
mod hidden_effect;
mod hidden_effects;
mod improve;
mod measured_delays;
mod measured_joints;
mod measured_signals;
mod own_effects;
mod rates_and_orders;
#[path = "../support/real.rs"]
mod real;
mod revisions;
#[path = "../support/sample.rs"]
#[expect(dead_code, reason = "coverage is counted elsewhere")]
mod sample;
mod scenarios;
mod separation;
mod simulation;
#[path = "../support/stroke.rs"]
#[expect(dead_code, reason = "other stories look at delays alone")]
mod stroke;
mod strokes;
mod valve_laws;
