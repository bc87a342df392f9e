//! A recording into a file, or beside the caller's own data.

use std::cell::Cell;
use std::io::Write;

use rerun::external::re_build_info::CrateVersion;
use rerun::external::re_log_encoding::{Encoder, EncodingOptions};
use rerun::{RecordingStream, StoreId, StoreKind};

use super::chunk::{Ids, chunk_message};
use super::content::{
    Content, Part, activation, application, first_messages, for_each_chunk, view_messages,
};
use super::end::EndHeld;
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
