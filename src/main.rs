//! The command line: see `tauscope --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    tauscope::cli::run()
}
