//! Recordings that a viewer shows while they are made: `--connect`, `--spawn`, `--serve`.

use std::net::SocketAddr;

use clap::Args;

use super::program::PORT;
use crate::cli::console::Verbosity;
#[cfg(feature = "rrd")]
use crate::cli::console::{self, Interrupt};
use crate::cli::failure::Completion;
#[cfg(feature = "rrd")]
use crate::cli::failure::said;
use crate::report::{Recording, SweepRecording};

/// Which viewer shows the recording while it is made.
#[derive(Args, Debug)]
#[command(next_help_heading = "Show it in a viewer while the command runs")]
pub(crate) struct StreamArgs {
    /// Show the recording while it is made, in a viewer that runs [default: 127.0.0.1:9876]
    #[arg(
        long, value_name = "HOST:PORT", value_parser = address, num_args = 0..=1,
        default_missing_value = "127.0.0.1:9876", group = "viewer"
    )]
    connect: Option<String>,

    /// Show the recording while it is made, in a viewer that is started unless one runs
    #[arg(long, group = "viewer")]
    spawn: bool,

    /// Serve the recording to viewers that connect, until Ctrl-C [default: 127.0.0.1:9876,
    /// for viewers on this machine; 0.0.0.0:9876 is for all]
    #[arg(
        long, value_name = "ADDRESS:PORT", value_parser = own_address, num_args = 0..=1,
        default_missing_value = "127.0.0.1:9876", group = "viewer"
    )]
    serve: Option<SocketAddr>,
}

/// An address as it is typed, so that a file in its place is distinguished from it.
fn address(text: &str) -> Result<String, String> {
    let port = text.rsplit_once(':').map(|(_, port)| port.parse::<u16>());
    if text.contains("://") || matches!(port, Some(Ok(_))) {
        return Ok(text.to_owned());
    }
    Err(format!("expected HOST:PORT, as in 127.0.0.1:{PORT}; DATA goes before this option"))
}

fn own_address(text: &str) -> Result<SocketAddr, String> {
    text.parse().ok().ok_or_else(|| {
        format!(
            "expected an address of this machine and a port, as in 0.0.0.0:{PORT}; DATA goes \
             before this option"
        )
    })
}

impl StreamArgs {
    /// Whether a viewer is to be there.
    pub(crate) fn is_asked(&self) -> bool {
        self.connect.is_some() || self.spawn || self.serve.is_some()
    }

    /// Reaches the viewer, before any work is done.
    #[cfg(feature = "rrd")]
    pub(crate) fn open(&self, verbosity: Verbosity) -> anyhow::Result<Stream> {
        use crate::recording::Live;

        let live = match (&self.connect, self.serve) {
            (Some(address), _) => Some(Live::connect(address)?),
            (_, Some(address)) => Some(Live::serve(address)?),
            _ if self.spawn => Some(Live::connect(&super::start::viewer(verbosity)?)?),
            _ => None,
        };
        if let Some(live) = live.as_ref().filter(|live| live.is_served()) {
            let url = live.url();
            verbosity.say("serving", format!("open it with: rerun --connect {url}"));
        }
        Ok(Stream(live.map(Into::into)))
    }

    #[cfg(not(feature = "rrd"))]
    pub(crate) fn open(&self, _: Verbosity) -> anyhow::Result<Stream> {
        if self.is_asked() {
            return Err(crate::cli::output::left_out());
        }
        Ok(Stream(()))
    }
}

/// The way to a viewer, where one was asked for.
#[cfg(feature = "rrd")]
pub(crate) struct Stream(Option<std::sync::Mutex<crate::recording::Live>>);

/// None: there are no recordings.
#[cfg(not(feature = "rrd"))]
pub(crate) struct Stream(());

#[cfg(feature = "rrd")]
impl Stream {
    pub(crate) fn is_open(&self) -> bool {
        self.0.is_some()
    }

    /// Shows what is new of `recording`; of one joint alone where it is named.
    pub(crate) fn send(
        &self,
        recording: &Recording<'_>,
        joint: Option<&str>,
    ) -> anyhow::Result<()> {
        let Some(live) = &self.0 else { return Ok(()) };
        let mut live = live.lock().map_err(|_poisoned| bug())?;
        Ok(live.send(recording, joint)?)
    }

    /// Shows delays over all settings.
    pub(crate) fn send_sweep(&self, sweep: &SweepRecording<'_>) -> anyhow::Result<()> {
        let Some(live) = &self.0 else { return Ok(()) };
        let mut live = live.lock().map_err(|_poisoned| bug())?;
        Ok(live.send_sweep(sweep)?)
    }

    /// Waits until the viewer has everything; where viewers are served, until Ctrl-C.
    pub(crate) fn close(
        &self,
        completion: Completion,
        verbosity: Verbosity,
    ) -> anyhow::Result<Completion> {
        use std::time::Duration;

        let Some(live) = &self.0 else { return Ok(completion) };
        let mut live = live.lock().map_err(|_poisoned| bug())?;
        let interrupt = live.is_served().then(|| Interrupt::watch("no longer serving viewers"));
        if let Err(error) = live.flush() {
            console::message("warning", &said(&error));
            return Ok(Completion::Partial);
        }
        let Some(interrupt) = interrupt else {
            verbosity.say("viewer", format!("{} has the recording", live.url()));
            return Ok(completion);
        };
        verbosity.say("serving", format!("{} until Ctrl-C", live.url()));
        while !interrupt.sleep(Duration::from_secs(1)) {}
        Ok(completion)
    }
}

/// Somebody panicked while sending.
#[cfg(feature = "rrd")]
fn bug() -> anyhow::Error {
    anyhow::anyhow!("the recording was left half sent")
}

#[cfg(not(feature = "rrd"))]
#[expect(clippy::unused_self, clippy::unnecessary_wraps, reason = "with recordings they are used")]
impl Stream {
    pub(crate) fn is_open(&self) -> bool {
        false
    }

    pub(crate) fn send(&self, _: &Recording<'_>, _: Option<&str>) -> anyhow::Result<()> {
        Ok(())
    }

    pub(crate) fn send_sweep(&self, _: &SweepRecording<'_>) -> anyhow::Result<()> {
        Ok(())
    }

    pub(crate) fn close(&self, completion: Completion, _: Verbosity) -> anyhow::Result<Completion> {
        Ok(completion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_no_address() {
        assert!(address("127.0.0.1:9876").is_ok() && address("lab-pc:9000").is_ok());
        assert!(address("rerun+http://127.0.0.1:9876/proxy").is_ok());
        for file in ["log.csv", "log", "a:b"] {
            assert!(address(file).unwrap_err().contains("DATA goes before"), "{file}");
        }
        assert!(own_address("0.0.0.0:9876").is_ok() && own_address("log.csv").is_err());
    }
}
