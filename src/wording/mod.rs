//! What numbers, units, probabilities, parameters, effects and test results are called: one
//! place for the words that reports, recordings and the command line share.

mod difference;
mod doubt;
mod effects;
mod legible;
mod misfit;
mod model_difference;
mod number;
mod parameter;
mod probability;
mod prose;
mod region;
mod remedy;

#[cfg(feature = "rrd")]
pub(crate) use difference::verdict_in_short;
pub(crate) use difference::{
    difference_in_short, difference_sentences, missing_sentences, result_in_short, step_name,
};
#[cfg(feature = "rrd")]
pub(crate) use doubt::{DOUBT_MEANS, doubt_in_short, doubtful_sentence};
pub(crate) use doubt::{doubt_percent, doubt_sentence};
pub(crate) use effects::{effect_ids, effects_named, effects_text};
pub(crate) use legible::legible;
pub(crate) use misfit::{correlation_sentences, lack_of_fit};
pub(crate) use model_difference::model_difference_sentences;
pub use number::number;
pub(crate) use number::{
    bracketed, interval, measure, range_text, rounded, samples_text, to_place, unit_suffix,
    with_error, with_unit,
};
pub(crate) use parameter::{parameter_units, parameter_value};
pub(crate) use probability::{p_cell, p_text, percent};
pub(crate) use prose::{Margins, capitalized, counted, hanging, lines, listed, wrapped};
pub(crate) use region::{
    fails_or_errs, failure_sentences, feature_with_level, feature_with_unit, misfit_units,
    region_text, worst_segment_text,
};
pub(crate) use remedy::remedy_text;
