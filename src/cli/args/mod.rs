//! Options that several commands have, in groups.

mod algorithm;
mod data;
mod models;
pub(crate) mod number;
mod results;

pub(crate) use algorithm::{
    AlgorithmArgs, ConditionArgs, OwnSettings, ids_with, low_pass, passband,
};
pub(crate) use data::{AgainstArgs, DataArgs, MemoryArgs, ReadingArgs, ReviewArgs, read};
pub(crate) use models::{
    EffectArgs, ModelFileArgs, ProtocolArgs, add_arguments, check_known, check_models, find,
    fresh_name, name_of, read_model,
};
pub(crate) use number::{Choices, one_of};
pub(crate) use results::{Format, ResultArgs, RunArgs};
