//! Where a model fails: features, parts of their range, conditions and segments.

use super::{number, rounded};
use crate::diagnosis::Comparison;
use crate::diagnosis::failure::{Feature, Region, Units, WorstSegment};
use crate::experiment::Joint;

/// The units in which the features of a joint are measured.
pub(crate) fn misfit_units(joint: &Joint) -> Units {
    Units { input: joint.input_unit.clone(), output: joint.output_unit.clone() }
}

/// A part of a feature's range: `2 to 3`; a level, a sign or a trial by its label.
pub(crate) fn region_text(region: &Region) -> String {
    #[expect(clippy::float_cmp, reason = "a level has one value")]
    let is_level = region.from == region.to;
    if is_level || matches!(region.feature, Feature::Direction | Feature::Trial) {
        return region.label.clone();
    }
    let (from, to) = (rounded(region.from), rounded(region.to));
    if from == to { from } else { format!("{from} to {to}") }
}

/// A part of a feature's range with its name and unit: `input 0.5 to 1 V`.
pub(crate) fn feature_with_level(joint: &Joint, region: &Region) -> String {
    let unit = region.feature.unit(&misfit_units(joint));
    let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
    format!("{} {}{unit}", region.feature.name(), region_text(region))
}

/// What a feature is and its unit, as the title of an axis: `input, as it acts [V]`.
pub(crate) fn feature_with_unit(feature: Feature, joint: &Joint) -> String {
    let name = match feature {
        Feature::Direction => "direction of the input",
        Feature::Input => "input, as it acts",
        Feature::Hold => "how long the input is held",
        Feature::Time => "time in the trial",
        _ => feature.name(),
    };
    super::bracketed(name, feature.unit(&misfit_units(joint)).as_deref())
}

/// `12.4 s to 13.1 s`.
pub(crate) fn worst_segment_text(worst: &WorstSegment) -> String {
    let (from, to) = (number(worst.start_s), number(worst.end_s));
    format!("{from} s to {to} s")
}

/// The verb for a model and where its error arises: one that explains most of the motion does not
/// fail.
pub(crate) fn fails_or_errs(comparison: &Comparison) -> &'static str {
    /// Percent of the motion that are most of it.
    const MOST: f64 = 50.0;
    let explains_most = comparison.judged().is_some_and(|error| error.fit_percent > MOST);
    if explains_most { "is least accurate" } else { "fails" }
}

/// Where a model fails, a sentence for each condition, that with the most of the error first.
pub(crate) fn failure_sentences(joint: &Joint, comparison: &Comparison) -> Vec<String> {
    let units = misfit_units(joint);
    let conditions = comparison.failure.iter().flat_map(|failure| &failure.fails_where);
    let mut conditions: Vec<_> = conditions.collect();
    conditions.sort_by(|a, b| b.share_of_squared_error.total_cmp(&a.share_of_squared_error));
    conditions.into_iter().map(|condition| condition.sentence(&units)).collect()
}
