//! What people see on a terminal: messages, results, progress; and Ctrl-C.

mod host;
mod interrupt;
mod progress;
mod terminal;

pub use host::Hosting;
pub(crate) use host::{Ended, Host};
pub(crate) use interrupt::{Interrupt, STOPPING};
pub(crate) use progress::Bar;
pub(crate) use terminal::{Verbosity, message, print, print_json, print_with, warn};
