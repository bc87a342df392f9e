//! Many models, of which the most promising are fitted.
//!
//! A survey, which is a fit to one of some samples, is cheap; a fit to all of them is not.

use super::outcome::FitOutcome;
use super::workers::Workers;
use crate::effect::RecordRange;
use crate::fit::{FitRecord, Survey, fit_surveyed, survey};
use crate::model::JointModel;

/// Surveys `models` and fits the best of them to `record`; `kept` says how many, of the ascending costs
/// of all surveys. Of several with one key the best by its survey counts.
pub(super) fn fit_best<K: Copy + PartialEq + Send + Sync>(
    record: &FitRecord<'_>,
    models: &[(K, JointModel)],
    range: &RecordRange<'_>,
    kept: impl FnOnce(&[f64]) -> usize,
    workers: &impl Workers,
) -> Vec<(K, FitOutcome)> {
    let surveyed: Vec<Option<Survey>> =
        workers.map(models, |(_, model)| survey(record, model, range).ok());
    let mut surveys: Vec<_> =
        models.iter().zip(surveyed).filter_map(|(of, survey)| Some((of, survey?))).collect();
    surveys.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    let mut seen = Vec::new();
    surveys.retain(|((key, _), _)| {
        let is_new = !seen.contains(key);
        seen.push(*key);
        is_new
    });
    let costs: Vec<f64> = surveys.iter().map(|(_, survey)| survey.cost).collect();
    surveys.truncate(kept(&costs));
    let fit = |((key, model), survey): &(&(K, JointModel), Survey)| {
        let fit = fit_surveyed(record, survey, model, range).ok()?;
        Some((*key, FitOutcome::of(record, fit)))
    };
    workers.map(&surveys, fit).into_iter().flatten().collect()
}
