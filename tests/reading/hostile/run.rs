//! The program on a file, with an end to its time and its memory.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// What came of it.
#[derive(Debug)]
pub(crate) struct Ended {
    /// `None` where it was ended from outside.
    pub(crate) status: Option<i32>,
    pub(crate) said: String,
}

/// Where the program waits for something that does not come: far longer than any of these files takes.
const LONGEST: Duration = Duration::from_mins(3);

/// Kilobytes of address space, of which threads and libraries take a part, and seconds of the processor,
/// which a busy machine does not lengthen.
const LIMITS: &str = "ulimit -v 800000; ulimit -t 40";

/// What a file that is refused may cost: two seconds of the processor, which a busy machine does not
/// lengthen, and 200 MB of memory that is written to, whatever addresses libraries keep.
const REFUSED: &str = "ulimit -v 800000; ulimit -t 2; ulimit -d 200000";

/// Runs the program with two threads.
pub(crate) fn tauscope(arguments: &[&str]) -> Ended {
    run(&[arguments, &["--threads", "2"]].concat())
}

/// Runs the program.
pub(crate) fn run(arguments: &[&str]) -> Ended {
    run_within(LIMITS, arguments)
}

/// Runs the program within the limits that a shell sets.
fn run_within(limits: &str, arguments: &[&str]) -> Ended {
    let mut command = Command::new("sh");
    command.args(["-c", &format!("{limits}; exec \"$0\" \"$@\"")]);
    command.arg(env!("CARGO_BIN_EXE_tauscope")).args(arguments);
    let mut child =
        command.stdout(Stdio::null()).stderr(Stdio::piped()).stdin(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > LONGEST {
            child.kill().unwrap();
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let output = child.wait_with_output().unwrap();
    Ended {
        status: output.status.code(),
        said: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// Runs `estimate` on a file that must be refused with one message, which names it.
pub(crate) fn refused(path: &Path, arguments: &[&str]) -> String {
    let name = path.to_str().unwrap();
    let ended =
        run_within(REFUSED, &[&["estimate", name][..], arguments, &["--threads", "2"]].concat());
    assert_eq!(ended.status, Some(2), "{name}: {ended:?}");
    let errors: Vec<_> = ended.said.lines().filter(|line| line.starts_with("error: ")).collect();
    assert_eq!(errors.len(), 1, "{name}: {ended:?}");
    assert!(errors[0].contains(name), "{name}: {ended:?}");
    errors[0].to_owned()
}
