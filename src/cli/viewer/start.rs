//! Starting a viewer.

use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};

use super::program::{PORT, on_path};
use crate::cli::console::{Bar, Verbosity};

/// Longest time that a viewer may take to start.
const PATIENCE: Duration = Duration::from_mins(1);

/// The address of the viewer that runs on this machine, or of one that is started: it lives
/// on when this program has ended.
pub(crate) fn viewer(verbosity: Verbosity) -> anyhow::Result<String> {
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, PORT));
    if !is_listening(address) {
        let _bar = Bar::spinner(verbosity, "starting the viewer");
        started(address)?;
    }
    Ok(address.to_string())
}

fn started(address: SocketAddr) -> anyhow::Result<()> {
    let mut child = start()?;
    let end = Instant::now() + PATIENCE;
    while !is_listening(address) {
        if let Some(status) = child.try_wait().ok().flatten() {
            bail!(
                "the viewer ended at once ({status}); `tauscope doctor` says what is missing, and \
                 `-o FILE.rrd` writes the recording without a viewer"
            );
        }
        if Instant::now() > end {
            bail!("the viewer was started but does not listen at {address}");
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    Ok(())
}

/// The viewer, apart from our own input, output and Ctrl-C.
fn start() -> anyhow::Result<Child> {
    let path = on_path("rerun", std::env::var_os("PATH").as_deref());
    let path = path.context(
        "there is no viewer `rerun` on PATH; `tauscope doctor` says how to install it, and `-o \
         FILE.rrd` writes the recording without a viewer",
    )?;
    let mut command = Command::new(&path);
    command.args([&format!("--port={PORT}"), "--expect-data-soon"]);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt as _;
        command.process_group(0);
    }
    command.spawn().with_context(|| format!("{}: cannot be started", path.display()))
}

/// Whether `address` takes connections.
fn is_listening(address: SocketAddr) -> bool {
    TcpStream::connect_timeout(&address, Duration::from_secs(2)).is_ok()
}
