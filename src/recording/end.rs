//! The end of a recording, the same in every run.
//!
//! Rerun lists the chunks and columns of each store at the end of a file, and takes both from
//! maps without an order: without this, no two runs would write the same bytes.

use std::cell::Cell;
use std::io::{self, Write};

use rerun::external::re_log_encoding::{
    CodecError, Decodable, Encodable as _, EncodeError, MessageHeader, MessageKind, RrdFooter,
    StreamFooter, ToApplication as _, ToTransport as _,
};

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
