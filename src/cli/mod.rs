//! Arguments, printing and exit status; no mathematics.
//!
//! - `program`: the commands by name, and the exit status
//! - `importer`: the program as a viewer calls it, to open a log
//! - `command`: each command, one file or folder
//! - `each_log`: a command on every log of a folder
//! - `run`: what commands on logs share: read, estimate, use threads, report
//! - `args`: options that several commands have
//! - `viewer`: recordings shown while they are made
//! - `output`: files, tables and recordings
//! - `failure`, `advice`: what is said of errors, and the option to use
//! - `typed`: command lines that are suggested or reported, and words that the program does not know
//! - `console`: messages, results and progress on the terminal

mod advice;
mod args;
mod command;
mod console;
mod each_log;
mod failure;
mod importer;
mod output;
mod program;
mod run;
mod typed;
mod viewer;

pub use console::Hosting;
pub use importer::run;
pub use program::{CommandOption, Refused, options_of, read_within, run_within};
