//! tauscope
pub mod batch;
pub mod delay;
pub mod experiment;
pub mod filter;
pub mod report;
pub mod synthetic;
pub mod units;
