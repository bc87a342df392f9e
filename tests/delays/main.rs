//! Delays: Algorithm 1 to the letter, the other methods against known delays, tables and sweeps of them.
#![expect(clippy::unwrap_used, reason = "a test may fail loudly")]

mod continuous_input;
mod delay_against_state;
mod delay_methods;
mod delay_table;
mod export;
mod lengths;
mod low_pass_equals_scipy;
mod manipulator;
mod measured_logs;
mod onset_model;
mod rank_equals_scipy;
#[path = "../support/real.rs"]
mod real;
#[path = "../support/sample.rs"]
mod sample;
mod settling;
#[path = "../support/stroke.rs"]
mod stroke;
mod strokes;
mod sweep;
mod tracking;
mod two_lines_brute_force;
mod worked_example;
