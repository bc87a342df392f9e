//! How far the predictions of a model are off on parts of a record that it was not fitted to.
//!
//! # References
//! M. Stone, "Cross-validatory choice and assessment of statistical predictions", Journal of
//! the Royal Statistical Society B 36 (1974), 111-147.

use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

use super::stops::{SHORTEST_RUN, Stops, extent};
use super::trend::{Travel, Trend};
use crate::effect::{Effect as _, EndStop};
use crate::experiment::{Joint, Trial};
use crate::fit::{FitRecord, Horizon, Split, fit, follows_input};
use crate::model::{Commands, JointModel, Restart, Surroundings, simulate};
use crate::numerics::median;

/// Parts of a record, each of which is left out once.
const PARTS: usize = 5;

/// Fewest parts whose errors stand for those to come.
const FEWEST_PARTS: usize = 3;

/// Free runs that begin in each part, as far apart as they can be.
const RUNS: usize = 6;

/// Orders in which motions that end at a stop are joined: that of the log, and others, as a plan
/// has them in an order of its own.
const ORDERS: usize = 4;

/// How much farther off a prediction may be than the farthest so far. A few parts of one record
/// stand for all that is to come: the farthest of five normal errors is 1.2 standard deviations
/// on average, and 2.6 are to be kept for a hundredth. Chosen; `examples/design_validation.rs`
/// shows what comes of it.
pub const RESERVE: f64 = 2.0;

/// How much farther still where the log shows motions from stop to stop alone: no rest on the way,
/// and no turn. Chosen, as [`RESERVE`] is.
const UNSEEN: f64 = 1.5;

/// How far free-running predictions were off on parts of a record that were left out of the fit,
/// by the time since their start, and by the way that the joint was to go.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRunError {
    by_time: Growth,
    by_way: Growth,
    /// What is off each time in the same way, of motions from stop to stop.
    trend: Option<Trend>,
    /// Whether an error is forgotten: the output regulates itself.
    is_bounded: bool,
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
#[derive(Clone)]
struct Run {
    period_s: f64,
    /// Way that the joint was to go until the sample, output units.
    way: Vec<f64>,
    /// How far it was to come until the end, output units.
    distance: f64,
    /// The error, output units.
    error: Vec<f64>,
}

/// Samples `from..to` of a trial, through which the joint moves freely.
#[derive(Clone, Copy)]
struct Piece<'a> {
    trial: &'a Trial,
    /// Seconds of the record before the trial.
    start_s: f64,
    from: usize,
    to: usize,
}

impl FreeRunError {
    /// The errors of `model` on `joint`, its numbers fitted anew to what is left each time a part
    /// is left out: a fifth of the trials, or a fifth of the time of each where they are few.
    ///
    /// A stop takes off the error that a run has made. So runs end where the joint comes to a
    /// stop, and go on where it leaves it with the error that they had; so do they from one trial
    /// to the next. Where motions from stop to stop are too few to show a trend, each is by
    /// itself, and what is off in it is off in proportion later. Of an output that regulates
    /// itself each run is by itself: it forgets its error.
    ///
    /// `None` where too little can be left out.
    pub fn of(joint: &Joint, model: &JointModel) -> Option<Self> {
        let record = FitRecord::new(joint, Split::Time(1.0), Horizon::FreeRun);
        let radians_per_output_unit = record.range(&[], 0.0).radians_per_output_unit;
        let around = Surroundings { radians_per_output_unit, ..Surroundings::default() };
        let stops = Stops::of(joint);
        let mut is_bounded = follows_input(joint).is_some();
        let mut parts = Vec::new();
        for part in 0..PARTS {
            let Some((refitted, later_s)) = refitted(joint, model, part) else { continue };
            let trials = joint.trials.iter().enumerate();
            let pieces = trials.flat_map(|(index, trial)| {
                let start_s = record.start_s(index) - later_s;
                let free = stops.free(trial, left_out(joint, index, part), refitted.delay.value);
                free.into_iter().map(move |(from, to)| Piece { trial, start_s, from, to })
            });
            let pieces: Vec<Piece<'_>> = pieces.collect();
            is_bounded &= forgets(&refitted, &pieces, &around);
            parts.push((refitted, pieces));
        }
        parts.retain(|(_, pieces)| !pieces.is_empty());
        if parts.len() < FEWEST_PARTS {
            return None;
        }
        // A stop of the model would take off errors as the joint's own does; of a joint that is not
        // driven from stop to stop it stands for touches that are too short to be seen.
        let freed = parts.iter().map(|(model, _)| model.without(EndStop.spec().id));
        let freed: Vec<JointModel> = freed.collect();
        let motions = parts.iter().zip(&freed).flat_map(|((_, pieces), model)| {
            pieces.iter().filter_map(|piece| run(model, *piece, piece.from, &around)?.end())
        });
        let trend = Trend::of(&motions.collect::<Vec<_>>());
        let trend = trend.filter(|_| !is_bounded && !stops.are_none());
        let is_joined = !is_bounded && (trend.is_some() || stops.are_none());
        let runs = parts.iter().zip(&freed).flat_map(|((model, pieces), freed)| {
            let model = if trend.is_some() { freed } else { model };
            let joined = if is_joined { in_orders(pieces) } else { each(pieces) };
            joined.into_iter().flat_map(|pieces| runs(model, &pieces, &around)).collect::<Vec<_>>()
        });
        let runs: Vec<Run> = runs.collect();
        let seconds = |run: &Run, sample: usize| sample as f64 * run.period_s;
        let way = |run: &Run, sample: usize| run.way.get(sample).copied().unwrap_or(0.0);
        let (by_time, by_way) = (Growth::of(&runs, seconds), Growth::of(&runs, way));
        Some(Self { by_time, by_way, trend, is_bounded })
    }

    /// How far a prediction may be off when the joint is to have gone so far: the farthest that
    /// one was off so far, [`RESERVE`] times, by time or by way, or what is off each time in the
    /// same way, whichever is more; and half as much again of motions from stop to stop. Beyond
    /// the longest run it grows in proportion, which no error with increments of one kind exceeds.
    /// Of an output that regulates itself it is the same all the time.
    pub fn margin(&self, travel: Travel) -> f64 {
        if self.is_bounded {
            return RESERVE * self.largest();
        }
        let measured = self.by_time.at(travel.seconds).max(self.by_way.at(travel.way));
        match &self.trend {
            Some(trend) => self.reserve() * trend.at(travel).max(measured),
            None => self.reserve() * measured,
        }
    }

    /// How many times the errors so far a margin is.
    pub fn reserve(&self) -> f64 {
        if self.trend.is_some() { UNSEEN * RESERVE } else { RESERVE }
    }

    /// Whether the error of a prediction does not grow with its length.
    pub fn is_bounded(&self) -> bool {
        self.is_bounded
    }

    /// Errors that grow by so much in a second.
    #[cfg(test)]
    pub(super) fn growing(per_second: f64) -> Self {
        let width = 0.1;
        let largest = (1..=100).map(|bin| per_second * width * f64::from(bin)).collect();
        let none = Growth { width: 1.0, largest: vec![0.0; 100] };
        Self { by_time: Growth { width, largest }, by_way: none, trend: None, is_bounded: false }
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
                    *slot = error.abs().max(*slot);
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
    let record = FitRecord::new(&rest, Split::Time(1.0), Horizon::Auto);
    let levels = record.input_levels();
    let top = levels.last().copied().unwrap_or(1.0);
    let range = record.range(&levels, model.gain.value.abs() * top);
    let begin = |joint: &Joint| joint.trials.first().map(|trial| trial.time_s(1));
    let is_cut = joint.trials.len() < PARTS;
    let later_s = if is_cut { begin(&rest)? - begin(joint)? } else { 0.0 };
    fit(&record, model, &range).ok().map(|fit| (fit.assessment.model, later_s))
}

/// The samples `from..to` of `trial`, where they are enough.
fn piece(trial: &Trial, from: usize, to: usize) -> Option<Trial> {
    trial.part(from, to).filter(|part| part.len() >= SHORTEST_RUN)
}

/// Whether `model` forgets where it began within a third of the longest of `pieces`.
fn forgets(model: &JointModel, pieces: &[Piece<'_>], around: &Surroundings<'_>) -> bool {
    /// Part of the run, and of the difference at its beginning that may be left there.
    const PART: usize = 3;
    const LEFT: f64 = 0.1;
    let longest = pieces.iter().max_by_key(|piece| piece.to - piece.from);
    let Some(Piece { trial, from, to, .. }) = longest else { return true };
    let (samples, period_s) = ((to - from) / PART, trial.period().seconds());
    let rest = vec![0.0; samples];
    let arrivals = Commands::new(&rest, period_s).arriving(model, 0.0, None);
    let (low, high) = extent(trial.output());
    let end = |start: f64| {
        let restart = [Restart { sample: 0, output: start, speed: None }];
        let output = simulate(model, &arrivals, samples, period_s, &restart, around).output;
        output.last().copied().unwrap_or(start)
    };
    (end(high) - end(low)).abs() <= LEFT * (high - low)
}

/// Free runs of `model` over `pieces`, from several places on to the end of the last, each piece
/// with the error that is left by the one before.
fn runs(model: &JointModel, pieces: &[Piece<'_>], around: &Surroundings<'_>) -> Vec<Run> {
    let whole: Vec<Option<Run>> =
        pieces.iter().map(|piece| run(model, *piece, piece.from, around)).collect();
    let samples: usize = pieces.iter().map(|piece| piece.to - piece.from).sum();
    let mut found = Vec::new();
    for place in (0..RUNS).map(|run| samples * run / RUNS) {
        let mut before = 0;
        let mut joined: Option<Run> = None;
        for (piece, whole) in pieces.iter().zip(&whole) {
            let own = piece.to - piece.from;
            let from = piece.from + place.saturating_sub(before);
            before += own;
            if from + SHORTEST_RUN > piece.to {
                continue;
            }
            let next =
                if from == piece.from { whole.clone() } else { run(model, *piece, from, around) };
            joined = match (joined, next) {
                (Some(joined), Some(next)) => Some(joined.followed_by(&next)),
                (joined, next) => joined.or(next),
            };
        }
        found.extend(joined);
    }
    found
}

/// Each of `pieces` by itself.
fn each<'a>(pieces: &[Piece<'a>]) -> Vec<Vec<Piece<'a>>> {
    pieces.iter().map(|piece| vec![*piece]).collect()
}

/// `pieces` in the order of the log, and in others.
fn in_orders<'a>(pieces: &[Piece<'a>]) -> Vec<Vec<Piece<'a>>> {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut order = pieces.to_vec();
    let count = if pieces.len() > 2 { ORDERS } else { 1 };
    let next = |_| {
        let this = order.clone();
        order.shuffle(&mut random);
        this
    };
    (0..count).map(next).collect()
}

impl Run {
    /// How far it goes, and by how much it is off at its end.
    fn end(&self) -> Option<(Travel, f64)> {
        let (way, error) = (*self.way.last()?, *self.error.last()?);
        let seconds = self.error.len() as f64 * self.period_s;
        Some((Travel { seconds, way, distance: self.distance }, error))
    }

    /// This run, and `next`, which goes on with its error.
    fn followed_by(mut self, next: &Self) -> Self {
        let last = |values: &[f64]| values.last().copied().unwrap_or(0.0);
        let (way, error) = (last(&self.way), last(&self.error));
        self.way.extend(next.way.iter().map(|own| way + own));
        self.error.extend(next.error.iter().map(|own| error + own));
        self.distance += next.distance;
        self
    }
}

/// A free run over the rest of `piece` from the sample `from` on, which knows what was played
/// before.
fn run(
    model: &JointModel,
    Piece { trial, start_s, to, .. }: Piece<'_>,
    from: usize,
    around: &Surroundings<'_>,
) -> Option<Run> {
    let period_s = trial.period().seconds();
    let played = Commands::new(trial.input().get(..to)?, period_s);
    let around = Surroundings { start_s, ..*around };
    let arrivals = played.arriving(model, start_s, None);
    let begin = |sample: usize| {
        let output = start_of(trial, sample)?;
        Some(Restart { sample, output, speed: None })
    };
    let mut restarts = vec![begin(0)?];
    restarts.extend((from > 0).then(|| begin(from)).flatten());
    let simulated = simulate(model, &arrivals, to, period_s, &restarts, &around).output;
    let (simulated, output) = (simulated.get(from..)?, trial.output().get(from..to)?);
    let error: Vec<f64> = output.iter().zip(simulated).map(|(y, own)| y - own).collect();
    let steps = simulated.windows(2).map(|pair| match pair {
        [a, b] => (b - a).abs(),
        _ => 0.0,
    });
    let sum = |way: &mut f64, step: f64| {
        *way += step;
        Some(*way)
    };
    let way = std::iter::once(0.0).chain(steps).scan(0.0, sum).collect();
    let distance = simulated.last()? - simulated.first()?;
    Some(Run { period_s, way, distance, error: without_spikes(&error) })
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
    use crate::effect::{DirectionGain, Leakage};
    use crate::model::Component;

    /// A log of a joint that is a third slower in one direction.
    fn log(duration_s: f64) -> Joint {
        let levels = vec![-2.0, -1.0, 0.0, 1.0, 2.0];
        let steps = RandomSteps { levels, hold_s: (0.5, 1.5), duration_s, seed: 3 };
        let rig = rig(None);
        let schedule = random_steps(&steps, &rig, None, 0);
        rig.log(&schedule, rig.output(&slower(), &schedule)).unwrap()
    }

    fn after(seconds: f64) -> Travel {
        Travel { seconds, ..Travel::default() }
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
        let margins: Vec<f64> = (0..30).map(|k| wrong.margin(after(f64::from(k)))).collect();
        assert!(margins.windows(2).all(|pair| pair[0] <= pair[1]));
        let at = |seconds| wrong.margin(after(seconds));
        assert!((at(48.0) / at(24.0) - 2.0).abs() < 1e-9);
        assert!((at(12.1) - RESERVE * wrong.largest()).abs() < 0.02 * at(12.1));
        let far = Travel { way: 1e4, ..after(0.5) };
        assert!(wrong.margin(far) > at(0.5));
    }

    #[test]
    fn what_regulates_itself_is_no_farther_off_later() {
        let leakage = Component::new(&Leakage, vec![8.0.into(), 1.0.into()]).unwrap();
        let settling = JointModel::integrator(80.0, 0.1).with(leakage);
        let levels = vec![-2.0, -1.0, 0.0, 1.0, 2.0];
        let steps = RandomSteps { levels, hold_s: (0.5, 1.5), duration_s: 40.0, seed: 5 };
        let rig = rig(None);
        let schedule = random_steps(&steps, &rig, None, 0);
        let log = rig.log(&schedule, rig.output(&settling, &schedule)).unwrap();
        let found = FreeRunError::of(&log, &settling).unwrap();
        assert!(found.is_bounded());
        assert!((found.margin(after(500.0)) - found.margin(after(0.0))).abs() < 1e-12);
        assert!(!FreeRunError::of(&self::log(60.0), &slower()).unwrap().is_bounded());
    }

    #[test]
    fn a_record_of_which_nothing_can_be_left_out_shows_no_errors() {
        assert_eq!(FreeRunError::of(&log(0.8), &slower()), None);
    }
}
