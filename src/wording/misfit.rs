//! What a model misses: what tests say of its residual, and where it fails.

use super::{bracketed, number, p_text, rounded, unit_suffix};
use crate::diagnosis::failure::{Feature, Region, Units, WorstSegment};
use crate::diagnosis::{
    CONFIDENCE, Comparison, InputCorrelation, LackOfFit, NEGLIGIBLE, SIGNIFICANCE, ShownBy,
    Whiteness,
};
use crate::experiment::Joint;

/// `5.6 times the noise`, `as large as the noise`.
pub(crate) fn times_noise(times: f64) -> String {
    /// A difference of the two that nobody asks about.
    const ALIKE: f64 = 0.05;
    if (times - 1.0).abs() < ALIKE {
        "as large as the noise".to_owned()
    } else {
        format!("{} times the noise", rounded(times))
    }
}

/// Whether a lack of fit is shown, and by what.
pub(crate) fn lack_of_fit(test: LackOfFit) -> String {
    let p_value = p_text(test.p_value);
    match test.shown_by {
        None if test.edges.is_some() => "not shown beyond the step times".to_owned(),
        None if test.p_value >= SIGNIFICANCE => format!("not shown ({p_value})"),
        None if test.misfit_share < NEGLIGIBLE => {
            format!("negligible ({} % of the squared error)", rounded(100.0 * test.misfit_share))
        }
        None => {
            let times = test.times_noise.map_or_else(String::new, |times| {
                format!(": training error {}", times_noise(times))
            });
            format!("small{times} ({p_value})")
        }
        _ if test.p_value < SIGNIFICANCE => format!("shown ({p_value})"),
        Some(ShownBy::FewWindows) => "shown (in few windows)".to_owned(),
        Some(ShownBy::UnseenPart) => "shown (on unseen data)".to_owned(),
        Some(ShownBy::Size | ShownBy::Shapes) => "shown (beyond noise)".to_owned(),
    }
}

/// How the residual is correlated with itself and with the input, in a sentence each.
pub(crate) fn correlation_sentences(comparison: &Comparison) -> Vec<String> {
    let Comparison { whiteness, input_correlation, .. } = comparison;
    let white = whiteness.as_ref().map(whiteness_sentence);
    white.into_iter().chain(input_correlation.as_ref().map(input_sentence)).collect()
}

fn whiteness_sentence(whiteness: &Whiteness) -> String {
    let p = p_text(whiteness.p_value);
    if whiteness.p_value >= 1.0 - CONFIDENCE {
        return format!("white ({p})");
    }
    let last = whiteness.lag_step_s * whiteness.correlation.len() as f64;
    let seconds = number(whiteness.correlated_s);
    match whiteness.correlated_s {
        correlated if correlated <= 0.0 => format!("not white ({p})"),
        correlated if correlated >= last => format!("correlated over {seconds} s and more ({p})"),
        _ => format!("correlated over {seconds} s ({p})"),
    }
}

fn input_sentence(correlation: &InputCorrelation) -> String {
    let acting = &correlation.acting;
    let p = p_text(acting.p_value);
    if acting.p_value >= 1.0 - CONFIDENCE {
        return format!("not shown to be correlated with the input ({p})");
    }
    let lag = number(acting.peak_lag_s.abs());
    let at = match acting.peak_lag_s {
        lag_s if lag_s.abs() < correlation.lag_step_s / 2.0 => "at lag 0".to_owned(),
        lag_s if lag_s > 0.0 => format!("at lag +{lag} s"),
        _ => format!("at lag -{lag} s"),
    };
    let percent = number((1000.0 * acting.share_outside).round() / 10.0);
    format!("correlated with the input, most {at} ({p}, {percent} % of lags)")
}

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
    let unit = unit_suffix(region.feature.unit(&misfit_units(joint)).as_deref());
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
    bracketed(name, feature.unit(&misfit_units(joint)).as_deref())
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
