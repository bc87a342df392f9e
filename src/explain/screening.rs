//! Many models, of which the most promising are fitted.
//!
//! It is a race: rough descents on short windows of one of some samples show which models are worth a
//! survey, which goes on to where these lead, and surveys which are worth a fit to all samples. Each takes
//! several times as long as the one before.

use super::outcome::FitOutcome;
use super::workers::Workers;
use crate::effect::RecordRange;
use crate::fit::{FitRecord, Survey, end_survey, fit_surveyed, rough_survey};
use crate::model::JointModel;

/// What the cost of a model may be after rough descents, in parts of the least of all, to be surveyed to the
/// end. Chosen: of 602 surveys on four measured joints the end was at less than three quarters of where the
/// rough descents were in 5 %, and of the best models of 50 steps the worst was at 1.3.
const AHEAD: f64 = 1.5;

/// Models that are surveyed to the end, at least and at most. A ranking says what the best is better than;
/// the best models of those steps were among the first 12.
const SURVEYED: (usize, usize) = (4, 16);

/// A survey of one of several models, beside what it is known by.
pub(super) type Surveyed<'m, K> = (&'m (K, JointModel), Survey);

/// Which models are surveyed to the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Entrants {
    /// Those that lead where the best do.
    Promising,
    /// All.
    All,
}

/// Surveys `models` and fits the best of them to `record`; `kept` says how many, of the ascending costs
/// of all surveys. Of several with one key the best by its survey counts.
pub(super) fn fit_best<K: Copy + PartialEq + Send + Sync>(
    record: &FitRecord<'_>,
    models: &[(K, JointModel)],
    range: &RecordRange<'_>,
    kept: impl FnOnce(&[f64]) -> usize,
    workers: &impl Workers,
) -> Vec<(K, FitOutcome)> {
    let mut surveys = surveyed(record, models, range, Entrants::All, workers);
    let costs: Vec<f64> = surveys.iter().map(|(_, survey)| survey.cost).collect();
    surveys.truncate(kept(&costs));
    fitted(record, &surveys, range, workers)
}

/// The surveyed models, fitted.
pub(super) fn fitted<K: Copy + Send + Sync>(
    record: &FitRecord<'_>,
    surveys: &[Surveyed<'_, K>],
    range: &RecordRange<'_>,
    workers: &impl Workers,
) -> Vec<(K, FitOutcome)> {
    let fit = |((key, model), survey): &Surveyed<'_, K>| {
        let fit = fit_surveyed(record, survey, model, range).ok()?;
        Some((*key, FitOutcome::of(record, fit)))
    };
    workers.map(surveys, fit).into_iter().flatten().collect()
}

/// Surveys of `models`, best first. Of several with one key there is the best.
pub(super) fn surveyed<'m, K: Copy + PartialEq + Send + Sync>(
    record: &FitRecord<'_>,
    models: &'m [(K, JointModel)],
    range: &RecordRange<'_>,
    entrants: Entrants,
    workers: &impl Workers,
) -> Vec<Surveyed<'m, K>> {
    let begun = workers.map(models, |(_, model)| rough_survey(record, model, range).ok());
    let mut begun: Vec<_> =
        models.iter().zip(begun).filter_map(|(of, rough)| Some((of, rough?))).collect();
    if entrants == Entrants::Promising {
        begun.sort_by(|a, b| a.1.cost().total_cmp(&b.1.cost()));
        let limit = begun.first().map_or(0.0, |(_, best)| AHEAD * best.cost());
        let promising = begun.partition_point(|(_, rough)| rough.cost() <= limit);
        let (least, most) = SURVEYED;
        begun.truncate(promising.clamp(least, most));
    }
    let ends = workers.map(&begun, |(_, rough)| end_survey(record, rough, range));
    let mut surveys: Vec<_> =
        begun.into_iter().zip(ends).filter_map(|((of, _), end)| Some((of, end?))).collect();
    surveys.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    let mut seen = Vec::new();
    surveys.retain(|((key, _), _)| {
        let is_new = !seen.contains(key);
        seen.push(*key);
        is_new
    });
    surveys
}
