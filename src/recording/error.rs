//! Why a recording could not be made.

use rerun::SerializationError;
use rerun::external::re_log_encoding::EncodeError;
use rerun::log::ChunkError;
use rerun::sink::SinkFlushError;

/// Why a recording could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file cannot be written.
    #[error("the recording cannot be written")]
    Encode(#[source] Box<EncodeError>),
    /// This is no address of a viewer.
    #[error("`{address}` is no address of a viewer; expected HOST:PORT, as in 127.0.0.1:9876")]
    Address {
        /// What was given.
        address: String,
    },
    /// No viewer answers.
    #[error("no viewer at {url} ({why}); start one with `rerun`")]
    NoViewer {
        /// Where it was looked for.
        url: String,
        /// What was found instead.
        why: String,
    },
    /// Viewers cannot be served.
    #[error(
        "{address}: viewers cannot be served there; choose another port, or an address of this machine"
    )]
    Listen {
        /// Where.
        address: std::net::SocketAddr,
        /// What the system said.
        source: std::io::Error,
    },
    /// The viewer went away.
    #[error("the connection to the viewer at {url} ended, and what was sent last may be lost")]
    Lost {
        /// Where it was.
        url: String,
        /// What the connection says.
        source: Box<SinkFlushError>,
    },
    /// A bug: a value has no place in the recording, or columns do not fit together.
    #[error("a value cannot be recorded")]
    Value(#[source] Box<dyn std::error::Error + Send + Sync>),
}

impl From<EncodeError> for RecordError {
    fn from(error: EncodeError) -> Self {
        Self::Encode(Box::new(error))
    }
}

impl From<ChunkError> for RecordError {
    fn from(error: ChunkError) -> Self {
        Self::Value(Box::new(error))
    }
}

impl From<SerializationError> for RecordError {
    fn from(error: SerializationError) -> Self {
        Self::Value(Box::new(error))
    }
}
