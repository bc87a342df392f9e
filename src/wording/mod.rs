//! What numbers, units, probabilities, parameters, effects and test results are called: one
//! place for the words that reports, recordings and the command line share.

mod doubt;
mod misfit;
mod model;
mod number;
mod prose;

#[cfg(feature = "rrd")]
pub(crate) use doubt::verdict_in_short;
pub(crate) use doubt::{difference_in_short, difference_sentences, result_in_short, step_name};
pub(crate) use doubt::{doubt_percent, doubt_sentence, remedy_text};
pub(crate) use misfit::{
    correlation_sentences, fails_or_errs, failure_sentences, feature_with_level, feature_with_unit,
    lack_of_fit, misfit_units, region_text, times_noise, worst_segment_text,
};
pub(crate) use model::{effect_ids, effects_named, effects_text, parameter_units, parameter_value};
pub use number::number;
pub(crate) use number::{
    bracketed, interval, measure, p_cell, p_text, percent, range_text, rounded, samples_text,
    to_place, unit_suffix, with_error, with_unit,
};
pub(crate) use prose::{
    capitalized, counted, hanging, legible, lines, listed, typed_parts, wrapped,
};
