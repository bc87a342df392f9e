//! What tests and cuts of a residual found.

use serde::Serialize;

use crate::diagnosis::failure::{FailsWhere, Region, WorstSegment};
use crate::diagnosis::{
    CrossCorrelation, Curve, ErrorFigures, InputCorrelation, InputEdges, LackOfFit, LocalMisfit,
    ShownBy, Whiteness,
};
use crate::experiment::{Joint, Trial};

#[derive(Debug, Serialize)]
pub(super) struct FiguresJson {
    rmse: f64,
    rmse_raw: Option<f64>,
    rmse_free: Option<f64>,
    fit_percent: f64,
    max: f64,
}

impl FiguresJson {
    /// The figures of one part, with the errors from which nothing is removed: restarted, and of
    /// a free run.
    pub(super) fn new(error: &ErrorFigures, rmse_raw: Option<f64>, rmse_free: Option<f64>) -> Self {
        let ErrorFigures { rmse, fit_percent, max } = *error;
        Self { rmse, rmse_raw, rmse_free, fit_percent, max }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct LackOfFitJson {
    statistic: f64,
    p_value: f64,
    misfit_share: f64,
    times_noise: Option<f64>,
    times_training: Option<f64>,
    local: Option<LocalJson>,
    shown_by: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    input_edges: Option<EdgesJson>,
    adequate: bool,
}

/// Steps of the input between the samples of the log.
#[derive(Debug, Serialize)]
struct EdgesJson {
    steps: usize,
    spread_s: f64,
    share_of_squared_residual: f64,
}

impl From<InputEdges> for EdgesJson {
    fn from(InputEdges { steps, spread_s, share }: InputEdges) -> Self {
        Self { steps, spread_s, share_of_squared_residual: share }
    }
}

#[derive(Debug, Serialize)]
struct LocalJson {
    p_value: f64,
    times_noise: Option<f64>,
}

impl From<&LackOfFit> for LackOfFitJson {
    fn from(test: &LackOfFit) -> Self {
        let local =
            |LocalMisfit { p_value, times_noise }: LocalMisfit| LocalJson { p_value, times_noise };
        Self {
            statistic: test.statistic,
            p_value: test.p_value,
            misfit_share: test.misfit_share,
            times_noise: test.times_noise,
            times_training: test.times_training,
            local: test.local.map(local),
            shown_by: test.shown_by.map(shown_by_id),
            input_edges: test.edges.map(EdgesJson::from),
            adequate: test.adequate,
        }
    }
}

fn shown_by_id(shown_by: ShownBy) -> &'static str {
    match shown_by {
        ShownBy::Shapes => "shapes",
        ShownBy::Size => "size",
        ShownBy::UnseenPart => "unseen_part",
        ShownBy::FewWindows => "few_windows",
    }
}

#[derive(Debug, Serialize)]
pub(super) struct WhitenessJson<'a> {
    statistic: f64,
    p_value: f64,
    correlated_s: f64,
    confidence: f64,
    band: f64,
    lag_step_s: f64,
    correlation: &'a [f64],
}

impl<'a> From<&'a Whiteness> for WhitenessJson<'a> {
    fn from(test: &'a Whiteness) -> Self {
        Self {
            statistic: test.statistic,
            p_value: test.p_value,
            correlated_s: test.correlated_s,
            confidence: test.confidence,
            band: test.band,
            lag_step_s: test.lag_step_s,
            correlation: &test.correlation,
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct CorrelationJson<'a> {
    confidence: f64,
    lag_step_s: f64,
    first_lag_s: f64,
    acting: LagsJson<'a>,
    raw: LagsJson<'a>,
}

#[derive(Debug, Serialize)]
struct LagsJson<'a> {
    share_outside: f64,
    peak: f64,
    peak_lag_s: f64,
    p_value: f64,
    band: f64,
    correlation: &'a [f64],
}

impl<'a> From<&'a InputCorrelation> for CorrelationJson<'a> {
    fn from(test: &'a InputCorrelation) -> Self {
        let InputCorrelation { confidence, lag_step_s, first_lag_s, acting, raw } = test;
        let (confidence, lag_step_s, first_lag_s) = (*confidence, *lag_step_s, *first_lag_s);
        Self { confidence, lag_step_s, first_lag_s, acting: acting.into(), raw: raw.into() }
    }
}

impl<'a> From<&'a CrossCorrelation> for LagsJson<'a> {
    fn from(lags: &'a CrossCorrelation) -> Self {
        Self {
            share_outside: lags.share_outside,
            peak: lags.peak,
            peak_lag_s: lags.peak_lag_s,
            p_value: lags.p_value,
            band: lags.band,
            correlation: &lags.correlation,
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct FailsWhereJson<'a> {
    condition: &'a str,
    share_of_time: f64,
    share_of_squared_error: f64,
    /// Of what the squared error is.
    error_of: &'static str,
    rmse: f64,
    p_value: f64,
}

impl<'a> From<&'a FailsWhere> for FailsWhereJson<'a> {
    fn from(found: &'a FailsWhere) -> Self {
        let &FailsWhere { share_of_time, share_of_squared_error, rmse, p_value, .. } = found;
        let condition = &found.condition;
        let error_of = if found.of_speed { "speed" } else { "output" };
        Self { condition, share_of_time, share_of_squared_error, error_of, rmse, p_value }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct WorstSegmentJson<'a> {
    trial: &'a str,
    start_s: f64,
    end_s: f64,
    rmse: f64,
    largest_residual: f64,
    share_of_squared_error: f64,
}

impl<'a> WorstSegmentJson<'a> {
    /// With times by the clock of the log.
    pub(super) fn new(worst: &'a WorstSegment, joint: &Joint) -> Self {
        let &WorstSegment {
            start_s, end_s, rmse, largest_residual, share_of_squared_error, ..
        } = worst;
        let trial = joint.trials.iter().find(|trial| trial.label() == worst.trial);
        let origin_s = trial.map_or(0.0, Trial::origin_s);
        let [start_s, end_s] = [start_s, end_s].map(|time_s| origin_s + time_s);
        Self { trial: &worst.trial, start_s, end_s, rmse, largest_residual, share_of_squared_error }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct RegionJson<'a> {
    feature: &'static str,
    label: &'a str,
    from: f64,
    to: f64,
    share_of_time: f64,
    share_of_squared_error: f64,
    rmse: f64,
    mean_residual: f64,
}

impl<'a> From<&'a Region> for RegionJson<'a> {
    fn from(region: &'a Region) -> Self {
        Self {
            feature: region.feature.id(),
            label: &region.label,
            from: region.from,
            to: region.to,
            share_of_time: region.share_of_time,
            share_of_squared_error: region.share_of_squared_error,
            rmse: region.rmse,
            mean_residual: region.mean_residual,
        }
    }
}

/// A curve without a law, its band, and the model's.
#[derive(Debug, Serialize)]
pub(super) struct CurveJson<'a> {
    of: &'static str,
    x: &'a [f64],
    y: &'a [f64],
    low: &'a [f64],
    high: &'a [f64],
    model: &'a [f64],
}

impl<'a> From<&'a Curve> for CurveJson<'a> {
    fn from(curve: &'a Curve) -> Self {
        let Curve { of, x, y, low, high, model } = curve;
        Self { of: of.id(), x, y, low, high, model }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys(item: impl Serialize) -> String {
        let json = serde_json::to_value(item).unwrap();
        json.as_object().unwrap().keys().cloned().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn the_fields_are_those_of_the_interface() {
        let found = FailsWhere {
            condition: "|input| < 1.2".to_owned(),
            share_of_time: 0.31,
            share_of_squared_error: 0.88,
            of_speed: true,
            beside_speed: false,
            rmse: 1.3,
            p_value: 0.001,
            clauses: Vec::new(),
            samples: Vec::new(),
        };
        let expected = "condition share_of_time share_of_squared_error error_of rmse p_value";
        assert_eq!(keys(FailsWhereJson::from(&found)), expected);
        let joint = Joint {
            name: "boom".to_owned(),
            input_unit: None,
            output_unit: None,
            covariates: Vec::new(),
            trials: Vec::new().into(),
        };
        let worst = WorstSegment {
            trial: "1".to_owned(),
            start_s: 41.2,
            end_s: 43.0,
            rmse: 2.2,
            largest_residual: -4.1,
            share_of_squared_error: 0.12,
            samples: 0..10,
        };
        let expected = "trial start_s end_s rmse largest_residual share_of_squared_error";
        assert_eq!(keys(WorstSegmentJson::new(&worst, &joint)), expected);
    }
}
