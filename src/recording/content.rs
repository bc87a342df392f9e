//! What goes into a file or to a viewer, whatever it is about.

use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::log::{Chunk, LogMsg};
use rerun::{ApplicationId, EntityPath, RecordingInfo, StoreId};

use super::blueprint::Blueprint;
use super::chunk::{Chunks, Ids, chunk_message, store_message};
use super::error::RecordError;
use super::paths::{ABOUT, joint_root};
use crate::experiment::{Joint, Source};

/// Who takes the chunks as they are made.
pub(super) type Take<'t> = &'t mut dyn FnMut(&Chunk) -> Result<(), RecordError>;

/// A joint of a recording, and what adds all of it below the joint's root.
pub(super) struct Tab<'c> {
    pub(super) joint: &'c str,
    pub(super) add: Box<Add<'c>>,
}

type Add<'c> = dyn Fn(&mut Chunks) -> Result<(), RecordError> + 'c;

/// A recording of some kind.
pub(super) trait Content {
    /// Its name in the viewer: the log, the command, the settings.
    fn name(&self) -> String;

    /// Equal for equal content: see [`hashed`].
    fn id(&self) -> String;

    /// The page on the whole recording.
    fn about(&self) -> String;

    /// The joints in the order of their tabs.
    fn tabs(&self) -> Vec<Tab<'_>>;

    /// What the viewer shows of it.
    fn blueprint(&self) -> Blueprint;

    /// What decides which views there are, for one that grows.
    fn views_in_words(&self) -> String {
        String::new()
    }
}

/// Makes the chunks of `content` joint by joint, so that only one joint's are in memory;
/// the number of namespaces that their ids take.
pub(super) fn for_each_chunk(
    content: &dyn Content,
    part: Part<'_>,
    take: Take<'_>,
) -> Result<u64, RecordError> {
    let mut chunks = part.ids.chunks(part.used + 2);
    if part.joint.is_none() {
        chunks.page(ABOUT, content.about())?;
    }
    let tabs = content.tabs();
    let taken = tabs.len() as u64 + 1;
    for (namespace, tab) in (part.used + 3..)
        .zip(tabs)
        .filter(|(_, tab)| part.joint.is_none_or(|joint| joint == tab.joint))
    {
        chunks.into_chunks().iter().try_for_each(&mut *take)?;
        chunks = part.ids.chunks(namespace).rooted(joint_root(tab.joint));
        (tab.add)(&mut chunks)?;
    }
    chunks.into_chunks().iter().try_for_each(take)?;
    Ok(taken)
}

/// The messages of the views of `content`, the last of which makes the viewer show them.
pub(super) fn view_messages(
    content: &dyn Content,
    (application, id): (&ApplicationId, &str),
) -> Result<Vec<LogMsg>, RecordError> {
    let mut messages = content.blueprint().messages(application, id)?;
    let views = messages.first().map(|message| message.store_id().clone());
    messages.extend(views.map(|views| LogMsg::from(activation(views))));
    Ok(messages)
}

/// The first messages of a recording: what it is, and its name.
pub(super) fn first_messages(store: &StoreId, name: String) -> Result<Vec<LogMsg>, RecordError> {
    let mut chunks = Ids::of(store.recording_id().as_str()).chunks(1);
    let info = RecordingInfo::new().with_name(name);
    chunks.push_static(EntityPath::properties(), &info)?;
    let chunks = chunks.into_chunks();
    let messages = chunks.iter().map(|chunk| chunk_message(store, chunk));
    std::iter::once(Ok(store_message(store))).chain(messages).collect()
}

/// Which of a recording's chunks are made, and which ids they have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<'n> {
    /// The recording's.
    pub(super) ids: Ids,
    /// Namespaces that are taken, beside the first one.
    pub(super) used: u64,
    /// All joints and what is about them all, or one joint.
    pub(super) joint: Option<&'n str>,
}

impl Part<'_> {
    /// All of a recording.
    pub(super) fn whole(ids: Ids) -> Self {
        Self { ids, used: 0, joint: None }
    }
}

/// The application that the recording `id` of this `name` belongs to in the viewer: one of its
/// own, since all recordings of one application are shown in the views of the last one.
pub(super) fn application(name: &str, id: &str) -> ApplicationId {
    let short: String = id.chars().take(8).collect();
    ApplicationId::new_or_unknown(format!("{} {short}", plain_words(name)))
}

/// A name of letters, digits and what else an application's may have.
fn plain_words(name: &str) -> String {
    /// Beyond it a name is cut off, and the id with it.
    const LONGEST: usize = 100;
    let name = name.replace('α', "alpha").replace('β', "beta");
    let letter = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { ' ' };
    let name: String = name.chars().map(letter).take(LONGEST).collect();
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// An id that is the same for the same logs, read in the same way, the same version and
/// what else `settings` hands over.
pub(super) fn hashed<'a>(
    sources: &[Source],
    joints: impl Iterator<Item = &'a Joint>,
    settings: impl FnOnce(&mut dyn FnMut(&str)),
) -> String {
    use sha2::{Digest as _, Sha256};
    let mut hash = Sha256::new();
    let mut part = |text: &str| {
        hash.update(text);
        hash.update([0]);
    };
    for source in sources {
        part(&source.sha256);
    }
    for joint in joints {
        part(&joint.name);
        for trial in &joint.trials {
            let (start, period) = (trial.time_s(1), trial.period());
            part(&format!("{} {} {start} {period}", trial.label(), trial.len()));
        }
    }
    settings(&mut part);
    part(env!("CARGO_PKG_VERSION"));
    let digest = base16ct::lower::encode_string(&hash.finalize());
    digest.chars().take(32).collect()
}

/// What makes the viewer show a blueprint that it has been sent.
pub(super) fn activation(blueprint_id: StoreId) -> BlueprintActivationCommand {
    BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true }
}
