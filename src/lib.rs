//! tauscope
#![forbid(unsafe_code)]
pub mod experiment;
pub mod units;
