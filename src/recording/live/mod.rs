//! A recording that a viewer sees while it is made: sent again whenever it has grown, of
//! which only what is new goes over the wire.

mod sent;

use std::io::{self, Read as _, Write as _};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream, ToSocketAddrs as _};
use std::time::{Duration, Instant};

use rerun::external::re_uri::{ProxyUri, RedapUri, Scheme};
use rerun::grpc_server::GrpcServerSink;
use rerun::log::LogMsg;
use rerun::sink::{GrpcSink, GrpcSinkConnectionState, LogSink as _};
use rerun::{MemoryLimit, ServerOptions, StoreId, StoreKind};
use sent::Sent;

use crate::recording::chunk::{Ids, chunk_message};
use crate::recording::content::{
    Content, Part, application, first_messages, for_each_chunk, view_messages,
};
use crate::recording::error::RecordError;
use crate::report::{Recording, SweepRecording};

/// Longest time that a viewer may take to answer.
const ANSWER: Duration = Duration::from_secs(5);

/// Longest time that a viewer may take to read what it was sent.
const READ: Duration = Duration::from_mins(2);

/// Share of the memory in which a server keeps what viewers that come later are sent.
const KEPT: f32 = 0.5;

/// A recording on its way to a viewer.
pub(crate) struct Live {
    /// None once the viewer is lost.
    sink: Option<Sink>,
    url: String,
    /// The recording; its application is known as soon as something is sent.
    store: StoreId,
    sent: Sent,
    /// Namespaces of ids that were used: what is sent later has higher ones, and wins.
    used: u64,
    /// The views that the viewer was sent last, in words.
    views: Option<String>,
}

/// Where messages go.
enum Sink {
    /// To a viewer that listens.
    Viewer(GrpcSink),
    /// To all viewers that ask.
    Server(GrpcServerSink),
}

impl std::fmt::Debug for Live {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Live").field("url", &self.url).finish_non_exhaustive()
    }
}

impl Live {
    /// Connects to the viewer at `address`: `HOST:PORT`, or a URL as viewers show it.
    ///
    /// # Errors
    /// [`RecordError::Address`] for what is no address, [`RecordError::NoViewer`] when none
    /// answers there.
    pub(crate) fn connect(address: &str) -> Result<Self, RecordError> {
        let uri = parse(address)?;
        let no_viewer = |why: &str| RecordError::NoViewer { url: uri.to_string(), why: why.into() };
        reach(&uri, ANSWER).map_err(|error| no_viewer(&error.to_string()))?;
        let viewer = GrpcSink::new(uri.clone());
        if !connects(&viewer) {
            give_up(Sink::Viewer(viewer));
            return Err(no_viewer("the program that listens there is not a viewer"));
        }
        Ok(Self::with(Sink::Viewer(viewer), uri.to_string()))
    }

    /// Serves viewers that connect to `address`, also those that come later.
    ///
    /// # Errors
    /// [`RecordError::Listen`] when `address` is taken, or not of this machine.
    pub(crate) fn serve(address: SocketAddr) -> Result<Self, RecordError> {
        // The server itself would only log that it cannot listen.
        let free = TcpListener::bind(address).and_then(|listener| listener.local_addr());
        let address = free.map_err(|source| RecordError::Listen { address, source })?;
        let options = ServerOptions {
            memory_limit: MemoryLimit::from_fraction_of_total(KEPT),
            ..ServerOptions::default()
        };
        let host = host(address.ip());
        let server = GrpcServerSink::new(&host, address.port(), options)
            .map_err(|why| RecordError::Listen { address, source: io::Error::other(why) })?;
        let url = server.uri().to_string();
        Ok(Self::with(Sink::Server(server), url))
    }

    fn with(sink: Sink, url: String) -> Self {
        // A run of its own: two runs are side by side in the viewer.
        let store = StoreId::random(StoreKind::Recording, "tauscope");
        Self { sink: Some(sink), url, store, sent: Sent::default(), used: 0, views: None }
    }

    /// Where the viewer is, or where viewers are served.
    pub(crate) fn url(&self) -> &str {
        &self.url
    }

    /// Whether viewers connect to this program.
    pub(crate) fn is_served(&self) -> bool {
        matches!(self.sink, Some(Sink::Server(_)))
    }

    /// Sends what is new of `recording`: all of it at first; of one joint alone where it is named.
    ///
    /// # Errors
    /// [`RecordError::Value`], which would be a bug. Whether
    /// it arrives, [`flush`](Self::flush) reports.
    pub(crate) fn send(
        &mut self,
        recording: &Recording<'_>,
        joint: Option<&str>,
    ) -> Result<(), RecordError> {
        self.send_part(recording, joint)
    }

    /// Sends delays over all settings.
    ///
    /// # Errors
    /// As [`send`](Self::send).
    pub(crate) fn send_sweep(&mut self, sweep: &SweepRecording<'_>) -> Result<(), RecordError> {
        self.send_part(sweep, None)
    }

    fn send_part(&mut self, content: &dyn Content, joint: Option<&str>) -> Result<(), RecordError> {
        if self.used == 0 {
            self.open(content)?;
        }
        let ids = Ids::of(self.store.recording_id().as_str());
        let part = Part { ids, used: self.used, joint };
        self.send_views(content)?;
        self.sent.begin();
        self.used += for_each_chunk(content, part, &mut |chunk| match self.sent.news_of(chunk) {
            Some(news) => {
                self.post(chunk_message(&self.store, &news)?);
                Ok(())
            }
            None => Ok(()),
        })?;
        Ok(())
    }

    /// What the recording is.
    fn open(&mut self, content: &dyn Content) -> Result<(), RecordError> {
        let (name, id) = (content.name(), self.store.recording_id().clone());
        let application = application(&name, id.as_str());
        self.store = StoreId::new(StoreKind::Recording, application, id.clone());
        first_messages(&self.store, name)?.into_iter().for_each(|message| self.post(message));
        Ok(())
    }

    fn post(&self, message: LogMsg) {
        match &self.sink {
            Some(Sink::Viewer(viewer)) => viewer.send(message),
            Some(Sink::Server(server)) => server.send(message),
            None => {}
        }
    }

    /// Which view shows what, unless the viewer knows: when it is sent again, the viewer forgets where
    /// its user is.
    fn send_views(&mut self, content: &dyn Content) -> Result<(), RecordError> {
        let views = content.views_in_words();
        if self.views.as_ref() == Some(&views) {
            return Ok(());
        }
        let id = format!("{}-{}", self.store.recording_id().as_str(), self.used);
        let messages = view_messages(content, (self.store.application_id(), &id))?;
        for message in messages {
            self.post(message);
        }
        self.views = Some(views);
        Ok(())
    }

    /// Waits until everything has gone out.
    ///
    /// # Errors
    /// [`RecordError::Lost`] when the viewer went away.
    pub(crate) fn flush(&mut self) -> Result<(), RecordError> {
        let flushed = match &self.sink {
            Some(Sink::Viewer(viewer)) => viewer.flush_blocking(READ),
            Some(Sink::Server(server)) => server.flush_blocking(READ),
            None => Ok(()),
        };
        let Err(source) = flushed else { return Ok(()) };
        self.sink.take().into_iter().for_each(give_up);
        Err(RecordError::Lost { url: self.url.clone(), source: Box::new(source) })
    }
}

/// Whether `viewer` is reached in time.
fn connects(viewer: &GrpcSink) -> bool {
    let end = Instant::now() + ANSWER;
    while viewer.status() != GrpcSinkConnectionState::Connected {
        let is_over = matches!(viewer.status(), GrpcSinkConnectionState::Disconnected(_));
        if is_over || Instant::now() > end {
            return false;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    true
}

/// Leaves a sink as it is: being dropped, it would wait for a viewer that never answers.
fn give_up(sink: Sink) {
    std::mem::forget(sink);
}

/// The viewer at `address`: `HOST:PORT`, or a URL as viewers show it.
fn parse(address: &str) -> Result<ProxyUri, RecordError> {
    let url = if address.contains("://") {
        address.to_owned()
    } else {
        format!("rerun+http://{address}/proxy")
    };
    match url.parse() {
        Ok(RedapUri::Proxy(uri)) => Ok(uri),
        Ok(_) | Err(_) => Err(RecordError::Address { address: address.to_owned() }),
    }
}

/// Tries whether anything listens there, and speaks HTTP/2 as viewers do.
fn reach(uri: &ProxyUri, patience: Duration) -> io::Result<()> {
    let place = format!("{}:{}", uri.origin.host, uri.origin.port);
    let mut result = Err(io::ErrorKind::AddrNotAvailable.into());
    for address in place.to_socket_addrs()? {
        result = TcpStream::connect_timeout(&address, patience);
        if result.is_ok() {
            break;
        }
    }
    match uri.origin.scheme {
        Scheme::RerunHttp => greet(&mut result?, patience),
        // The greeting would have to be encrypted.
        Scheme::RerunHttps => result.map(drop),
    }
}

/// Exchanges the first frames of HTTP/2 (RFC 9113, section 3.4): the server's is its settings.
fn greet(stream: &mut TcpStream, patience: Duration) -> io::Result<()> {
    const PREFACE: &[u8] = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
    const EMPTY_SETTINGS: [u8; 9] = [0, 0, 0, SETTINGS, 0, 0, 0, 0, 0];
    /// The type of a frame of settings, and where in a frame the type is.
    const SETTINGS: u8 = 4;
    const TYPE: usize = 3;
    stream.set_read_timeout(Some(patience))?;
    stream.write_all(PREFACE)?;
    stream.write_all(&EMPTY_SETTINGS)?;
    let mut header = [0; 9];
    let answered = stream.read_exact(&mut header).is_ok();
    if answered && header[TYPE] == SETTINGS {
        return Ok(());
    }
    Err(io::Error::other("the program that listens there is not a viewer"))
}

/// An address as it is written before a port.
fn host(ip: IpAddr) -> String {
    match ip {
        IpAddr::V4(ip) => ip.to_string(),
        IpAddr::V6(ip) => format!("[{ip}]"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_a_host_with_a_port_or_a_url() {
        for address in ["127.0.0.1:9876", "rerun+http://127.0.0.1:9876/proxy"] {
            assert_eq!(parse(address).unwrap().to_string(), "rerun+http://127.0.0.1:9876/proxy");
        }
        assert_eq!(parse("lab-pc:9000").unwrap().origin.port, 9000);
        for wrong in ["", "ftp://lab-pc", "rerun+http://", "a b:1"] {
            assert!(matches!(parse(wrong), Err(RecordError::Address { .. })), "{wrong}");
        }
    }
}
