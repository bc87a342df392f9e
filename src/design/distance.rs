//! How far the best fit of a rival stays from what a model does.

use super::power::{Distance, Expected};
use super::predict::TestRig;
use super::schedule::Schedule;
use super::suspects::Suspects;
use crate::effect::RecordRange;
use crate::fit::{Fit, FitRecord, Horizon, Part, Split, Status, fit_to_compare, survey};
use crate::model::{Component, JointModel};

/// What a race shows of the data of suspect number `truth`, at the numbers of `model`, when
/// `schedule` is played: every model gets its best fit, from the same starts as in the race.
///
/// `None` where the record would be too short for a fit.
pub(super) fn expected(
    suspects: &Suspects,
    truth: usize,
    model: &JointModel,
    (rig, schedule): (&TestRig, &Schedule),
) -> Option<Expected> {
    let clean = rig.output(model, schedule);
    let carrier: Vec<f64> = (0..clean.len()).map(|k| carrier(k, suspects.noise)).collect();
    // Without noise robust weights would take every misfit for a spike.
    let output = clean.iter().zip(&carrier).map(|(y, c)| y + c).collect();
    let joint = rig.log(schedule, output)?;
    let record = FitRecord::new(&joint, Split::of(&joint), Horizon::Steps);
    let range = record.range_for(&suspects.base);
    let neither = fit_to_compare(&record, &suspects.base, &range).ok()?;
    let distance = |fit: &Fit| distance(&record, fit, &carrier, suspects.noise);
    let fitted = |place: usize| best(&record, suspects, place, &neither.model, &range);
    let samples = [Part::Training, Part::Validation]
        .map(|part| record.part(part).map(|window| window.end - window.start).sum::<usize>());
    Some(Expected {
        samples: (samples[0], samples[1]),
        rival: distance(&fitted(1 - truth)?),
        own: distance(&fitted(truth)?),
        neither: distance(&neither),
    })
}

/// Stands for noise in a fit: of the size that robust weights take noise to be, and so fast
/// that no model follows it.
fn carrier(sample: usize, noise: f64) -> f64 {
    /// The median magnitude of a standard normal variable.
    const MEDIAN: f64 = 0.674_489_75;
    if sample.is_multiple_of(2) { MEDIAN * noise } else { -MEDIAN * noise }
}

/// The better of two fits of a suspect: from where it changes nothing, as in the race, and
/// from the numbers that are known.
fn best(
    record: &FitRecord<'_>,
    suspects: &Suspects,
    place: usize,
    base: &JointModel,
    range: &RecordRange<'_>,
) -> Option<Fit> {
    let neutral = base.with(Component::neutral(*suspects.effects.get(place)?));
    let surveyed = survey(record, &neutral, range).ok().map(|found| found.model);
    let known = suspects.models.get(place).map(|known| known.model.clone());
    let fits = surveyed.into_iter().chain(known);
    let fits = fits.filter_map(|start| fit_to_compare(record, &start, range).ok());
    fits.min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// The squared residual of `fit`, in variances of the noise.
fn distance(record: &FitRecord<'_>, fit: &Fit, carrier: &[f64], noise: f64) -> Distance {
    let part = |part| {
        let squares = record.part(part).map(|window| {
            let samples = window.start..window.end;
            let own = &fit.evaluation.residuals[window.trial][samples.clone()];
            let noise = &carrier[samples];
            // λ counts what the model cannot follow, not the carrier.
            own.iter().zip(noise).map(|(own, noise)| (own - noise).powi(2)).sum::<f64>()
        });
        squares.sum::<f64>() / (noise * noise)
    };
    let free = fit.parameters.iter().filter(|parameter| parameter.status != Status::Fixed);
    Distance {
        training: part(Part::Training),
        validation: part(Part::Validation),
        parameters: free.count(),
    }
}
