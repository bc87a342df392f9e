//! Free runs of a model over parts of a record that it was not fitted to.
//!
//! # References
//! M. Stone, "Cross-validatory choice and assessment of statistical predictions", Journal of
//! the Royal Statistical Society B 36 (1974), 111-147.

use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

use super::stops::{SHORTEST_RUN, Stops};
use super::trend::{Travel, Trend};
use crate::effect::{Effect as _, EndStop};
use crate::experiment::{Joint, Trial};
use crate::fit::{FitRecord, Horizon, Split, fit, follows_input};
use crate::model::{Commands, JointModel, Restart, Surroundings, simulate};
use crate::numerics::{limits, median};

/// Parts of a record, each of which is left out once.
const PARTS: usize = 5;

/// Fewest parts whose errors stand for those to come.
const FEWEST_PARTS: usize = 3;

/// Free runs that begin in each part, as far apart as they can be.
const RUNS: usize = 6;

/// Orders in which motions that end at a stop are joined: that of the log, and others, as a plan
/// has them in an order of its own.
const ORDERS: usize = 4;

/// The parts of a record, each with the model that was fitted to the others.
pub(super) struct LeftOut<'a> {
    parts: Vec<(JointModel, Vec<Piece<'a>>)>,
    around: Surroundings<'static>,
    /// Whether the joint came to stops, which remove the error that a run has made.
    pub(super) has_stops: bool,
    /// Whether an error is forgotten: the output regulates itself.
    pub(super) is_bounded: bool,
}

/// A prediction beside what came of it, a value per sample.
#[derive(Clone)]
pub(super) struct Run {
    pub(super) period_s: f64,
    /// Way that the joint was to go until the sample, output units.
    pub(super) way: Vec<f64>,
    /// How far it was to come until the end, output units.
    distance: f64,
    /// The error, output units.
    pub(super) error: Vec<f64>,
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

impl<'a> LeftOut<'a> {
    /// The parts of `joint`, a fifth of the trials, or a fifth of the time of each where they are
    /// few, and `model` with its numbers fitted anew to what is left without each.
    ///
    /// `None` where too little can be left out.
    pub(super) fn of(joint: &'a Joint, model: &JointModel) -> Option<Self> {
        let record = FitRecord::new(joint, Split::Time(1.0), Horizon::FreeRun);
        let radians_per_output_unit = record.range(0.0).radians_per_output_unit;
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
        let has_stops = !stops.are_none();
        (parts.len() >= FEWEST_PARTS).then_some(Self { parts, around, has_stops, is_bounded })
    }

    /// How far each piece went, and by how much a run over it was off at its end.
    pub(super) fn motions(&self) -> Vec<(Travel, f64)> {
        let motions = self.parts.iter().flat_map(|(model, pieces)| {
            // A stop would hide by how much a run is off.
            let model = freed(model);
            let ends =
                pieces.iter().map(move |piece| run(&model, *piece, piece.from, &self.around));
            ends.filter_map(|run| run?.end())
        });
        motions.collect()
    }

    /// Free runs over the parts: each piece by itself, or, where `trend` is what is off each time in
    /// the same way, or there are no stops, pieces joined with those after them, in several orders.
    ///
    /// With a trend the model's stops are left out, as they would remove errors.
    pub(super) fn runs(&self, trend: Option<&Trend>) -> Vec<Run> {
        let is_joined = !self.is_bounded && (trend.is_some() || !self.has_stops);
        let runs = self.parts.iter().flat_map(|(model, pieces)| {
            let model = if trend.is_some() { freed(model) } else { model.clone() };
            let joined = if is_joined {
                in_orders(pieces)
            } else {
                pieces.iter().map(|piece| vec![*piece]).collect()
            };
            let runs = joined.into_iter().flat_map(|pieces| runs(&model, &pieces, &self.around));
            runs.collect::<Vec<_>>()
        });
        runs.collect()
    }
}

/// `model` without a stop, which would remove errors as the joint's own does; of a joint that is
/// not driven from stop to stop it stands for touches that are too short to be seen.
fn freed(model: &JointModel) -> JointModel {
    model.without(EndStop.spec().id)
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
    let rest = joint.of_trials(trials);
    let record = FitRecord::new(&rest, Split::Time(1.0), Horizon::Auto);
    let range = record.range_for(model);
    let begin = |joint: &Joint| joint.trials.first().map(|trial| trial.time_s(1));
    let is_cut = joint.trials.len() < PARTS;
    let later_s = if is_cut { begin(&rest)? - begin(joint)? } else { 0.0 };
    fit(&record, model, &range).ok().map(|fit| (fit.assessment.assessed.model, later_s))
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
    let (low, high) = limits(trial.output().iter().copied());
    let end = |start: f64| {
        // From both ends of where it has been: the farthest that two starts can be apart.
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

/// `pieces` in the order of the log, and in others.
fn in_orders<'a>(pieces: &[Piece<'a>]) -> Vec<Vec<Piece<'a>>> {
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut order = pieces.to_vec();
    let count = if pieces.len() > 2 { ORDERS } else { 1 };
    let next = |_| {
        let this = order.clone();
        // A plan plays the motions in an order of its own: so the errors add up in several.
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

/// The output at `sample`, of which noise is removed by its neighbours.
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
