//! Options that several commands have, in groups.

mod against;
mod algorithm;
mod choice;
mod conditions;
mod data;
mod effects;
mod model_file;
pub(crate) mod number;
mod own_settings;
mod protocol;
mod results;
mod review;

pub(crate) use against::AgainstArgs;
pub(crate) use algorithm::AlgorithmArgs;
pub(crate) use choice::{Choices, one_of};
pub(crate) use conditions::{ConditionArgs, ids_with, low_pass, passband};
pub(crate) use data::{DataArgs, MemoryArgs, ReadingArgs, read};
pub(crate) use effects::{EffectArgs, find};
pub(crate) use model_file::{
    ModelFileArgs, fresh_name, name_of, note_conditions, note_missing, read_model,
};
pub(crate) use own_settings::OwnSettings;
pub(crate) use protocol::ProtocolArgs;
pub(crate) use results::{Format, ResultArgs, RunArgs};
pub(crate) use review::ReviewArgs;
