//! Options that several commands have, in groups.

mod algorithm;
mod beside;
mod choice;
mod conditions;
mod data;
mod models;
pub(crate) mod number;
mod own_settings;
mod protocol;
mod results;

pub(crate) use algorithm::AlgorithmArgs;
pub(crate) use beside::{AgainstArgs, ReviewArgs};
pub(crate) use choice::{Choices, one_of};
pub(crate) use conditions::{ConditionArgs, ids_with, low_pass, passband};
pub(crate) use data::{DataArgs, MemoryArgs, ReadingArgs, read};
pub(crate) use models::{
    EffectArgs, ModelFileArgs, check_known, check_models, find, fresh_name, name_of, read_model,
};
pub(crate) use own_settings::OwnSettings;
pub(crate) use protocol::{ProtocolArgs, add_arguments};
pub(crate) use results::{Format, ResultArgs, RunArgs};
