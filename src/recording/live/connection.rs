//! A connection to a viewer, by which a recording is sent whenever it has grown.

use std::io;
use std::net::{SocketAddr, TcpListener};
use std::time::{Duration, Instant};

use rerun::grpc_server::GrpcServerSink;
use rerun::log::{Chunk, LogMsg};
use rerun::sink::{GrpcSink, GrpcSinkConnectionState, LogSink as _};
use rerun::{MemoryLimit, ServerOptions, StoreId, StoreKind};

use super::address;
use super::sent::Sent;
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
        let uri = address::parse(address)?;
        let no_viewer = |why: &str| RecordError::NoViewer { url: uri.to_string(), why: why.into() };
        address::reach(&uri, ANSWER).map_err(|error| no_viewer(&error.to_string()))?;
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
        let host = address::host(address.ip());
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

    /// Sends what is new of `recording`: all of it at first.
    ///
    /// # Errors
    /// [`RecordError::Value`], which would be a bug. Whether
    /// it arrives, [`flush`](Self::flush) reports.
    pub(crate) fn send(&mut self, recording: &Recording<'_>) -> Result<(), RecordError> {
        self.send_part(recording, None)
    }

    /// Sends what is new of `joint` alone.
    ///
    /// # Errors
    /// As [`send`](Self::send).
    pub(crate) fn send_joint(
        &mut self,
        recording: &Recording<'_>,
        joint: &str,
    ) -> Result<(), RecordError> {
        self.send_part(recording, Some(joint))
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
            Some(news) => self.send_chunk(&news),
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

    fn send_chunk(&self, chunk: &Chunk) -> Result<(), RecordError> {
        self.post(chunk_message(&self.store, chunk)?);
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
