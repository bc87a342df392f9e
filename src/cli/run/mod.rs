//! What commands on logs share: read, estimate, use threads, report.

mod against;
mod estimates;
mod session;
mod study;

pub(crate) use against::{compared, others};
pub(crate) use estimates::{Estimates, estimated, failures, notes};
pub(crate) use session::Session;
pub(crate) use study::{Start, Study, as_it_is, ended, log_hashes};
