//! What tests say of a residual: lack of fit, whiteness, correlation with the input.

use super::{number, p_text, rounded};
use crate::diagnosis::{
    CONFIDENCE, Comparison, InputCorrelation, LackOfFit, NEGLIGIBLE, SIGNIFICANCE, ShownBy,
    Whiteness,
};

/// Whether a lack of fit is shown, and by what.
pub(crate) fn lack_of_fit(test: LackOfFit) -> String {
    let p_value = p_text(test.p_value);
    match test.shown_by {
        None if test.edges.is_some() => "not shown beyond the step times".to_owned(),
        None if test.p_value >= SIGNIFICANCE => format!("not shown ({p_value})"),
        None if test.misfit_share < NEGLIGIBLE => {
            format!("negligible ({} % of the squared error)", rounded(100.0 * test.misfit_share))
        }
        None => format!("close to the noise ({p_value})"),
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
