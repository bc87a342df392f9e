//! What `explain` and `improve` have found of a joint, as JSON and as a table.

use comfy_table::{Table, presets};
use serde::Serialize;
use serde_json::{Map, Value};

use super::ComparedJoint;
use super::compare::{align_right, parameters_json};
use super::separation::SeparationJson;
use crate::effect::Spec;
use crate::experiment::Joint;
use crate::explain::{Candidate, Verdict};
use crate::model::Component;
use crate::wording::{p_text, with_unit};

/// A joint, the verdict on its model, and the race behind it.
#[derive(Clone, Copy, Debug)]
pub struct Finding<'a> {
    /// The model that the verdict is about.
    pub compared: ComparedJoint<'a>,
    /// The verdict.
    pub verdict: Verdict,
    /// The candidates, best first.
    pub ranking: &'a [Candidate],
    /// What stands behind the effect on the command line that adds it.
    pub add_arguments: &'a str,
}

/// A candidate in a ranking.
#[derive(Debug, Serialize)]
pub(super) struct CandidateJson<'a> {
    effect: String,
    effects: &'a [&'static str],
    equation: Vec<&'static str>,
    train_rmse: Option<f64>,
    validation_rmse: Option<f64>,
    error_reduction_percent: f64,
    p_value: f64,
    share_of_misfit: f64,
    parameters: Map<String, Value>,
    indistinguishable_from: &'a [&'static str],
    separated_by: Vec<SeparationJson<'a>>,
    noise_floor: Option<f64>,
}

impl<'a> CandidateJson<'a> {
    pub(super) fn new(joint: &Joint, candidate: &'a Candidate) -> Self {
        let separations = candidate.separated_by.iter();
        Self {
            effect: candidate.name(),
            effects: &candidate.effects,
            equation: specs(candidate).map(|spec| spec.equation).collect(),
            train_rmse: candidate.training.map(|error| error.rmse),
            validation_rmse: candidate.validation.map(|error| error.rmse),
            error_reduction_percent: candidate.error_reduction_percent,
            p_value: candidate.p_value,
            share_of_misfit: candidate.share_of_misfit,
            parameters: own_parameters(joint, candidate),
            indistinguishable_from: &candidate.indistinguishable_from,
            separated_by: separations.map(|s| SeparationJson::new(joint, s)).collect(),
            noise_floor: candidate.noise_floor,
        }
    }
}

/// The effects that a candidate added, in its order.
pub(super) fn added(candidate: &Candidate) -> impl Iterator<Item = &Component> {
    let components = candidate.fit.model.components();
    let of_id =
        |id: &&'static str| components.iter().find(|component| component.effect().spec().id == *id);
    candidate.effects.iter().filter_map(of_id)
}

pub(super) fn specs(candidate: &Candidate) -> impl Iterator<Item = &'static Spec> {
    added(candidate).map(|component| component.effect().spec())
}

/// The parameters of what was added: `upper` of one effect, `dead_band.upper` of several.
fn own_parameters(joint: &Joint, candidate: &Candidate) -> Map<String, Value> {
    let own = |name: String| {
        let (effect, short) = name.split_once('.')?;
        let is_added = candidate.effects.contains(&effect);
        let short = if candidate.effects.len() == 1 { short.to_owned() } else { name.clone() };
        is_added.then_some(short)
    };
    let all = parameters_json(joint, &candidate.fit);
    all.into_iter().filter_map(|(name, value)| Some((own(name)?, value))).collect()
}

/// The candidates, best first.
pub(super) fn ranking_table(joint: &Joint, ranking: &[Candidate]) -> String {
    let mut table = Table::new();
    let header = ["effect", "validation", "reduction", "chance", "cannot be told from"];
    table.load_style(presets::UTF8_BORDERS_ONLY).set_header(header);
    for candidate in ranking {
        let same = &candidate.indistinguishable_from;
        table.add_row([
            candidate.name(),
            with_unit(candidate.rmse(), joint.output_unit.as_deref()),
            format!("{:.1} %", candidate.error_reduction_percent),
            p_text(candidate.p_value),
            if same.is_empty() { "-".to_owned() } else { same.join(", ") },
        ]);
    }
    align_right(&mut table, 1..3);
    table.to_string()
}
