//! Messages of a recording, with ids that are the same in every run.

use rerun::StoreId;
use rerun::external::re_log_types::external::re_tuid::Tuid;
use rerun::external::re_log_types::{
    BlueprintActivationCommand, SetStoreInfo, StoreInfo, StoreSource,
};
use rerun::log::{Chunk, LogMsg};

use super::error::RecordError;

/// What a store is and who made it: the first message of each.
pub(super) fn store_message(store: &StoreId) -> LogMsg {
    let info = StoreInfo::new(
        store.clone(),
        StoreSource::Other(format!("tauscope {}", env!("CARGO_PKG_VERSION"))),
    );
    LogMsg::SetStoreInfo(SetStoreInfo { row_id: Tuid::from_nanos_and_inc(1, 0), info })
}

/// A chunk of a store.
pub(super) fn chunk_message(store: &StoreId, chunk: &Chunk) -> Result<LogMsg, RecordError> {
    Ok(LogMsg::ArrowMsg(store.clone(), chunk.to_arrow_msg()?))
}

/// What makes the viewer show a blueprint that it has been sent.
pub(super) fn activation(blueprint_id: StoreId) -> BlueprintActivationCommand {
    BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true }
}
