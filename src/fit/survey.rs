//! Fits to one of some samples, to see which of many models are worth a fit to all of them.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::beginning::Beginning;
use super::problem::cost_of;
use super::record::FitRecord;
use super::result::{AssessedModel, Assessment, Fit, FitError, Parameter, Status, Termination};
use super::search::{ROUGH, Search, check_record, comparing, plain};
use super::space::Space;
use super::starts::starts;
use super::turn;
use crate::effect::RecordRange;
use crate::model::JointModel;

/// Starts that are followed.
const FOLLOWED: usize = 3;

/// The part by which costs differ after rough descents into one valley: a thirtieth of what these leave
/// open. On two measured joints 2 of 138 searches that end so close to another come to less than it in
/// the end, by more than 0.1 %.
const SAME_VALLEY: f64 = 1e-4;

/// Searches that are brought to their end; the others are given up when it is seen where
/// they lead.
const FINALISTS: usize = 2;

/// A model surveyed: fitted to one of some samples, and its sum of squared errors there.
///
/// Sums are comparable between models of the same record.
#[derive(Clone, Debug)]
pub struct Survey {
    /// The model at the values that were found.
    pub model: JointModel,
    /// The sum over the samples of the survey.
    pub cost: f64,
}

impl Survey {
    /// The model as it was surveyed on all of the record; of its parameters no standard errors are found.
    pub fn on(&self, record: &FitRecord<'_>, range: &RecordRange<'_>) -> Fit {
        let space = Space::of(&self.model, range);
        let parameter = |(index, (name, value)): (usize, (String, f64))| {
            let is_free = space.free.contains(&index);
            let status = if is_free { Status::Undetermined } else { Status::Fixed };
            Parameter { name, value, std_error: None, status }
        };
        let named = self.model.names().into_iter().zip(plain(&self.model)).enumerate();
        let parameters = named.map(parameter).collect();
        let evaluation = Arc::new(record.evaluate(&self.model));
        let cost = cost_of(&record.training(&evaluation.residuals));
        let assessed = AssessedModel { model: self.model.clone(), parameters };
        let termination = Termination::OutOfPatience;
        Fit { assessment: Assessment { assessed, evaluation }, cost, termination }
    }
}

/// A survey of which only the first part is done: rough descents from the starts of a model.
#[derive(Debug)]
pub struct RoughSurvey {
    /// The places that are worth going on from, best first, with the slopes there where they are known.
    places: Vec<(Survey, Option<DMatrix<f64>>)>,
}

impl RoughSurvey {
    /// The least sum of squared errors so far, of short windows; comparable like that of a [`Survey`].
    pub fn cost(&self) -> f64 {
        self.places.first().map_or(f64::MAX, |(place, _)| place.cost)
    }
}

/// Surveys the free parameters of `model`, from the starts of [`fit`](super::fit()): fits them to one of
/// some samples of the training windows.
///
/// # Errors
/// As [`fit`](super::fit()).
pub fn survey(
    record: &FitRecord<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
) -> Result<Survey, FitError> {
    let begun = rough_survey(record, model, range)?;
    let given = || Survey { model: model.clone(), cost: f64::MAX };
    Ok(end_survey(record, &begun, range).unwrap_or_else(given))
}

/// The first part of a [`survey`].
///
/// # Errors
/// As [`fit`](super::fit()).
pub fn rough_survey(
    record: &FitRecord<'_>,
    model: &JointModel,
    range: &RecordRange<'_>,
) -> Result<RoughSurvey, FitError> {
    let space = Space::of(model, range);
    check_record(record, &space)?;
    let coarse = record.for_training().coarser_for(model);
    let _turn = turn::wait_for(coarse.training_samples() * space.free.len());
    let short = coarse.shortened();
    // Between which levels an effect jumps is chosen on the whole record: few of its steps decide.
    let whole = space.has_jumps().then(|| record.coarser_for(model).unsplit().shortened());
    let searches = rough(&short, &coarse, model, &space, range).into_iter();
    let settled = searches.map(|search| whole.iter().fold(search, Search::across_flats_of));
    let place = |search: Search<'_, '_>| {
        (Survey { model: search.problem.model_now(), cost: search.cost }, search.slopes)
    };
    let mut places: Vec<_> = settled.map(place).collect();
    places.sort_by(|a, b| a.0.cost.total_cmp(&b.0.cost));
    Ok(RoughSurvey { places })
}

/// The rest of a survey that has `begun`: the best of where descents from its places end; none where it
/// has none.
pub fn end_survey(
    record: &FitRecord<'_>,
    begun: &RoughSurvey,
    range: &RecordRange<'_>,
) -> Option<Survey> {
    let (best, _) = begun.places.first()?;
    let coarse = record.for_training().coarser_for(&best.model);
    let samples = coarse.training_samples();
    let ends = begun.places.iter().map(|(place, slopes)| {
        let model = &place.model;
        let space = Space::of(model, range);
        let _turn = turn::wait_for(samples * space.free.len());
        let search = Search::new(&coarse, model, &space, plain(model)).knowing(slopes.clone());
        let search = search.descended(comparing(samples));
        Survey { model: search.problem.model_now(), cost: search.cost }
    });
    ends.min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// A rough descent from each of the most promising starts: the best of these. Slopes are kept for
/// descents that go on in the windows of `next`, where these are the same.
fn rough<'p, 'r>(
    short: &'p FitRecord<'r>,
    next: &FitRecord<'_>,
    model: &'p JointModel,
    space: &'p Space,
    range: &RecordRange<'_>,
) -> Vec<Search<'p, 'r>> {
    let slopes = short.training_samples() * space.free.len();
    let keeps_slopes = !turn::is_large(slopes) && next.windows() == short.windows();
    let descended = |search: Search<'p, 'r>| {
        let mut search = search.descended(ROUGH);
        search.slopes.take_if(|_| !keeps_slopes);
        search
    };
    let given = plain(model);
    let search = |start| descended(Search::new(short, model, space, start));
    let starts = starts(model, range);
    let (starts, mut searches, cost_of_given) = if let [start] = starts.as_slice() {
        let cost = || Search::new(short, model, space, given.clone()).problem.cost();
        let cost_of_given = (*start != given).then(cost);
        let found = vec![search(start.clone())];
        (starts, found, cost_of_given)
    } else {
        let beginning = Beginning::of(short, model, space, (given.clone(), &starts));
        let starts = beginning.most_promising(starts, FOLLOWED);
        let mut begun: Vec<_> =
            starts.iter().map(|start| beginning.search(start.clone())).collect();
        keep_distinct(&mut begun, |search| search.problem.cost(), 0.0);
        let found = begun.into_iter().map(descended).collect();
        (starts, found, Some(beginning.cost()))
    };
    let is_above = |given: f64| searches.iter().all(|search: &Search<'_, '_>| search.cost > given);
    if cost_of_given.is_some_and(is_above) {
        searches.extend(starts.iter().map(|start| search(nearer(&given, start))));
    }
    searches.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    searches.truncate(FINALISTS);
    keep_distinct(&mut searches, |search| search.cost, SAME_VALLEY);
    searches
}

/// Keeps one of the searches whose costs differ by no more than the part `apart`: the first.
fn keep_distinct<'p, 'r>(
    searches: &mut Vec<Search<'p, 'r>>,
    cost: impl Fn(&Search<'p, 'r>) -> f64,
    apart: f64,
) {
    let mut kept: Vec<f64> = Vec::new();
    searches.retain(|search| {
        let cost = cost(search);
        let is_new = kept.iter().all(|other| (cost - other).abs() > apart * other);
        kept.push(cost);
        is_new
    });
}

/// A start that is nearer to the values `given`: from one that is too far a descent may end in a valley
/// of its own, above where it would be without the effect.
fn nearer(given: &[f64], start: &[f64]) -> Vec<f64> {
    /// Part of the way. Chosen: on an excavator's bucket a friction, a stiction and a dead band by
    /// condition then end at a thirtieth of the squared error at which they had ended, or less.
    const PART: f64 = 0.25;
    given.iter().zip(start).map(|(given, start)| given + PART * (start - given)).collect()
}
