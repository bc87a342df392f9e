//! What numbers, units, probabilities, parameters, effects and test results are called: one
//! place for the words that reports, recordings and the command line share.

mod effects;
mod misfit;
mod number;
mod parameter;
mod probability;
mod prose;
mod region;
mod remedy;

pub use effects::{effect_ids, effects_text};
pub use misfit::{correlation_sentences, lack_of_fit};
pub use number::{bracketed, measure, number, rounded, unit_suffix, with_error, with_unit};
pub use parameter::{certainty, parameter_units, remark, with_remark};
pub use probability::{p_cell, p_text, percent};
pub use prose::{counted, listed, wrapped};
pub use region::{
    failure_sentences, feature_with_unit, misfit_units, region_text, worst_segment_text,
};
pub(crate) use remedy::remedy_text;
