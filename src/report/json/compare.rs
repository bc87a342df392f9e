//! Schema `tauscope/compare/1`.

use serde::Serialize;

use super::header::Header;
use super::joint::JointJson;
use crate::diagnosis::RegionPair;
use crate::report::compare::{ComparedJoint, ComparedModels, model_differences};

/// The document of `compare --format json`.
#[derive(Debug, Serialize)]
pub(crate) struct CompareJson<'a> {
    #[serde(flatten)]
    header: Header,
    joints: Vec<JointJson<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    against: Vec<AgainstJson<'a>>,
    failures: &'a [String],
}

impl<'a> CompareJson<'a> {
    /// Collects the results; `failures` are messages on joints and files that failed.
    pub(crate) fn new(joints: &[ComparedJoint<'a>], failures: &'a [String]) -> Self {
        let against = model_differences(joints).into_iter().map(AgainstJson::new).collect();
        let joints = joints.iter().map(JointJson::new).collect();
        Self { header: Header::of("tauscope/compare/1"), joints, against, failures }
    }
}

/// The first model of a joint beside another one.
#[derive(Debug, Serialize)]
struct AgainstJson<'a> {
    joint: &'a str,
    model: &'a str,
    other: &'a str,
    steps: usize,
    validation: bool,
    rmse: f64,
    other_rmse: f64,
    better_steps: usize,
    statistic: Option<f64>,
    p_value: Option<f64>,
    significant: Option<bool>,
    better_where: Vec<PlaceJson>,
    worse_where: Vec<PlaceJson>,
}

/// A part of the record, with the error of both.
#[derive(Debug, Serialize)]
struct PlaceJson {
    feature: &'static str,
    label: String,
    from: f64,
    to: f64,
    share_of_time: f64,
    rmse: f64,
    other_rmse: f64,
}

impl<'a> AgainstJson<'a> {
    fn new(models: ComparedModels<'a>) -> Self {
        let ComparedModels { joint, model, other, difference } = models;
        let places = |pairs: Vec<RegionPair>| pairs.into_iter().map(Into::into).collect();
        Self {
            joint: &joint.name,
            model,
            other,
            steps: difference.steps,
            validation: difference.is_validation,
            rmse: difference.rmse,
            other_rmse: difference.other_rmse,
            better_steps: difference.better_steps,
            statistic: difference.test.map(|test| test.statistic),
            p_value: difference.test.map(|test| test.p_value),
            significant: difference.is_significant(),
            better_where: places(difference.better_where),
            worse_where: places(difference.worse_where),
        }
    }
}

impl From<RegionPair> for PlaceJson {
    fn from(RegionPair { region, other_rmse }: RegionPair) -> Self {
        Self {
            feature: region.feature.id(),
            label: region.label,
            from: region.from,
            to: region.to,
            share_of_time: region.share_of_time,
            rmse: region.rmse,
            other_rmse,
        }
    }
}
