//! Why a recording could not be made.

use rerun::SerializationError;
use rerun::external::re_log_encoding::EncodeError;
use rerun::log::ChunkError;

/// Why a recording could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file cannot be written.
    #[error("the recording cannot be written")]
    Encode(#[source] Box<EncodeError>),
    /// A bug: columns of a chunk do not fit together.
    #[error("the recording's columns do not fit together")]
    Chunk(#[source] Box<ChunkError>),
    /// A bug: a value has no place in the recording.
    #[error("a value cannot be recorded")]
    Serialize(#[source] Box<SerializationError>),
}

impl From<EncodeError> for RecordError {
    fn from(error: EncodeError) -> Self {
        Self::Encode(Box::new(error))
    }
}

impl From<ChunkError> for RecordError {
    fn from(error: ChunkError) -> Self {
        Self::Chunk(Box::new(error))
    }
}

impl From<SerializationError> for RecordError {
    fn from(error: SerializationError) -> Self {
        Self::Serialize(Box::new(error))
    }
}
