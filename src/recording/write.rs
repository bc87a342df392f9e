//! A recording into a file, or beside the caller's own data.

use std::io::Write;

use rerun::external::re_build_info::CrateVersion;
use rerun::external::re_log_encoding::{Encoder, EncodingOptions};
use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::log::LogMsg;
use rerun::{ApplicationId, EntityPath, RecordingInfo, RecordingStream, StoreId, StoreKind};

use super::blueprint::Ladder;
use super::chunk::Chunks;
use super::content::{Content, Part, Take, hashed, name_of};
use super::entity::joint_root;
use super::error::RecordError;
use super::layout::{JointLayout, TrialStarts};
use super::message::{chunk_message, store_message};
use super::{
    PreviewRecording, Recording, SweepRecording, about, blueprint, decisions, delay_state, model,
    overview, revision, segment_view, signals, verdict,
};
use crate::report::EstimatedJoint;

/// The application's name in the viewer; blueprints are kept per application.
pub(super) const APPLICATION: &str = "tauscope";

/// Writes `recording` to `out` as a whole `.rrd` file, footer included.
///
/// The same recording gives the same messages in the same order.
///
/// # Errors
/// [`RecordError::Encode`] when `out` cannot be written; what was written then is of no
/// use.
pub fn write_recording(recording: &Recording<'_>, out: impl Write) -> Result<(), RecordError> {
    write(recording, out)
}

/// The same with delays over all settings.
///
/// # Errors
/// As [`write_recording`].
pub fn write_sweep(sweep: &SweepRecording<'_>, out: impl Write) -> Result<(), RecordError> {
    write(sweep, out)
}

/// The same with what is to be played, before it is.
///
/// # Errors
/// As [`write_recording`].
pub fn write_preview(preview: &PreviewRecording<'_>, out: impl Write) -> Result<(), RecordError> {
    write(preview, out)
}

fn write(content: &dyn Content, out: impl Write) -> Result<(), RecordError> {
    let id = content.id();
    let store = StoreId::new(StoreKind::Recording, APPLICATION, id.clone());
    let options = EncodingOptions::PROTOBUF_COMPRESSED;
    let mut encoder = Encoder::new_eager(CrateVersion::LOCAL, options, out)?;
    encoder.append(&store_message(&store))?;
    let mut chunks = Chunks::new(1);
    let info = RecordingInfo::new().with_name(content.name());
    chunks.push_static(EntityPath::properties(), &info)?;
    for chunk in chunks.into_chunks() {
        encoder.append(&chunk_message(&store, &chunk)?)?;
    }
    content.for_each_chunk(Part::default(), &mut |chunk| {
        encoder.append(&chunk_message(&store, chunk)?)?;
        Ok(())
    })?;
    for message in blueprint_messages(content, &id)? {
        encoder.append(&message)?;
    }
    encoder.finish()?;
    encoder.flush_blocking()?;
    Ok(())
}

/// Sends `recording` to a stream of the caller's own, with its views.
///
/// Entities lie at `/<joint>/…` and `/about`, beside whatever the caller logs.
///
/// # Errors
/// [`RecordError::Chunk`] and [`RecordError::Serialize`], which would be bugs. What
/// becomes of the data is the stream's business.
pub fn log_recording(
    recording: &Recording<'_>,
    stream: &RecordingStream,
) -> Result<(), RecordError> {
    recording.for_each_chunk(Part::default(), &mut |chunk| {
        stream.send_chunk(chunk.clone());
        Ok(())
    })?;
    let Some(info) = stream.store_info() else {
        return Ok(());
    };
    let application = info.store_id.application_id().clone();
    let messages = recording.views(Ladder::Finished, &application, &recording.id())?;
    if let Some(blueprint_id) = messages.first().map(|message| message.store_id().clone()) {
        let activation = activation(blueprint_id);
        stream.send_blueprint(messages, activation);
    }
    Ok(())
}

fn blueprint_messages(content: &dyn Content, id: &str) -> Result<Vec<LogMsg>, RecordError> {
    let mut messages = content.views(Ladder::Finished, &APPLICATION.into(), id)?;
    let blueprint_id = messages.first().map(|message| message.store_id().clone());
    messages.extend(blueprint_id.map(|id| LogMsg::from(activation(id))));
    Ok(messages)
}

pub(super) fn activation(blueprint_id: StoreId) -> BlueprintActivationCommand {
    BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true }
}

impl Content for Recording<'_> {
    fn name(&self) -> String {
        name_of(self.sources)
    }

    fn id(&self) -> String {
        recording_id(self)
    }

    fn namespaces(&self) -> u64 {
        self.joints.len() as u64 + 1
    }

    fn for_each_chunk(&self, part: Part<'_>, take: Take<'_>) -> Result<(), RecordError> {
        let starts = TrialStarts::of(self.joints.iter().map(|joint| joint.joint));
        let layout = |joint| JointLayout::of(joint, &starts, self.detail);
        let layouts: Vec<_> = self.joints.iter().copied().map(layout).collect();
        let mut chunks = Chunks::new(part.used + 2);
        if part.joint.is_none() {
            about::add(&mut chunks, self, &layouts)?;
        }
        let numbered = (part.used + 3..).zip(self.joints.iter().zip(&layouts));
        for (namespace, (joint, layout)) in numbered.filter(|(_, (joint, _))| part.has(joint.joint))
        {
            chunks.into_chunks().iter().try_for_each(&mut *take)?;
            chunks = Chunks::new(namespace);
            add_joint(&mut chunks, self, *joint, layout)?;
        }
        chunks.into_chunks().iter().try_for_each(take)
    }

    fn views(
        &self,
        ladder: Ladder,
        application: &ApplicationId,
        id: &str,
    ) -> Result<Vec<LogMsg>, RecordError> {
        blueprint::messages(self, ladder, application, id)
    }

    fn views_in_words(&self, ladder: Ladder) -> String {
        blueprint::in_words(self, ladder)
    }
}

fn add_joint(
    chunks: &mut Chunks,
    recording: &Recording<'_>,
    estimated: EstimatedJoint<'_>,
    layout: &JointLayout<'_>,
) -> Result<(), RecordError> {
    let joint = estimated.joint;
    let root = joint_root(&joint.name);
    signals::add(chunks, &root, joint, layout)?;
    decisions::add(chunks, &root, layout)?;
    let others = recording.others(joint);
    verdict::add(chunks, &root, joint, layout, (&estimated.estimate.settings, &others))?;
    segment_view::add(chunks, &root, joint, layout, (recording.settings.method, &others))?;
    overview::add(chunks, &root, layout)?;
    delay_state::add(chunks, &root, estimated, layout)?;
    let models = recording.models.iter().filter(|model| model.joint.name == joint.name);
    model::add(chunks, &root, layout, &models.collect::<Vec<_>>())?;
    match recording.revisions_of(joint) {
        Some(improved) => revision::add(chunks, &root, layout, improved),
        None => Ok(()),
    }
}

/// The same for the same logs, read in the same way, the same settings and version, so
/// that two recordings of one experiment stand side by side when any of it differs.
fn recording_id(recording: &Recording<'_>) -> String {
    hashed(recording.sources, recording.joints.iter().map(|joint| joint.joint), |part| {
        for model in recording.models {
            let values: Vec<_> = model.comparison.fit.model.values();
            part(&format!("{} {:?} {values:?}", model.model, model.comparison.fit.model.names()));
        }
        for improved in recording.revisions {
            let changes: Vec<_> =
                improved.revisions.iter().map(|revision| revision.change).collect();
            part(&format!("{} {changes:?}", improved.first_revision));
        }
        part(&format!("{:?} {:?}", recording.settings, recording.detail));
        for beside in recording.also {
            part(&format!("{:?}", beside.settings));
        }
        for joint in recording.joints.iter().filter(|joint| joint.estimate.chosen.is_some()) {
            part(&format!("{:?}", joint.estimate.settings));
        }
    })
}
