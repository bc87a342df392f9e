//! tauscope
pub mod delay;
pub mod experiment;
pub mod filter;
pub mod units;
