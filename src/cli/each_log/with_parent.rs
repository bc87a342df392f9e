//! Programs that end with the one that started them, whatever ended that.

use std::io;
use std::process::{Command, Output, Stdio};

/// Says to a program that it was started by this one, and that its standard input lasts as long.
const MARK: &str = "TAUSCOPE_ENDS_WITH_STDIN";

/// Exit status of a program whose parent is gone: that of one that was terminated.
const ORPHANED: i32 = 143;

/// What a program says that is started so.
pub(super) fn output(command: &mut Command) -> io::Result<Output> {
    command.env(MARK, "1").stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn()?;
    // The system closes the pipe when this program ends, even where it is killed.
    let pipe = child.stdin.take();
    let output = child.wait_with_output();
    drop(pipe);
    output
}

/// Lets this program end with its parent, where it was started so.
pub(crate) fn end_with_parent() {
    if std::env::var_os(MARK).is_some() {
        std::thread::spawn(|| {
            io::copy(&mut io::stdin(), &mut io::sink()).unwrap_or_default();
            std::process::exit(ORPHANED);
        });
    }
}
