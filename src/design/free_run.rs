//! How far the predictions of a model are off on parts of a record that it was not fitted to.
//!
//! # References
//! M. Stone, "Cross-validatory choice and assessment of statistical predictions", Journal of
//! the Royal Statistical Society B 36 (1974), 111-147.

use crate::experiment::{Joint, Trial};
use crate::fit::{FitRecord, Horizon, Split, fit};
use crate::model::{Commands, JointModel, Restart, Surroundings, simulate};
use crate::numerics::median;

/// Parts of a record, each of which is left out once.
const PARTS: usize = 5;

/// Fewest parts whose errors stand for those to come.
const FEWEST_PARTS: usize = 3;

/// Free runs that begin in each part, as far apart as they can be.
const RUNS: usize = 6;

/// Samples of the shortest free run that counts.
const SHORTEST_RUN: usize = 20;

/// How much farther off a prediction may be than the farthest so far. A few parts of one record
/// stand for all that is to come: the farthest of five normal errors is 1.2 standard deviations
/// on average, and 2.6 are to be kept for a hundredth. Chosen; `examples/design_validation.rs`
/// shows what comes of it.
pub const RESERVE: f64 = 2.0;

/// How far free-running predictions were off on parts of a record that were left out of the fit,
/// by the time since their start, and by the way that the joint was to go.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRunError {
    by_time: Growth,
    by_way: Growth,
}

/// The largest error up to each place of an axis.
#[derive(Clone, Debug, PartialEq)]
struct Growth {
    /// Width of a bin on the axis.
    width: f64,
    /// The largest error up to the end of each bin; rises.
    largest: Vec<f64>,
}

/// A prediction beside what came of it, a value per sample.
struct Run {
    period_s: f64,
    /// Way that the joint was to go until the sample, output units.
    way: Vec<f64>,
    /// Magnitude of the error, output units.
    error: Vec<f64>,
}

impl FreeRunError {
    /// The errors of `model` on `joint`, its numbers fitted anew to what is left each time a part
    /// is left out: a fifth of the trials, or a fifth of the time of each where they are few.
    ///
    /// `None` where too little can be left out.
    pub fn of(joint: &Joint, model: &JointModel) -> Option<Self> {
        let record = FitRecord::new(joint, Split::Time(1.0), Horizon::FreeRun);
        let radians_per_output_unit = record.range(&[], 0.0).radians_per_output_unit;
        let parts = (0..PARTS).filter_map(|part| {
            let (refitted, later_s) = refitted(joint, model, part)?;
            let runs = joint.trials.iter().enumerate().flat_map(|(index, trial)| {
                let start_s = record.start_s(index) - later_s;
                let around =
                    Surroundings { radians_per_output_unit, start_s, ..Surroundings::default() };
                runs(&refitted, trial, left_out(joint, index, part), &around)
            });
            Some(runs.collect::<Vec<_>>()).filter(|runs| !runs.is_empty())
        });
        let parts: Vec<Vec<Run>> = parts.collect();
        if parts.len() < FEWEST_PARTS {
            return None;
        }
        let runs: Vec<Run> = parts.into_iter().flatten().collect();
        let seconds = |run: &Run, sample: usize| sample as f64 * run.period_s;
        let way = |run: &Run, sample: usize| run.way.get(sample).copied().unwrap_or(0.0);
        Some(Self { by_time: Growth::of(&runs, seconds), by_way: Growth::of(&runs, way) })
    }

    /// How far a prediction may be off `seconds` after its start, when the joint is to have gone
    /// `way`: the farthest that one was off so far, [`RESERVE`] times, by time or by way,
    /// whichever is more. Beyond the longest run it grows in proportion, which no error with
    /// increments of one kind exceeds.
    pub fn margin(&self, seconds: f64, way: f64) -> f64 {
        RESERVE * self.by_time.at(seconds).max(self.by_way.at(way))
    }

    /// Errors that grow by so much in a second.
    #[cfg(test)]
    pub(super) fn growing(per_second: f64) -> Self {
        let width = 0.1;
        let largest = (1..=100).map(|bin| per_second * width * f64::from(bin)).collect();
        let none = Growth { width: 1.0, largest: vec![0.0; 100] };
        Self { by_time: Growth { width, largest }, by_way: none }
    }

    /// Seconds of the longest run.
    pub fn longest_s(&self) -> f64 {
        self.by_time.width * self.by_time.largest.len() as f64
    }

    /// The largest error of all runs, output units.
    pub fn largest(&self) -> f64 {
        self.by_time.largest.last().copied().unwrap_or(0.0)
    }
}

impl Growth {
    fn of(runs: &[Run], axis: impl Fn(&Run, usize) -> f64) -> Self {
        /// Bins of an axis.
        const BINS: usize = 100;
        let ends = runs.iter().map(|run| axis(run, run.error.len().saturating_sub(1)));
        let end = ends.fold(0.0, f64::max);
        let width = if end > 0.0 { end / BINS as f64 } else { 1.0 };
        let mut largest = vec![0.0; BINS];
        for run in runs {
            for (sample, error) in run.error.iter().enumerate() {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 0")]
                let bin = ((axis(run, sample) / width) as usize).min(BINS - 1);
                if let Some(slot) = largest.get_mut(bin) {
                    *slot = error.max(*slot);
                }
            }
        }
        let rise = |so_far: &mut f64, error: f64| {
            *so_far = so_far.max(error);
            Some(*so_far)
        };
        let largest = largest.into_iter().scan(0.0, rise).collect();
        Self { width, largest }
    }

    fn at(&self, place: f64) -> f64 {
        let end = self.width * self.largest.len() as f64;
        let last = self.largest.last().copied().unwrap_or(0.0);
        if place >= end {
            return last * place / end;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "≥ 0")]
        let bin = (place / self.width).max(0.0) as usize;
        self.largest.get(bin).copied().unwrap_or(last)
    }
}

/// The samples of the trial number `index` that are left out with `part`.
fn left_out(joint: &Joint, index: usize, part: usize) -> (usize, usize) {
    let samples = joint.trials.get(index).map_or(0, Trial::len);
    if joint.trials.len() >= PARTS {
        let whole = index % PARTS == part;
        return if whole { (0, samples) } else { (0, 0) };
    }
    (samples * part / PARTS, samples * (part + 1) / PARTS)
}

/// `model` fitted to all but one part of `joint`, and by how many seconds what is left begins
/// later: its time counts from there.
fn refitted(joint: &Joint, model: &JointModel, part: usize) -> Option<(JointModel, f64)> {
    let pieces = joint.trials.iter().enumerate().flat_map(|(index, trial)| {
        let (from, to) = left_out(joint, index, part);
        [piece(trial, 0, from), piece(trial, to, trial.len())]
    });
    let trials: Vec<Trial> = pieces.flatten().collect();
    let rest = Joint { trials, covariates: Vec::new(), ..joint.clone() };
    let record = FitRecord::new(&rest, Split::Time(1.0), Horizon::Steps);
    let levels = record.input_levels();
    let top = levels.last().copied().unwrap_or(1.0);
    let range = record.range(&levels, model.gain.value.abs() * top);
    let begin = |joint: &Joint| joint.trials.first().map(|trial| trial.time_s(1));
    let is_cut = joint.trials.len() < PARTS;
    let later_s = if is_cut { begin(&rest)? - begin(joint)? } else { 0.0 };
    fit(&record, model, &range).ok().map(|fit| (fit.assessment.model, later_s))
}

/// The samples `from..to` of `trial`, at their time.
fn piece(trial: &Trial, from: usize, to: usize) -> Option<Trial> {
    let (input, output) = (trial.input().get(from..to)?, trial.output().get(from..to)?);
    if input.len() < SHORTEST_RUN {
        return None;
    }
    let start_s = trial.time_s(from + 1);
    Trial::new(trial.label(), start_s, trial.period(), input.to_vec(), output.to_vec()).ok()
}

/// Free runs of `model` over the samples `from..to` of `trial`, from several places to the end.
fn runs(
    model: &JointModel,
    trial: &Trial,
    (from, to): (usize, usize),
    around: &Surroundings<'_>,
) -> Vec<Run> {
    let samples = to.saturating_sub(from);
    let places = (0..RUNS).map(|run| from + samples * run / RUNS);
    let mut places: Vec<usize> = places.filter(|place| to - place >= SHORTEST_RUN).collect();
    places.dedup();
    places.into_iter().filter_map(|place| run(model, trial, (place, to), around)).collect()
}

/// A free run over the samples `from..to`, which knows what was played before.
fn run(
    model: &JointModel,
    trial: &Trial,
    (from, to): (usize, usize),
    around: &Surroundings<'_>,
) -> Option<Run> {
    let period_s = trial.period().seconds();
    let played = Commands::new(trial.input().get(..to)?, period_s);
    let arrivals = played.arriving(model, around.start_s, None);
    let begin = |sample: usize| {
        let output = start_of(trial, sample)?;
        Some(Restart { sample, output, speed: None })
    };
    let mut restarts = vec![begin(0)?];
    restarts.extend((from > 0).then(|| begin(from)).flatten());
    let simulated = simulate(model, &arrivals, to, period_s, &restarts, around).output;
    let (simulated, output) = (simulated.get(from..)?, trial.output().get(from..to)?);
    let error: Vec<f64> = output.iter().zip(simulated).map(|(y, own)| (y - own).abs()).collect();
    let steps = simulated.windows(2).map(|pair| match pair {
        [a, b] => (b - a).abs(),
        _ => 0.0,
    });
    let sum = |way: &mut f64, step: f64| {
        *way += step;
        Some(*way)
    };
    let way = std::iter::once(0.0).chain(steps).scan(0.0, sum).collect();
    Some(Run { period_s, way, error: without_spikes(&error) })
}

/// The output at `sample`, of which noise is taken off by its neighbours.
fn start_of(trial: &Trial, sample: usize) -> Option<f64> {
    median(trial.output().get(sample.saturating_sub(1)..(sample + 2).min(trial.len()))?)
}

/// `values`, each the median of five: a sensor's spike is no error of the model.
fn without_spikes(values: &[f64]) -> Vec<f64> {
    /// Neighbours on either side.
    const NEAR: usize = 2;
    let near = |k: usize| values.get(k.saturating_sub(NEAR)..(k + NEAR + 1).min(values.len()));
    (0..values.len()).map(|k| near(k).and_then(median).unwrap_or(0.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::predict::tests::rig;
    use super::super::random::{RandomSteps, random_steps};
    use super::*;
    use crate::effect::DirectionGain;
    use crate::model::Component;

    /// A log of a joint that is a third slower in one direction.
    fn log(duration_s: f64) -> Joint {
        let levels = vec![-2.0, -1.0, 0.0, 1.0, 2.0];
        let steps = RandomSteps { levels, hold_s: (0.5, 1.5), duration_s, seed: 3 };
        let rig = rig(None);
        let schedule = random_steps(&steps, &rig, None, 0);
        rig.log(&schedule, rig.output(&slower(), &schedule)).unwrap()
    }

    fn slower() -> JointModel {
        let effect = Component::new(&DirectionGain, vec![0.7.into()]).unwrap();
        JointModel::integrator(10.0, 0.15).with(effect)
    }

    #[test]
    fn a_model_that_is_right_is_hardly_off_and_one_that_lacks_an_effect_is() {
        let log = log(60.0);
        let right = FreeRunError::of(&log, &slower()).unwrap();
        let wrong = FreeRunError::of(&log, &JointModel::integrator(9.0, 0.15)).unwrap();
        assert!(right.largest() < 0.05, "{}", right.largest());
        assert!(wrong.largest() > 3.0, "{}", wrong.largest());
        assert!((right.longest_s() - 12.0).abs() < 0.1, "{}", right.longest_s());
    }

    #[test]
    fn margins_grow_with_time_and_way_and_in_proportion_beyond_the_longest_run() {
        let wrong = FreeRunError::of(&log(60.0), &JointModel::integrator(9.0, 0.15)).unwrap();
        let margins: Vec<f64> = (0..30).map(|k| wrong.margin(f64::from(k), 0.0)).collect();
        assert!(margins.windows(2).all(|pair| pair[0] <= pair[1]));
        let at = |seconds| wrong.margin(seconds, 0.0);
        assert!((at(48.0) / at(24.0) - 2.0).abs() < 1e-9);
        assert!((at(12.1) - RESERVE * wrong.largest()).abs() < 0.02 * at(12.1));
        assert!(wrong.margin(0.5, 1e4) > wrong.margin(0.5, 1.0));
    }

    #[test]
    fn a_record_of_which_nothing_can_be_left_out_shows_no_errors() {
        assert_eq!(FreeRunError::of(&log(0.8), &slower()), None);
    }
}
