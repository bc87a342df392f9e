//! What people see on a terminal: messages, results, progress; and Ctrl-C.

mod host;
mod terminal;

pub use host::Hosting;
pub(crate) use host::{Ended, Host};
pub(crate) use terminal::{
    Bar, Interrupt, STOPPING, Verbosity, message, print, print_json, print_with, warn,
};
