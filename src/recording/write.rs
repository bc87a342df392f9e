//! A recording into a file, or beside the caller's own data.

use std::cell::Cell;
use std::io::{self, Write};

use rerun::external::re_build_info::CrateVersion;
use rerun::external::re_log_encoding::{
    CodecError, Decodable, Encodable as _, EncodeError, Encoder, EncodingOptions, MessageHeader,
    MessageKind, RrdFooter, StreamFooter, ToApplication as _, ToTransport as _,
};
use rerun::{RecordingStream, StoreId, StoreKind};

use super::chunk::{Ids, chunk_message};
use super::content::{
    Content, Part, activation, application, first_messages, for_each_chunk, view_messages,
};
use super::error::RecordError;
use crate::report::{Recording, SweepRecording};

/// Writes `recording` to `out` as a whole `.rrd` file, footer included.
///
/// Equal recordings give equal bytes.
///
/// # Errors
/// [`RecordError::Encode`] when `out` cannot be written; what was written then is of no
/// use.
pub fn write_recording(recording: &Recording<'_>, out: impl Write) -> Result<(), RecordError> {
    write(recording, out)
}

/// Writes delays over all settings to `out` as a whole `.rrd` file.
///
/// # Errors
/// As [`write_recording`].
pub fn write_sweep(sweep: &SweepRecording<'_>, out: impl Write) -> Result<(), RecordError> {
    write(sweep, out)
}

fn write(content: &dyn Content, out: impl Write) -> Result<(), RecordError> {
    let (id, name) = (content.id(), content.name());
    let application = application(&name, &id);
    let options = EncodingOptions::PROTOBUF_COMPRESSED;
    let at_end = Cell::new(false);
    let mut encoder = Encoder::new_eager(CrateVersion::LOCAL, options, EndHeld::new(out, &at_end))?;
    let store = StoreId::new(StoreKind::Recording, application.clone(), id.clone());
    // The views come first: a viewer that has none yet makes its own of what it has read.
    let views = view_messages(content, (&application, &id))?;
    for message in views.into_iter().chain(first_messages(&store, name)?) {
        encoder.append(&message)?;
    }
    for_each_chunk(content, Part::whole(Ids::of(&id)), &mut |chunk| {
        encoder.append(&chunk_message(&store, chunk)?)?;
        Ok(())
    })?;
    at_end.set(true);
    encoder.finish()?;
    Ok(encoder.into_inner()?.finish()?)
}

/// Sends `recording` to a stream of the caller's own, with its views.
///
/// Entities lie at `/<joint>/…` and `/about`, beside whatever the caller logs.
///
/// # Errors
/// [`RecordError::Value`], which would be a bug. What
/// becomes of the data is the stream's business.
pub fn log_recording(
    recording: &Recording<'_>,
    stream: &RecordingStream,
) -> Result<(), RecordError> {
    let Some(info) = stream.store_info() else {
        return Ok(());
    };
    let id = recording.id();
    let application = info.store_id.application_id().clone();
    let messages = recording.blueprint().messages(&application, &id)?;
    if let Some(blueprint_id) = messages.first().map(|message| message.store_id().clone()) {
        stream.send_blueprint(messages, activation(blueprint_id));
    }
    for_each_chunk(recording, Part::whole(Ids::of(&id)), &mut |chunk| {
        stream.send_chunk(chunk.clone());
        Ok(())
    })?;
    Ok(())
}

/// A writer that can hold back what it is given from some moment on.
pub(super) struct EndHeld<'a, W> {
    out: W,
    /// Whether what comes now is held.
    holds: &'a Cell<bool>,
    held: Vec<u8>,
}

impl<'a, W: Write> EndHeld<'a, W> {
    pub(super) fn new(out: W, holds: &'a Cell<bool>) -> Self {
        Self { out, holds, held: Vec::new() }
    }

    /// Writes the end that was held, stores and columns in order.
    ///
    /// # Errors
    /// [`EncodeError`] when it cannot be written, or is not what Rerun ends a file with.
    pub(super) fn finish(mut self) -> Result<(), EncodeError> {
        let start = MessageHeader::ENCODED_SIZE_BYTES;
        let end = self.held.len().saturating_sub(StreamFooter::ENCODED_SIZE_BYTES);
        let footer = sorted(self.held.get(start..end).unwrap_or_default())?;
        let place = StreamFooter::from_rrd_bytes(self.held.get(end..).unwrap_or_default())?;
        let starts = place.entries.iter();
        let mut starts =
            starts.map(|entry| entry.rrd_footer_byte_span_from_start_excluding_header.start);
        let place = StreamFooter::from_rrd_footer_bytes(starts.next().unwrap_or(0), &footer);
        let header = MessageHeader { kind: MessageKind::End, len: footer.len() as u64 };
        self.held.clear();
        header.to_rrd_bytes(&mut self.held)?;
        self.held.extend(footer);
        place.to_rrd_bytes(&mut self.held)?;
        self.out.write_all(&self.held).map_err(EncodeError::Write)?;
        self.out.flush().map_err(EncodeError::Write)
    }
}

/// `footer` with its stores and columns in order.
fn sorted(footer: &[u8]) -> Result<Vec<u8>, CodecError> {
    // The type that a footer is read as has no name here.
    let mut stores = RrdFooter::default().to_transport(())?;
    stores.clone_from(&Decodable::from_rrd_bytes(footer)?);
    let mut manifests: Vec<_> = stores.to_application(())?.manifests.into_iter().collect();
    manifests.sort_by(|a, b| a.0.cmp(&b.0));
    for (_, manifest) in &mut manifests {
        let mut fields: Vec<_> = manifest.sorbet_schema.fields().to_vec();
        fields.sort();
        manifest.sorbet_schema.fields = fields.into();
    }
    let manifests = manifests.iter().map(|(_, manifest)| manifest.to_transport(()));
    stores.manifests = manifests.collect::<Result<_, _>>()?;
    let mut bytes = Vec::new();
    stores.to_rrd_bytes(&mut bytes)?;
    Ok(bytes)
}

impl<W: Write> Write for EndHeld<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.holds.get() { self.held.write(bytes) } else { self.out.write(bytes) }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
